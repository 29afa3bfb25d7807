"""The errors of :mod:`cleave.client` under the name of this module, which earlier versions documented."""

from cleave.client.errors import ClientError, JobEnded, RequestRefused, ServerUnreachable

__all__ = ["ClientError", "JobEnded", "RequestRefused", "ServerUnreachable"]
