"""The secret that receivers of webhooks need."""

from fastapi import APIRouter

from service.context import ContextOf
from service.documents import WebhookSecret
from service.guard.callers import CallerOf
from service.problems import documented
from worker.webhooks.delivery import webhook_secret
from worker.webhooks.message import shown_secret

router = APIRouter(prefix="/v1/webhooks", tags=["webhooks"])


@router.get("/secret", response_model=WebhookSecret, responses=documented("unauthorized"))
async def get_webhook_secret(context: ContextOf, caller: CallerOf) -> WebhookSecret:
    """The secret that signs the messages to webhooks of the caller, as in Standard Webhooks 1.0."""
    return WebhookSecret(secret=shown_secret(webhook_secret(context.secret, caller.owner)))
