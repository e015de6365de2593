"""The certificate of a state, as its result keeps it, and how its figures are judged."""

from __future__ import annotations

from dataclasses import dataclass, field, fields

import numpy as np

from bem.geometry.arrays import FloatArray


@dataclass(frozen=True)
class Certificate:
    """A-posteriori checks of a state; `min_gap` and `mean_gap_error` in m, the rest dimensionless.

    Each figure is explained in `certificate.Demands`.  None: it has no meaning for the state, or its file is older.

    Attributes
    ----------
    closure : float
        The largest |G/w - 1|, without adhesion |K| over that of a flat punch, with K recomputed by the audit.
    min_gap : float
        Smallest at the points tried, which come close to the edges but exclude them (there it vanishes).
    min_eigenvalue, hessian_asymmetry : float or None
        Handed in by the solver; None without adhesion.
    truncation : float
        The last coefficients of a patch over its largest.
    contact_residual, mean_gap_error : float or None
        How far contact is from the profile, and the mean gap from the separation.
    ok : bool
        No reason against the state was found.
    reasons : tuple of str
        Each demand that is not met, with figure, limit and place.
    """

    closure: float | None
    min_gap: float | None
    min_eigenvalue: float | None
    truncation: float | None
    hessian_asymmetry: float | None
    ok: bool
    reasons: tuple[str, ...] = ()
    contact_residual: float | None = None
    mean_gap_error: float | None = None


@dataclass(frozen=True, kw_only=True)
class DimensionlessCertificate(Certificate):
    """The certificate of a dimensionless state: lengths in rms heights; `largest_gap` is that at the points tried."""

    min_gap: float
    mean_gap_error: float
    largest_gap: float

    def of_height(self, height: float) -> Certificate:
        """As a result keeps it, by the rms height in m."""
        lengths = {"min_gap": self.min_gap * height, "mean_gap_error": self.mean_gap_error * height}
        return Certificate(**{part.name: getattr(self, part.name) for part in fields(Certificate)} | lengths)


@dataclass(eq=False)
class Verdict:
    """Figures against their limits; the reasons against a state of some patches, figure by figure."""

    patches: int
    reasons: list[str] = field(default_factory=list)

    def judge(self, name: str, values: FloatArray | float, limit: FloatArray | float, place: str) -> float:
        """The figure farthest beyond its limit, a reason where it exceeds it."""
        array = np.atleast_1d(values)
        limits = np.broadcast_to(limit, array.shape)
        worst = int(np.argmax(np.where(np.isnan(array), np.inf, array / limits)))
        if not array[worst] <= limits[worst]:  # also when it is not a number
            at = f" {place} {worst % self.patches}" if place else ""
            self.reasons.append(f"{name} {array[worst]:.2e} exceeds {limits[worst]:.0e}{at}")
        return float(array[worst])
