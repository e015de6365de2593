"""What the error of each method is measured against: an exact answer, or another code, finer, with its uncertainty.

Nothing is measured against its own code where another one reaches; where none does, against a far finer run of it, and
then no digits are claimed.  Uncertainties: of finite elements those of `fem_reference.solve` (three meshes); of
the paper's method, of second order, the change of its extrapolation in 1/cells^2 by one level; of the solver and of
Persson's routes the change by one level.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from fem_reference import Resolution
from persson.adhesive import Route
from validation.harness.schema import ReferenceKind
from validation.references.paper_method import follow
from validation.references.paper_method import solve as paper_solve
from validation.references.posed_contacts import Numbers, Posed, answer_of, exact_sinusoid, numbers_of, quantity_of
from validation.routes import boundary_elements
from validation.routes.finite_elements import crests, finest
from validation.routes.paper_method import GAP
from validation.routes.persson_theory import by_route
from validation.studies.work_precision.methods import PAPER_RESIDUAL, PATH_RESIDUAL, PATH_STEPS, Method

ROUNDING = 2e-15  # of the scale of a quantity


@dataclass(frozen=True)
class Yardstick:
    """An answer to measure against."""

    kind: ReferenceKind
    source: str  # in words, with the setting
    answer: Numbers  # and `uncertainty`: by the names of QUANTITIES, SI
    uncertainty: Numbers

    def floor(self, posed: Posed, names: tuple[str, ...]) -> float:
        """Uncertainty of the error: the largest of the named quantities over their scales."""
        scales = posed.scales
        known = {name: quantity_of(name) for name in self.uncertainty if quantity_of(name) in names}
        return max(self.uncertainty[name] / scales[quantity] for name, quantity in known.items())


@dataclass(frozen=True)
class Source:
    """How a reference is made: its name, its code, and the function that computes it."""

    name: str
    code: str
    compute: Callable[[Posed], Yardstick]
    of_itself: bool = False  # whether it measures its own code where no other does


def johnson(posed: Posed) -> Yardstick:
    """Closed form."""
    spread = {name: ROUNDING * scale for name, scale in posed.scales.items()}
    return Yardstick("exact", "Johnson 1995", exact_sinusoid(posed), spread)


def finite_elements(posed: Posed) -> Yardstick:
    """Quartic elements on three meshes, the finest with 12 cells per period and 22 halvings at the edges."""
    found = finest(posed, Resolution(4, 12, 22), crests(posed))
    source = "fem, quartic, 6, 9 and 12 cells, tips halved 22 times on the finest; uncertainty of three meshes"
    return Yardstick("FEM", source, numbers_of(found.values), numbers_of(found.uncertainty))


def solver(kind: ReferenceKind, source: str, increment: float, posed: Posed) -> Yardstick:
    """The production solver at 1e-12 and a part of the increment; uncertainty: the change from 1e-10 and all of it."""
    at = (1e-12, increment), (1e-10, 1.0)
    fine, coarse = (numbers_of(boundary_elements.solve(posed, *settings).values) for settings in at)
    return Yardstick(kind, source, fine, _changes(posed, fine, coarse))


def paper_extrapolated(posed: Posed) -> Yardstick:
    """The paper's method at 16, 32 and 64 cells a patch, extrapolated; edges from its own path with 8 cells."""
    way = np.linspace(0.0, posed.penetration, PATH_STEPS + 1)[1:]
    edges = follow(posed.surface(), way, 8, PATH_RESIDUAL, GAP)[-1].edges
    found: list[Numbers] = []
    for cells in (16, 32, 64):
        state = paper_solve(posed.surface(), posed.penetration, edges, cells, PAPER_RESIDUAL, GAP)
        if state.status != "converged":
            raise ArithmeticError(f"paper's method at {cells} cells: {state.status}: {state.message}")
        edges = state.edges
        gap = float(state.gap(np.array([posed.trough]))[0])
        found.append(answer_of(state.contact_fraction, state.mean_pressure, state.elastic_energy / posed.period, gap))
    fine, coarse = _extrapolated(found[2], found[1]), _extrapolated(found[1], found[0])
    source = "the paper's method at 32 and 64 cells a patch, extrapolated"
    return Yardstick("independent code", source, fine, _changes(posed, fine, coarse))


def persson_route(route: Route, name: str, posed: Posed) -> Yardstick:
    """A route of Persson's theory at resolution 8; uncertainty: the change from 4."""
    fine, coarse = (numbers_of(by_route(route, posed, resolution).values) for resolution in (8.0, 4.0))
    return Yardstick("independent code", f"the {name} at resolution 8", fine, _changes(posed, fine, coarse))


JOHNSON = Source("Johnson 1995", "exact", johnson)
FINITE_ELEMENTS = Source("finite elements", "fem", finite_elements)
SOLVER = Source("solver", "bem", partial(solver, "independent code", "bem at tolerance 1e-12", 1.0))
FAR_FINER = Source(
    "far finer run", "bem", partial(solver, "self", "bem at 1e-12, a quarter of the increment", 0.25), of_itself=True
)
PAPER = Source("paper's method, extrapolated", "paper's method", paper_extrapolated)
VOLTERRA = Source("Volterra route", "persson, volterra", partial(persson_route, "volterra", "Volterra route"))
FINITE_VOLUMES = Source(
    "finite volumes", "persson, finite volumes", partial(persson_route, "finite_volumes", "finite volumes")
)
SOURCES: dict[str, tuple[Source, ...]] = {
    "sinusoid": (JOHNSON,),
    "layer": (FINITE_ELEMENTS, SOLVER),
    "rough": (SOLVER, PAPER),
    "theory": (VOLTERRA, FINITE_VOLUMES),
    "paper": (FAR_FINER,),
}


def source_for(scene: str, method: Method, sources: dict[str, tuple[Source, ...]] = SOURCES) -> Source:
    """The first reference of a scene that may measure a method: of another code, or made to; ValueError without one."""
    for source in sources[scene]:
        if source.code != method.code or source.of_itself:
            return source
    raise ValueError(f"{scene}: no reference of another code than {method.code}")


def _extrapolated(fine: Numbers, coarse: Numbers) -> Numbers:
    """Second order: (4 fine - coarse) / 3."""
    return {name: (4 * fine[name] - coarse[name]) / 3 for name in fine}


def _changes(posed: Posed, fine: Numbers, coarse: Numbers) -> Numbers:
    return {name: max(abs(fine[name] - coarse[name]), ROUNDING * posed.scales[quantity_of(name)]) for name in fine}
