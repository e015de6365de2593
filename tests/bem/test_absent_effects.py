"""An effect that a scene does not name is neither imported nor run."""

import subprocess
import sys
from functools import cache

import pytest

PROGRAM = """
import sys
from cProfile import Profile
from pathlib import Path
from bem.scene.scene import parse_scene
data = {{
    "solid": {{"youngs_modulus": 1e6, "poisson_ratio": 0.5}},
    "profile": {{"kind": "self_affine", "period": 0.01, "hurst": 0.7, "rms_height": 5e-5, "harmonics": 4, "seed": 1}},
    "loading": {{"control": "separation", "targets": [6e-5, 3e-5]}},
}}
data |= {extra}
scene = parse_scene(data)
calls = Profile(builtins=False)
calls.enable()
from bem.solver import solve
result = solve(scene)
calls.disable()
assert result.status == "converged", result.status
print(*sorted(name for name in sys.modules if name.startswith(("bem.", "scipy."))))
print(*sorted({{Path(call.code.co_filename).name for call in calls.getstats() if not isinstance(call.code, str)}}))
"""
EFFECTS = {"bare": {}, "adhesion": {"adhesion": {"work_of_adhesion": 0.03}}, "layer": {"layer": {"thickness": 0.001}}}
ELASTIC = ["elastic.layer", "elastic.compliance", "elastic.kernel_series"]


@cache
def modules_and_files(effect):
    program = PROGRAM.format(extra=EFFECTS[effect])
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    modules, files = done.stdout.splitlines()
    return set(modules.split()), set(files.split())


@pytest.mark.parametrize(
    ("effect", "absent"),
    [("bare", ["adhesive.adhesion", *ELASTIC]), ("adhesion", ELASTIC), ("layer", ["adhesive.adhesion"])],
    ids=list(EFFECTS),
)
def test_absent_effects_are_not_imported_and_not_run(effect, absent):
    modules, files = modules_and_files(effect)
    assert not {f"bem.{name}" for name in absent} & modules
    assert not {f"{name.split('.')[-1]}.py" for name in absent} & files


def test_windows_are_not_imported_where_many_digits_are_asked_for():
    modules, _ = modules_and_files("adhesion")
    assert not [name for name in modules if name.startswith("bem.windows")]


def test_outputs_not_asked_for_are_not_imported():
    modules, _ = modules_and_files("adhesion")
    outputs = {
        "bem.stored_fields",
        "bem.observables.shapes",
        "bem.observables.spectra",
        "bem.observables.pressure_distribution",
    }
    assert not outputs & modules


@pytest.mark.parametrize("effect", EFFECTS)
def test_no_scene_pays_for_modules_of_scipy_that_it_does_not_use(effect):
    """Roots are looked for in the last gap and at flaws, fast transforms are of many nodes."""
    modules, _ = modules_and_files(effect)
    assert "scipy.linalg" in modules
    assert not {"scipy.fft", "scipy.optimize", "scipy.sparse", "scipy.spatial"} & modules
