"""The Python client, :mod:`cleave.client`, and the settings, logs and version that the packages of Cleave share."""
