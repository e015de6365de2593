"""Complete contact as an end of the adhesive path: how it opens, and what it costs.

Under the JKR model a gap of zero width needs infinite tension, so that complete contact opens only

- at a flaw: a gap of given width where the pressure of complete contact is lowest.  Its K is a linear function of the
  load; it opens when the larger of its two K reaches the critical one, K = 2 sqrt(w).  The flaw itself carries no
  adhesion: what the opening releases is counted from the flawed state;
- or because the separation is prescribed: s > 0 is the mean gap, so that there is one.  It begins at the same
  place with zero width, and the branch is continuous there (Johnson, Int. J. Solids Struct. 32 (1995) 423).

A narrow gap of width g under the tension T opens by int gap dx = pi g^2 T / 4 and has K = T sqrt(pi g / 2), from
which the width at a given separation follows.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bem.collocation import evaluate
from bem.complete_contact import CompleteContact
from bem.equilibrium import System
from bem.patches import TWO_PI, Patches, ordered

FloatArray = NDArray[np.float64]


def with_gap(position: float, width: float) -> Patches:
    """One patch all round the period but for a gap.

    Examples
    --------
    >>> with_gap(1.0, 0.5).gap_after.round(12).tolist()
    [0.5]
    """
    return ordered(np.array([position + width / 2]), np.array([position - width / 2 + TWO_PI]))


def lowest_pressure(complete: CompleteContact) -> float:
    """Position where complete contact has its lowest pressure."""
    negative = replace(complete.pressure, phases=complete.pressure.phases + np.pi)
    positions, heights = negative.crests
    return float(positions[int(np.argmax(heights))])


def opening_load(system: System, complete: CompleteContact, flaw: float, tolerance: float) -> float:
    """Load per period at which a flaw of this width opens: above it K is below critical at both its edges."""
    patches = with_gap(lowest_pressure(complete), flaw)
    state = evaluate(system.elastic, patches, system.elastic.profile.max_height, tolerance)
    critical = 2 * np.sqrt(system.law.work_of_adhesion(np.concatenate([patches.left, patches.right])))
    slope = state.stress_intensity_rate / state.load_rate
    return float(np.max(state.load + (critical - state.stress_intensity) / slope))


def first_gap(system: System, complete: CompleteContact, separation: float) -> Patches:
    """Where a path from complete contact begins at a small separation: one narrow gap."""
    position = lowest_pressure(complete)
    critical = 2 * float(np.sqrt(system.law.work_of_adhesion(np.array([position]))[0]))
    volume = TWO_PI * separation
    width = (4 * volume / (np.pi * critical) * np.sqrt(np.pi / 2)) ** (2 / 3)
    return with_gap(position, min(float(width), 0.5 * TWO_PI))


def complete_potential(system: System, complete: CompleteContact, value: float) -> float:
    """The potential under control of complete contact."""
    energy = complete.elastic_energy + complete.adhesion_energy
    return system.control.potential(system.elastic.profile.max_height, energy, value)
