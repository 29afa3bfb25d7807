"""A typed client of a Cleave server: Client, and AsyncClient for asyncio.

with Client("http://127.0.0.1:8000") as client:
    parts = client.segment("hand.off", segments=6)
    parts.labels  # (F,) int32, in the order of the file
"""

from cleave.client.async_client import AsyncClient
from cleave.client.documents import Edited, Job, JobError, Labels, Part, Revision, Segmentation, Status
from cleave.client.errors import ClientError, JobEnded, RequestRefused, ServerUnreachable
from cleave.client.sync_client import Client

__all__ = [
    "AsyncClient",
    "Client",
    "ClientError",
    "Edited",
    "Job",
    "JobEnded",
    "JobError",
    "Labels",
    "Part",
    "RequestRefused",
    "Revision",
    "Segmentation",
    "ServerUnreachable",
    "Status",
]
