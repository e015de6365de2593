"""Commands of the verification ask for their output folder, and say in plain words why they do not get it."""

import pytest

from bem.command_line.folder_lock import locked
from validation.__main__ import main

COMMANDS = [["run", "--only", "johnson"], ["study", "scene", "absent.toml"]]


@pytest.mark.parametrize("command", COMMANDS, ids=["run", "study"])
def test_a_folder_in_use_is_refused(command, tmp_path, capsys):
    with locked(tmp_path / "out"):
        assert main([*command, "--out", str(tmp_path / "out")]) == 2
    assert "in use by process " in capsys.readouterr().err
