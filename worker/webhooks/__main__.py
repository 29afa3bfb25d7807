"""Run the process that delivers webhooks: ``python -m worker.webhooks``."""

from worker.webhooks.delivery import main

main()
