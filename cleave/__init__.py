"""A client of a Cleave server: :class:`cleave.client.Client`, and :class:`cleave.client.AsyncClient` for asyncio."""
