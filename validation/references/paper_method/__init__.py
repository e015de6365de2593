"""The paper's own numerical method, written anew as a reader of the paper would: an independent route.

Graded cells of uniform pressure on the contact patches, Gauss-Seidel for the pressure, conjugate gradients of Polak
and Ribiere on the edges.  Nothing is shared with the solver: raw data in, SI quantities out.
"""

from validation.references.paper_method.paper_state import PaperState, follow, solve
from validation.references.paper_method.surface import Surface

__all__ = ["PaperState", "Surface", "follow", "solve"]
