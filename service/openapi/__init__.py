"""The OpenAPI document and the API reference made from it."""
