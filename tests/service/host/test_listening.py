"""The listening socket, and what is said if there is none."""

import socket

import pytest

from service.host.listening import CannotListen, listen


def test_a_port_in_use_is_said_once() -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with pytest.raises(CannotListen) as caught:
            listen("127.0.0.1", port)
    assert str(caught.value) == f"Cannot listen on 127.0.0.1 port {port}: Address already in use."


def test_a_host_that_is_no_address_of_this_machine_is_named() -> None:
    with pytest.raises(CannotListen, match=r"Cannot listen on 192\.0\.2\.1 port 0: Cannot assign requested address\."):
        listen("192.0.2.1", 0)
