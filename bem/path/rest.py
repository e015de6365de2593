"""State in which edges come to rest at a value of the control: by Newton nearby, else by a descent.

Used where edges are nearly in equilibrium but not known to be: at targets, and where windows were joined.
Dimensionless.
"""

from __future__ import annotations

from bem.adhesive.equilibrium import System
from bem.adhesive.relaxation import Cause, Relaxed, interpenetration, relax
from bem.loading.increments import Accuracy
from bem.path.locating import AtControl, Refused, Start, settle


def at_rest(system: System, start: Start, accuracy: Accuracy, local_tolerance: float) -> Relaxed:
    """Return the stable state next to edges at their value of the control, with the changes on the way to it.

    Parameters
    ----------
    system : System
    start : Start
        Edges close to equilibrium.
    accuracy : Accuracy
        Of the state.
    local_tolerance : float
        Of evaluations in a frozen field, where edges must descend.
    """
    settled, cause, patches = settle(system.sloped, start, AtControl(start.value), accuracy), Cause(), start.patches
    if not isinstance(settled, Refused) and settled[0].factor is not None:
        balance = settled[0]
        closed = interpenetration(system, balance.state, accuracy.allowed)
        if closed.position.size == 0:
            return Relaxed("converged", start.value, balance, ())
        cause = Cause(None, closed, balance.state, local_tolerance=local_tolerance)
        patches = balance.state.patches
    return relax(system, patches, start.penetration, start.value, accuracy, cause)
