"""Files for printing, in the API and on the command line."""
