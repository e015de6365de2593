"""The equilibrium in which a jump ends, improved: forces, numbers, and their errors from another resolution.

Newton from the forces known, once or twice at a first tolerance, the second time only where a step was not short, and
once at the finest with more nodes and modes than that asks for; what the last one changes is the error.  Numbers are of
second order in the step that is left: the potential of a short one lacks 1e-9 of the work of adhesion that it turns
over.  Dimensionless.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bem.adhesive.branch import after_step
from bem.adhesive.equilibrium import Balance, System, balance
from bem.continuation.locating import LONGEST_STEP
from bem.elastic.collocation import finer, resolve
from bem.loading.path_events import EventNumbers

FloatArray = NDArray[np.float64]

SHORT = 1e-3  # of the edge scale


def at_rest(
    system: System, here: Balance, value: float, tolerances: tuple[float, float]
) -> tuple[Balance, EventNumbers, EventNumbers] | None:
    """A coarse equilibrium improved: forces, numbers, and what the last refinement changed.

    None where it moves far, or finer evaluations find no stable equilibrium beside it.

    Parameters
    ----------
    system : System
    here : Balance
        At `value` of the control.
    value : float
    tolerances : (float, float)
        Of the evaluations before the last, and of the last; they may be equal.
    """
    first, finest = tolerances
    found: list[EventNumbers] = []
    outward = -here.response(here.gradient)
    for tolerance, last in ((first, False), (first, False), (finest, True)):
        size = float(np.max(np.abs(outward) / here.state.patches.edge_scale))
        if size > LONGEST_STEP:
            return None
        if found and not last and size <= SHORT:
            continue
        patches = here.state.patches.moved(outward)
        if not patches.is_ordered:
            return None
        wanted = resolve(system.elastic, patches, tolerance)
        if last:
            wanted = finer(system.elastic, patches, wanted, 1e-2 * tolerance)
        asked = system.sloped if last else system
        here = balance(asked, patches, here.state.penetration, value, tolerance, wanted)
        outward = -here.response(here.gradient)
        found.append(after_step(system, here, value, outward, 0.0))
    if here.factor is None or float(np.max(np.abs(outward) / here.state.patches.edge_scale)) > SHORT:
        return None
    return here, found[-1], found[-1].apart(found[-2], 0.0)
