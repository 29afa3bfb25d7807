"""A service without API keys does not start on an address that other machines can reach."""

import pytest

from cleave.settings import InvalidSettings, Settings
from service.guard.exposure import check_exposure
from service.keys import key_digest, new_key

KEYS = f"anna:{key_digest(new_key())}"


@pytest.mark.parametrize(
    ("address", "settings", "fine"),
    [
        ("127.0.0.1", Settings(), True),
        ("::1", Settings(), True),
        ("0.0.0.0", Settings(), False),
        ("192.168.1.7", Settings(), False),
        ("0.0.0.0", Settings(auth="off"), True),
        ("0.0.0.0", Settings(api_keys=KEYS), True),
        ("127.0.0.1", Settings(auth="required"), False),
        ("127.0.0.1", Settings(auth="required", api_keys=KEYS), True),
    ],
)
def test_a_service_is_not_exposed_by_mistake(address: str, settings: Settings, fine: bool) -> None:
    if fine:
        check_exposure(settings, address)
    else:
        with pytest.raises(InvalidSettings, match="cleave key NAME"):
            check_exposure(settings, address)
