"""Without the optional dependency, `cleave mcp` names it, and everything else works."""

import subprocess
import sys

_WITHOUT = "import sys; sys.modules['mcp'] = None; "


def test_a_missing_dependency_is_named() -> None:
    program = f"{_WITHOUT}from service.commands.main import main; sys.exit(main(['mcp']))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr == "cleave: Tools for agents need an optional dependency: pip install 'cleave-mesh[mcp]'.\n"


def test_the_service_starts_without_the_dependency() -> None:
    program = f"{_WITHOUT}import service.host.http_server, service.commands.doctor"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
