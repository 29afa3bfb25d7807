"""The job store: records, uploads, results and the indexes over them."""
