"""The OpenAPI document, the API reference and the lists of the page."""
