"""State in which edges come to rest at a value of the control: by Newton nearby, else by a descent.

Used where edges are nearly in equilibrium but not known to be: at targets, and where windows were joined.
Dimensionless.
"""

from __future__ import annotations

from bem.adhesive.equilibrium import Balance, System
from bem.adhesive.relaxation import NO_CAUSE, Cause, Relaxed, interpenetration
from bem.loading.increments import Accuracy
from bem.path.jump import Jumps
from bem.path.locating import AtControl, Refused, Start, settle


def at_rest(jumps: Jumps, start: Start) -> Relaxed:
    """Return the stable state next to edges at their value of the control, with the changes on the way to it.

    Parameters
    ----------
    jumps : Jumps
        From the start, where Newton leads nowhere.  Their accuracy on the way is that of the state returned.
    start : Start
        Edges close to equilibrium.
    """
    system, accuracy, value = jumps.system, jumps.increments.way, start.value
    settled, patches, cause = _settled(system, start, accuracy), start.patches, NO_CAUSE
    if settled is not None:
        closed = interpenetration(system, settled.state, accuracy.allowed)
        if closed.position.size == 0:
            return Relaxed("converged", value, settled, ())
        cause = Cause(None, closed, settled.state, local_tolerance=jumps.increments.coarse.tolerance)
        patches = settled.state.patches
    landed = jumps.landed(patches, start.penetration, value, cause)
    if landed.balance is None or landed.status != "converged":
        return landed
    if landed.minimum is not None:
        behind = Start(landed.minimum.patches, landed.minimum.numbers.penetration, value)
        settled = _settled(system, behind, accuracy)
        if settled is not None:
            return Relaxed("converged", value, settled, landed.changes)
    return Relaxed("not_converged", value, None, landed.changes)


def _settled(system: System, start: Start, accuracy: Accuracy) -> Balance | None:
    """Return the stable state to which Newton leads; None where there is none."""
    settled = settle(system.sloped, start, AtControl(start.value), accuracy)
    return None if isinstance(settled, Refused) or settled[0].factor is None else settled[0]
