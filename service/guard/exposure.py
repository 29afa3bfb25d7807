"""The check that a service without API keys is not exposed to other machines by mistake."""

import ipaddress

from cleave.settings import InvalidSettings, Settings
from service.keys import key_ring


def check_exposure(settings: Settings, address: str) -> None:
    """Check that API keys exist if the settings or the address require them.

    Parameters
    ----------
    address : the IP address that the service listens on.

    Raises
    ------
    InvalidSettings
        If there are no keys, and they are required or other machines can reach the address.
    """
    has_keys = bool(key_ring(settings).all())
    if has_keys or settings.auth == "off":
        return
    if settings.auth == "required":
        raise InvalidSettings("CLEAVE_AUTH requires API keys and there are none: make one with `cleave key NAME`.")
    if not ipaddress.ip_address(address).is_loopback:
        raise InvalidSettings(
            f"Other machines can reach {address}: make API keys with `cleave key NAME`, or set CLEAVE_AUTH=off if "
            "access is restricted by other means."
        )
