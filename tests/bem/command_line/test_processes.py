"""The command line as a process: what it imports, signals it is sent and goes on after, streams that are closed."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from scene_files import run, written_scene
from stored_states import lasting

from bem.scene.result_file import read_result


@pytest.fixture
def scene(tmp_path):
    return written_scene(tmp_path)


def test_figures_bars_and_layer_are_not_imported_to_check(scene):
    code = "import sys; from bem.scene_commands import main; main(['check', sys.argv[1]])"
    code += "; print(sorted(sys.modules))"
    process = subprocess.run([sys.executable, "-c", code, str(scene)], capture_output=True, text=True, check=True)
    modules = process.stdout.splitlines()[-1]
    assert "'matplotlib'" not in modules
    assert "'tqdm'" not in modules
    assert "'bem.elastic.layer'" not in modules


def test_an_unknown_backend_of_matplotlib_does_not_keep_a_run_from_its_plots(scene, tmp_path):
    command = [sys.executable, "-m", "bem", "run", str(scene), "--out", str(tmp_path / "out"), "--quiet", "--plot"]
    subprocess.run(command, env=os.environ | {"MPLBACKEND": "nonsense"}, check=True)
    assert (tmp_path / "out" / "separation.png").exists()


def start(scene, out):
    threads = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-m", "bem", "run", str(scene), "--out", str(out), "--quiet"]
    return subprocess.Popen(command, env=os.environ | threads, stdout=subprocess.DEVNULL)


def wait_for_states(out, process):
    """Wait until a state is stored; the process must still run then."""
    for _ in range(6000):
        if (out / "result.json").exists() and read_result(out).states:
            assert process.poll() is None, "the run ended before it could be stopped"
            return
        time.sleep(0.01)
    pytest.fail("no state was stored within 60 s")


MANY_TARGETS = ", ".join(f"{value}e-6" for value in np.linspace(80, 50, 21))


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    folder = tmp_path_factory.mktemp("uninterrupted")
    assert run(written_scene(folder, MANY_TARGETS, harmonics=60), folder / "out", "--quiet") == 0
    return read_result(folder / "out")


@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGKILL], ids=lambda how: how.name)
def test_stopped_run_goes_on_where_it_was(how, tmp_path, uninterrupted):
    scene, out = written_scene(tmp_path, MANY_TARGETS, harmonics=60), tmp_path / "out"
    process = start(scene, out)
    wait_for_states(out, process)
    process.send_signal(how)
    code = process.wait(timeout=60)
    assert code == (-how if how == signal.SIGKILL else 130)
    before = read_result(out)
    assert before.status == "interrupted"
    assert run(scene, out, "--resume", "--quiet") == 0
    assert lasting(read_result(out)) == lasting(uninterrupted)


@pytest.mark.parametrize("closed", [">&-", "2>&- >&-"])
def test_a_closed_stream_stops_no_run(closed, scene, tmp_path):
    command = f'"{sys.executable}" -m bem run "{scene}" --out "{tmp_path / "out"}" {closed}'
    assert subprocess.run(command, shell=True, check=False, stdout=subprocess.DEVNULL).returncode == 0
    assert read_result(tmp_path / "out").status == "converged"


def test_a_title_that_the_terminal_has_no_letters_for_is_escaped(scene):
    scene.write_text(scene.read_text().replace('"wave"', '"Контакт"'), "utf-8")
    terminal = os.environ | {"PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"}
    process = subprocess.run([sys.executable, "-m", "bem", "check", str(scene)], env=terminal, capture_output=True)
    assert process.returncode == 0
    assert b"\\u041a" in process.stdout
