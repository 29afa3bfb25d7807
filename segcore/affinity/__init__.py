"""How strongly neighbouring faces or vertices belong together, and what is measured for it."""
