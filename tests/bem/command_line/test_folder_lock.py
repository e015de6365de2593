"""Two processes never write to one output folder: the second is reported who holds it, and nothing is lost."""

import os
import re
import signal
import socket
import subprocess
import sys

import pytest

from bem.command_line.folder_lock import LOCK_FILE, FolderError, FolderInUseError, locked
from bem.scene_commands import main

SCENE = """
[solid]
youngs_modulus = 1e6
poisson_ratio = 0.5
[profile]
kind = "harmonics"
period = 0.01
orders = [1]
amplitudes = [1e-5]
phases = [0.0]
[loading]
control = "separation"
targets = [5e-6]
"""
HOLD = """
import sys, time
from pathlib import Path
from bem.command_line.folder_lock import locked
with locked(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


@pytest.fixture
def holder(tmp_path):
    process = subprocess.Popen([sys.executable, "-c", HOLD, str(tmp_path / "out")], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "held\n"
    yield process
    process.kill()
    process.wait()
    process.stdout.close()


def test_the_second_is_told_who_holds_it(holder, tmp_path):
    with pytest.raises(FolderInUseError) as reported, locked(tmp_path / "out"):
        pass
    assert f"in use by process {holder.pid} on {socket.gethostname()} since 20" in str(reported.value)


def test_a_killed_process_holds_nothing(holder, tmp_path):
    holder.send_signal(signal.SIGKILL)
    holder.wait()
    assert (tmp_path / "out" / LOCK_FILE).exists()
    with locked(tmp_path / "out") as new:
        assert not new
        assert f"process {os.getpid()} " in (tmp_path / "out" / LOCK_FILE).read_text()
    assert not (tmp_path / "out" / LOCK_FILE).exists()


@pytest.mark.parametrize("written", [True, False])
def test_a_new_folder_stays_only_if_something_was_written(written, tmp_path):
    with locked(tmp_path / "deep" / "out") as new:
        assert new
        if written:
            (tmp_path / "deep" / "out" / "result").write_text("mine")
    assert (tmp_path / "deep" / "out").exists() == written


def test_many_that_come_and_go_are_never_inside_together(tmp_path):
    """Each enters 30 times and leaves a mark inside that must not be there when another enters."""
    code = (
        "import sys\n"
        "from pathlib import Path\n"
        "from bem.command_line.folder_lock import FolderInUseError, locked\n"
        "folder, entered = Path(sys.argv[1]), 0\n"
        "while entered < 30:\n"
        "    try:\n"
        "        with locked(folder):\n"
        "            (folder / 'mark').touch(exist_ok=False)\n"
        "            (folder / 'mark').unlink()\n"
        "            entered += 1\n"
        "    except FolderInUseError:\n"
        "        pass\n"
    )
    tmp_path.joinpath("keep").touch()
    many = [subprocess.Popen([sys.executable, "-c", code, str(tmp_path)], stderr=subprocess.PIPE) for _ in range(3)]
    reported = [process.communicate(timeout=60)[1].decode() for process in many]
    assert [process.returncode for process in many] == [0, 0, 0], reported


def test_a_run_into_a_folder_in_use_is_refused(holder, tmp_path, capsys):
    (tmp_path / "scene.toml").write_text(SCENE)
    before = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert main(["run", str(tmp_path / "scene.toml"), "--overwrite", "--out", str(tmp_path / "out")]) == 2
    assert f"in use by process {holder.pid} on " in capsys.readouterr().err
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == before


def test_a_folder_that_cannot_be_made_is_refused_with_the_reason(tmp_path):
    (tmp_path / "file").write_text("")
    message = rf"out: cannot be made \({re.escape(str(tmp_path))}.*: Not a directory\)$"
    with pytest.raises(FolderError, match=message), locked(tmp_path / "file" / "out"):
        pass
