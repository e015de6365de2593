"""A result as files store it, made up: two states, a jump, a shape, and its files with a content that is changed."""

import json
from dataclasses import replace

import numpy as np
from stored_states import stored_state

from bem.scene.digest import digest
from bem.scene.provenance import provenance
from bem.scene.result import Effect, Event, EventError, JumpEnd, LargestTension, Result, TensionError
from bem.scene.result_file import write_result
from bem.scene.scene import parse_scene
from bem.scene.state import ErrorEstimate

SCENE = parse_scene(
    {
        "title": "é",
        "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.1 + 0.2},
        "profile": {"kind": "harmonics", "period": 0.01, "orders": [1], "amplitudes": [1e-5], "phases": [0.0]},
        "loading": {"control": "separation", "targets": [2e-5], "at_mean_pressures": [1e3]},
    }
).resolved()
STATE = stored_state(
    penetration=1e-5 / 3,
    mean_pressure=-0.1,
    contact_stiffness=None,
    error_estimate=ErrorEstimate(mean_pressure=1e-9, contact_fraction=None),
    stored=0,
    events=1,
)
ENDS = JumpEnd("separated", 0.0, 0.0), JumpEnd("converged", 0.0, -0.5, ((0.0029, 0.0031),))
RESULT = Result(
    scene=SCENE,
    effects=(Effect("half_space", True, "no [layer]", 1.5),),
    provenance=provenance(SCENE),
    states=(STATE, replace(STATE, target=False, index=None, stored=None, events=2)),
    events=(
        Event("first_touch", 0.0, 0.0, 0.003, 1e-9, EventError(1e-15, 1e-9, 1e-16), *ENDS),
        Event("pull_off", 0.0, -1.0, None, None, EventError(1e-15, 1e-9, None)),
    ),
    status="converged",
    groups={"rms_height": 7e-6, "rms_slope": 4e-3, "pressure_scale": 4e3},
    fields={
        **{name: np.linspace(0, 0.008, 5) for name in ("x_0", "displacement_0", "gap_0")},
        "pressure_0": np.array([np.nan, 1.0, 2.0, 1.0, np.nan]),
        "patch_0": np.array([-1, 0, 0, 0, -1]),
    },
    largest_tension=LargestTension(-0.3, 1e-6, 1e-5 / 3 + 1.9e-5, "fold", TensionError(1e-9)),
)


def restated(folder, change):
    """Write the result with a content that `change` alters, under a checksum that is right."""
    write_result(RESULT, folder)
    path = folder / "result.json"
    content = json.loads(path.read_text())
    del content["checksum"]
    change(content)
    path.write_text(json.dumps(content | {"checksum": digest(content)}))
