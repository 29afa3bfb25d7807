"""Deployment files, and a check of the Docker image that needs no container engine."""
