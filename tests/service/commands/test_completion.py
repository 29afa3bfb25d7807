"""`cleave completion`: the scripts name every command and its options."""

import subprocess
import sys

import pytest

from service.commands.completion import SHELLS
from service.commands.main import COMMANDS, main


@pytest.mark.parametrize("shell", SHELLS)
def test_the_script_of_a_shell_names_every_command(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", shell]) == 0
    script = capsys.readouterr().out
    for name in COMMANDS:
        assert name in script
    assert "--granularity" in script


def test_bash_completes_commands_options_and_choices(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", "bash"]) == 0
    script = capsys.readouterr().out

    def completed(*words: str) -> set[str]:
        line = f"COMP_WORDS=(cleave {' '.join(words)}); COMP_CWORD={len(words)}"
        call = f"{line}; $(complete -p cleave | sed 's/.*-F \\([^ ]*\\).*/\\1/'); printf '%s\\n' ${{COMPREPLY[@]}}"
        done = subprocess.run(["bash", "-c", f"{script}\n{call}"], capture_output=True, text=True, check=True)
        return set(done.stdout.split())

    assert completed("conv") == {"convert"}
    assert completed("segment", "--seg") == {"--segments"}
    assert completed("segment", "--up", "") == {"y", "z"}


def test_the_missing_dependency_is_named(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setitem(sys.modules, "shtab", None)
    assert main(["completion", "bash"]) == 2
    assert "pip install 'cleave-mesh[completion]'" in capsys.readouterr().err
