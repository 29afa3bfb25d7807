"""The viewer in Chromium."""
