"""Protocol of an interface, as the solver needs it: the work of adhesion along it.  Dimensionless."""

from __future__ import annotations

from typing import Protocol

from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches


class InterfaceLaw(Protocol):
    """Work of adhesion along the interface, dimensionless (adhesion.py)."""

    @property
    def least_work(self) -> float:
        """Lower bound of w that no shift of the profile changes."""
        ...

    def work_of_adhesion(self, x: FloatArray) -> FloatArray:
        """Return w at the positions x, same shape."""
        ...

    def work_and_gradient(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return w and dw/dx at the positions x, same shape."""
        ...

    def work_curvature(self, x: FloatArray) -> FloatArray:
        """Return d2w/dx2 at the positions x, same shape."""
        ...

    def energy(self, patches: Patches) -> float:
        """Return -int w dx over the patches."""
        ...
