"""The endpoints of the API and the pages, a module for each kind of thing they are about."""
