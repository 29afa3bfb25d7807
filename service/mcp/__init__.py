"""Tools for agents over the Model Context Protocol: `cleave mcp`, and /mcp of the service.

Every tool is requests to the HTTP API, with the API key of the caller. The package ``mcp`` is an optional dependency:
only :mod:`service.mcp.endpoint` can be imported without it.
"""
