"""The commands of `cleave`: a module per command, listed in :mod:`service.commands.main`, and what they share."""
