"""The list of parts: what can be measured of each, what it borders on, and which parts are copies of each other."""
