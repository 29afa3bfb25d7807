"""Tests of the edits of parts on the page, in the browser."""
