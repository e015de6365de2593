"""Finite element reference: a plane-strain periodic layer on a rigid profile, with JKR closure.

An independent second opinion on the boundary element solver: no Green's function, no code and no derived quantity
shared with it. `solve` computes one state with the uncertainty of every quantity, `fem_reference.path.follow` follows a
path through its jumps.
`fem_reference.export.write_fields` writes for ParaView; `fem_reference.imported_mesh.read_layer_mesh` reads a Gmsh mesh
with named boundaries.
"""

from fem_reference.factors import SingularSystemError
from fem_reference.mesh import Resolution
from fem_reference.problem import InvalidProblemError, Problem
from fem_reference.result import Interface, Result
from fem_reference.solve import solve

__all__ = [
    "Interface",
    "InvalidProblemError",
    "Problem",
    "Resolution",
    "Result",
    "SingularSystemError",
    "solve",
]
