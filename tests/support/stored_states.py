"""A state as results store it, made up; and what of a result is the same whenever it is computed."""

from dataclasses import replace

from bem.audit.certificate import Certificate
from bem.scene.state import ErrorEstimate, State


def stored_state(**changes):
    """A state with two patches; keyword arguments replace its fields."""
    fields = {
        "branch": "loading",
        "penetration": 1e-5,
        "separation": 2e-5,
        "total_displacement": None,
        "mean_pressure": 1.0,
        "contact_fraction": 0.1,
        "n_patches": 2,
        "edges": ((0.001, 0.0015), (0.0096, 0.0101)),
        "elastic_energy": 1.0,
        "adhesion_energy": -2.0,
        "total_energy": -1.0,
        "stress_intensity_max": 3.0,
        "contact_stiffness": 1.0,
        "stable_at_fixed_load": True,
        "error_estimate": ErrorEstimate(1e-9, 1e-9),
        "certificate": Certificate(1e-12, 1e-9, 0.2, 1e-8, 1e-10, contact_residual=1e-12, mean_gap_error=1e-18),
        "unknowns": 40,
        "evaluations": 7,
        "cpu_seconds": 0.5,
        "status": "converged",
        "target": True,
        "index": 0,
    }
    return State(**(fields | changes))


def lasting(result):
    """What does not depend on the machine's mood, bit for bit: everything but dates and seconds."""
    states = [repr(replace(state, cpu_seconds=0.0)) for state in result.states]
    fields = {name: (values.dtype.str, values.shape, values.tobytes()) for name, values in result.fields.items()}
    return states, [repr(event) for event in result.events], result.status, fields
