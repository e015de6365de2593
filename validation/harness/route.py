"""Problem in plain SI numbers, which every code that is compared takes.

A problem is raw data, from which every code derives its own constants, so that a mistake in what follows from them
cannot cancel between two codes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from validation.harness.arrays import FloatArray

Place = dict[str, Any]  # "target": which, from 1; "points" or "orders": where; empty for all targets


@dataclass(frozen=True)
class Problem:
    """A rigid periodic profile h = sum h_m cos(2 pi m x / period + phi_m), pressed on an elastic solid along a path."""

    id: str
    youngs_modulus: float  # Pa
    poisson_ratio: float
    period: float  # m
    orders: tuple[int, ...]  # harmonics, with amplitudes in m and phases
    amplitudes: tuple[float, ...]
    phases: tuple[float, ...]
    control: str  # "mean_pressure", "separation" or "penetration"
    targets: tuple[float, ...]  # Pa or m, visited in this order from surfaces apart
    asked: dict[str, Place]  # quantities, and where
    thickness: float | None = None  # of a bonded layer, m; None: a half-space
    work_of_adhesion: float | None = None  # J/m^2; None: no adhesion
    slope_term: bool = False  # whether adhesion is counted on the true length

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> Problem:
        """Build a problem from tables like problem.toml of the challenge, lists as lists or arrays.

        Examples
        --------
        >>> profile = {"period": 1.0, "orders": [1], "amplitudes": [0.1], "phases": [0.0]}
        >>> path = {"control": "penetration", "targets": [0.05]}
        >>> solid = {"youngs_modulus": 1.0, "poisson_ratio": 0.3}
        >>> Problem.of({"name": "wave", "solid": solid, "profile": profile, "path": path, "asked": {}}).targets
        (0.05,)
        """
        profile = data["profile"]
        return cls(
            id=data["name"],
            period=float(profile["period"]),
            orders=tuple(_plain(profile["orders"])),
            amplitudes=tuple(_plain(profile["amplitudes"])),
            phases=tuple(_plain(profile["phases"])),
            control=data["path"]["control"],
            targets=tuple(_plain(data["path"]["targets"])),
            asked={name: {key: _plain(value) for key, value in what.items()} for name, what in data["asked"].items()},
            thickness=data.get("layer", {}).get("thickness"),
            **data["solid"],
            **data.get("adhesion", {}),
        )

    @property
    def harmonics(self) -> tuple[Any, FloatArray, FloatArray]:
        """Orders, amplitudes and phases as arrays."""
        return np.array(self.orders), np.array(self.amplitudes), np.array(self.phases)

    def height(self, x: ArrayLike) -> FloatArray:
        """Return the profile at positions in m, summed term by term, in m."""
        orders, amplitudes, phases = self.harmonics
        phase = 2 * np.pi / self.period * np.multiply.outer(np.asarray(x), orders) + phases
        return np.asarray(np.cos(phase) @ amplitudes)

    def answered(self, values: Mapping[str, Any]) -> dict[str, list[Any]]:
        """Return the quantities that the problem asks for, as lists, without quantities that are absent or None."""
        return {name: np.atleast_1d(values[name]).tolist() for name in self.asked if values.get(name) is not None}


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else value


def missing(extra: str, *packages: str) -> str:
    """Return the reason why a route of an extra cannot run on this machine; empty if it can."""
    absent = [name for name in packages if find_spec(name) is None]
    return f'{", ".join(absent)} not installed: pip install ".[{extra}]"' if absent else ""
