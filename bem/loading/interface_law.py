"""What the solver asks of an interface: the work of adhesion along it.  Dimensionless."""

from __future__ import annotations

from typing import Protocol

from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches


class InterfaceLaw(Protocol):
    """Work of adhesion along the interface, dimensionless (adhesion.py)."""

    @property
    def least_work(self) -> float:
        """A lower bound of w that no shift of the profile changes."""
        ...

    def work_of_adhesion(self, x: FloatArray) -> FloatArray:
        """w at the positions x, same shape."""
        ...

    def work_and_gradient(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """w and dw/dx at the positions x, same shape."""
        ...

    def work_curvature(self, x: FloatArray) -> FloatArray:
        """d2w/dx2 at the positions x, same shape."""
        ...

    def energy(self, patches: Patches) -> float:
        """-int w dx over the patches."""
        ...
