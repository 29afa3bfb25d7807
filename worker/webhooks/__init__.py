"""Webhook messages and the process that delivers them."""
