"""Logs, traces and metrics of the HTTP service."""
