"""Nothing computed is lost: a run that is interrupted or dies at any call of what keeps its states goes on to the same.

Every call of the files in `KEEPING`, of functions in Python and in C (writing, flushing, renaming), is counted.  At one
of them the run is sent SIGINT, or its process ends there and then, and `--resume` has to give every state, event and
array of the run that nobody disturbed, bit for bit.
"""

import os
import re
import signal
import sys
from pathlib import Path

import numpy as np
import pytest
from stored_states import lasting

from bem import record, recorder
from bem import scene_commands as command_line
from bem.command_line import checkpoint
from bem.scene import atomic_file, journal, result_file
from bem.scene.result_file import read_result
from bem.scene.scene import load_scene
from bem.solver import solve

KEEPING = {module.__file__ for module in (record, recorder, checkpoint, atomic_file, journal, result_file)}
SCENE = """
[solid]
youngs_modulus = 1.0e6
poisson_ratio = 0.5
[profile]
kind = "harmonics"
period = 0.01
orders = [1, 3]
amplitudes = [1e-5, 2e-6]
phases = [0.0, 1.0]
{adhesion}
[loading]
control = "separation"
targets = [9e-6, 6e-6]
[accuracy]
max_increment = 1.0
[output]
shapes = [9e-6, 6e-6]
spectra = true
"""
ADHESION = "[adhesion]\nwork_of_adhesion = 1e-4\n"
DIED = 9


@pytest.fixture(scope="module", params=["", ADHESION], ids=["without adhesion", "with adhesion"])
def undisturbed(request, tmp_path_factory):
    """The scene, its result, and the number of calls that keep its states."""
    folder = tmp_path_factory.mktemp("undisturbed")
    scene = folder / "scene.toml"
    scene.write_text(SCENE.format(adhesion=request.param))
    calls = Calls()
    assert calls.run(scene, folder / "out") == 0
    return scene, read_result(folder / "out"), calls.count


class Calls:
    """Counts calls of what keeps the states of a run; at one of them something happens."""

    def __init__(self, at=-1, happens=None):
        self.at, self.happens, self.count = at, happens, 0

    def __call__(self, frame, event, _):
        if event in ("call", "c_call") and frame.f_code.co_filename in KEEPING:
            self.count += 1
            if self.count == self.at:
                self.happens()

    def run(self, scene, out, *options):
        sys.setprofile(self)
        try:
            return run(scene, out, *options)
        finally:
            sys.setprofile(None)


def run(scene, out, *options):
    return command_line.main(["run", str(scene), "--out", str(out), "--quiet", *options])


def interrupted(scene, out, at):
    """A run that hears Ctrl-C at one of the calls."""
    code = Calls(at, lambda: signal.raise_signal(signal.SIGINT)).run(scene, out)
    assert code in (0, 130)


def killed(scene, out, at):
    """A process that ends at one of the calls as with SIGKILL: nothing is closed, flushed or tidied up."""
    process = os.fork()
    if process == 0:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        Calls(at, lambda: os._exit(DIED)).run(scene, out)
        os._exit(0)
    _, status = os.waitpid(process, 0)
    assert os.waitstatus_to_exitcode(status) in (0, DIED)  # how often result.json is written is a matter of time


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # a file that was just being opened
@pytest.mark.parametrize("happens", [interrupted, killed], ids=lambda happens: happens.__name__)
@pytest.mark.parametrize(
    ("first", "step"),
    [(5, 29), *(pytest.param(k, 8, marks=pytest.mark.slow) for k in range(1, 9))],
    ids=lambda number: str(number),
)
def test_a_run_disturbed_at_any_call_goes_on_to_the_same(happens, first, step, undisturbed, tmp_path):
    scene, whole, calls = undisturbed
    assert calls > 200
    for at in range(first, calls + 1, step):
        out = tmp_path / str(at)
        happens(scene, out, at)
        assert run(scene, out, "--resume") == 0
        assert lasting(read_result(out)) == lasting(whole)
        assert sorted(path.name for path in Path(out).iterdir()) == ["fields.npz", "result.json"]


def test_what_a_state_costs_does_not_grow_with_those_before_it(tmp_path):
    """Calls and bytes of a path of 400 targets over those of one of 100; 15 for calls where all are written again."""

    def cost(count):
        scene = tmp_path / f"{count}.toml"
        targets = ", ".join(f"{9e-5 - 1e-7 * k:.9g}" for k in range(count))  # nothing touches
        scene.write_text(re.sub(r"targets = .*\n(.*\n)*", f"targets = [{targets}]\n", SCENE.format(adhesion="")))
        times = iter([0.0, 1.0])  # the first result.json takes a second, which none has passed since
        keep = checkpoint.Checkpoint(tmp_path / str(count), clock=lambda: next(times, 1.0))
        keep.journal.folder.mkdir()
        calls = Calls()
        sys.setprofile(calls)
        try:
            solve(load_scene(scene), on_state=keep.keep)
        finally:
            sys.setprofile(None)
        return np.array([calls.count, keep.journal.path.stat().st_size])

    assert np.all(cost(400) / cost(100) < 4.1)  # measured 3.93 and 3.94
