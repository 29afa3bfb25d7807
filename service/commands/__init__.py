"""The commands of `cleave`, a module for each, and what they share. :mod:`service.commands` puts them together."""
