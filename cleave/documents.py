"""The documents of :mod:`cleave.client` under the name of this module in earlier versions."""

from cleave.client.documents import Job, JobError, Labels, Segmentation, Status

__all__ = ["Job", "JobError", "Labels", "Segmentation", "Status"]
