"""A branch of equilibria near one of its points: tangent, softest mode, and the energy that a jump leaves missing.

Along a branch the edges move by -H^-1 dg/dtau, and the potential grows by the integral of the force that the control
exerts: any other growth says that the path left the branch.  Less of it means a jump; more, a branch of higher
potential, onto which only Newton can leap.  The energies of a stiff layer may be too large to show a small jump.  It
shows where an edge has passed a crest; elsewhere a shorter increment must decide.  Where the softest mode does no work
with the load, a symmetry breaks.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bem.adhesive.equilibrium import Balance, System, energy_noise
from bem.adhesive.lowest_modes import lowest_modes
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import TWO_PI, Patches
from bem.geometry.profile import Profile
from bem.loading.control import Control

UNBOOKED = 1e-3  # energy that may go missing in an increment, over the work of adhesion that its edges turned over
OPEN = 0.1  # energy missing over the larger of that work and what curvature may hide: the increment is too long
ASTRAY, UNCERTAIN = 0.3, 10.0  # of the largest motion of an edge; times the residual


def tangent(control: Control, here: Balance) -> FloatArray:
    """d(outward motion of the edges) / dtau along the branch, (2 L,)."""
    return -control.rate(here.state) * here.response(here.load_gradient)


@dataclass(frozen=True)
class Missing:
    """Energy that is missing for two points to be of one branch, and what it is compared with.

    Attributes
    ----------
    energy : float
        Its size.
    curvature : float
        Half of what the curvature of the branch adds to the trapezoidal rule.
    turned_over : float
        Work of adhesion on the way of the edges.
    noise : float
        Accuracy of the energies.
    """

    energy: float
    curvature: float
    turned_over: float
    noise: float

    @property
    def tells_of_a_leap(self) -> bool:
        """Whether the potential grew less, or more, than along a branch.

        By more than a thousandth of the work of adhesion turned over, what the curvature may hide, and the noise.
        """
        return self.energy > max(UNBOOKED * self.turned_over, self.curvature) + self.noise

    @property
    def leaves_open(self) -> bool:
        """Whether a jump may hide: in a stiff layer it may release less than what the curvature leaves uncertain."""
        return self.energy > OPEN * max(self.turned_over, self.curvature) + self.noise


def missing_energy(
    system: System,
    ends: tuple[Balance, Balance],
    rates: tuple[FloatArray, FloatArray],
    change: float,
    tolerance: float,
) -> Missing:
    """How much less, or more, the potential grew from one point to another than along a branch.

    The growth along a branch is the integral of `control.force`, by Hermite's rule.  Forces left on the edges do their
    part of the work.

    Parameters
    ----------
    system : System
    ends : (Balance, Balance)
        Equilibria with equally many patches, evaluated to `tolerance`.
    rates : ((2 L,) array, (2 L,) array)
        Tangents there.
    change : float
        Of the target from one to the other.
    tolerance : float
    """
    (first, last), control = ends, system.control
    stiffness = [
        control.force_rate(here.state, float(here.load_gradient @ rate)) for here, rate in zip(ends, rates, strict=True)
    ]
    curved = change**2 / 12 * (stiffness[0] - stiffness[1])
    grown = change / 2 * (control.force(first.state) + control.force(last.state)) + curved
    outward = outward_motion(first.state.patches, last.state.patches)
    unbalanced = (first.gradient + last.gradient) / 2 @ outward  # other evaluations than those that found the ends
    missing = float(first.potential + grown + unbalanced - last.potential)
    turned_over = float(last.work @ np.abs(outward))
    noise = energy_noise(system, first, last, tolerance)
    return Missing(abs(missing), float(abs(curved)) / 2, turned_over, float(noise))


def strays(ends: tuple[Balance, Balance], rates: tuple[FloatArray, FloatArray], change: float, residual: float) -> bool:
    """Whether edges moved otherwise than the tangents at both ends say: Newton leapt from one branch to another.

    Along a branch the trapezoidal rule leaves a part of the motion that falls with the square of the increment; over a
    short unstable stretch, which energy may not show, it leaves most of it.

    Parameters
    ----------
    ends : (Balance, Balance)
        Equilibria with equally many patches.
    rates : ((2 L,) array, (2 L,) array)
        Tangents there.
    change : float
        Of the target from one to the other.
    residual : float
        max |G/w - 1| of the equilibria, which the edges are off by in units of their edge scale.
    """
    patches = ends[0].state.patches
    moved = outward_motion(patches, ends[1].state.patches)
    astray = float(np.max(np.abs(moved - change * (rates[0] + rates[1]) / 2) / patches.edge_scale))
    return astray > UNCERTAIN * residual + ASTRAY * float(np.max(np.abs(moved) / patches.edge_scale))


def passes_crest(profile: Profile, first: Patches, last: Patches) -> bool:
    """Whether an edge moves over a valley and the crest behind it, or back: that crest touches, or parts, by itself.

    Contact that forms ahead of an edge where the profile has no crest, as beside the bulge of a thin layer, is not
    noticed.
    """
    left, right = np.split(outward_motion(first, last), 2)
    crests, valleys = (np.concatenate([x - TWO_PI, x, x + TWO_PI]) for x in (profile.crests[0], profile.valleys[0]))

    def lie_within(lower: FloatArray, upper: FloatArray, start: FloatArray, length: FloatArray) -> bool:
        start = start % TWO_PI
        next_lower, last_upper = np.searchsorted(lower, start), np.searchsorted(upper, start + length) - 1
        return bool(np.any(lower[next_lower] < upper[last_upper]))

    return lie_within(crests, valleys, first.left - np.maximum(left, 0.0), np.abs(left)) or lie_within(
        valleys, crests, first.right + np.minimum(right, 0.0), np.abs(right)
    )


def outward_motion(first: Patches, last: Patches) -> FloatArray:
    """Motion of the edges from some patches to others, (2 L,); across the end of the period too."""
    moved = np.concatenate([first.left - last.left, last.right - first.right])
    return np.asarray((moved + np.pi) % TWO_PI - np.pi)


def softest_mode(here: Balance) -> FloatArray:
    """Outward motion of the edges in the mode of least scaled stiffness, (2 L,), each in units of its scale."""
    return lowest_modes(here.scaled_hessian, 1)[1][:, 0]


def unstable_patches(here: Balance) -> IntArray:
    """Patches that move most in the softest mode of the Hessian."""
    size = np.abs(softest_mode(here))
    return np.unique(np.flatnonzero(size > 0.3 * size.max()) % here.state.patches.count)
