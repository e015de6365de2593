"""Compliance of a body that is no half-space: one object for all effects that change the compliance.

Mode m of the pressure moves the face by ratio_m / m instead of 1/m.  Effects add what each changes,

    ratio_m = ratio_m^(1) - sum_{i > 1} (1 - ratio_m^(i)),      c(0) = sum_i c^(i)(0),      S(x) = sum_i S^(i)(x),

which is exact where they yield one after the other under the same pressure (two bodies, a coating that deforms by
itself), and of first order where one acts within the other: that takes an effect of its own.  Effects that change no
mode by more than is asked for are left out of the equations; the error estimates hold what they would change
(assessment.py, complete_contact.py).  All costs are those of one kernel, with the terms of its slowest series.

A half-space has no such object, and a scene without effects does not import this module.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bem.elastic.hierarchical import IllConditionedSystemError
from bem.elastic.kernel_series import ElasticEffect, KernelSeries, kernel_series
from bem.geometry.arrays import FloatArray

TRUNCATION = 1e-14  # derived: of the series of a kernel; its terms are cheap


@dataclass(frozen=True, eq=False)
class Compliance:
    """Change of the compliance of the half-space by the effects of a scene.

    Parameters
    ----------
    kernel : KernelSeries or None
        Of all effects in the equations; its `ratio` is the compliance of modes relative to the half-space.
    left_out : KernelSeries or None
        Of all effects left out of the equations.
    mean : float or None
        c(0) in m/Pa of all effects; None without one, as for a half-space.
    """

    kernel: KernelSeries | None = None
    left_out: KernelSeries | None = None
    mean: float | None = None


def compliance_of(effects: Collection[ElasticEffect], negligible: float = 0.0) -> Compliance:
    """Return the compliance of a body with the given effects; leave effects below `negligible` out of the equations."""
    kernels = []
    for small in (False, True):
        group = tuple(effect for effect in effects if (effect.relative_effect < negligible) == small)
        kernels.append(kernel_series(summed(group), TRUNCATION) if group else None)
    return Compliance(kernels[0], kernels[1], mean_compliance(effects))


def mean_compliance(effects: Collection[ElasticEffect]) -> float | None:
    """Return c(0) of all effects, m/Pa; None where no effect has a c(0)."""
    known = [effect.mean_compliance for effect in effects if effect.mean_compliance is not None]
    return sum(known) if known else None


def summed(effects: tuple[ElasticEffect, ...]) -> ElasticEffect:
    """Return the sum of effects by the rule of the module; a single effect unchanged."""
    return effects[0] if len(effects) == 1 else EffectSum(effects)


@dataclass(frozen=True)
class EffectSum:
    """Two or more effects as one.  Digits of small ratios are kept where the stiffest comes first.

    Parameters
    ----------
    effects : tuple of ElasticEffect
    """

    effects: tuple[ElasticEffect, ...]

    @property
    def strip(self) -> float:
        """Strip of the effect that decays most slowly."""
        return min(effect.strip for effect in self.effects)

    @property
    def relative_effect(self) -> float:
        """Upper bound of the relative effect of the sum."""
        return sum(effect.relative_effect for effect in self.effects)

    @property
    def mean_compliance(self) -> float | None:
        """c(0), m/Pa."""
        return mean_compliance(self.effects)

    def ratio(self, orders: ArrayLike) -> FloatArray:
        """Return the compliance relative to the half-space, shape of `orders`.

        Raises
        ------
        IllConditionedSystemError
            Together they leave a mode without compliance.
        """
        first, *others = self.effects
        ratio = first.ratio(orders) - sum(other.deficit(orders) for other in others)
        if not np.all(ratio > 0):
            raise IllConditionedSystemError("elastic effects that together leave a mode without compliance")
        return np.asarray(ratio)

    def deficit(self, orders: ArrayLike) -> FloatArray:
        """Return 1 - ratio, shape of `orders`."""
        return np.asarray(sum(effect.deficit(orders) for effect in self.effects))
