"""Who takes part in the recorded standings, at which settings, and the record itself, standings.json.

Every entrant is a route behind the public door (validation/routes/).  A solver with grids has one more line,
extrapolated from them (record_standings.py).
"""

import json
from dataclasses import dataclass
from importlib import resources
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from validation.routes.uniform_grid import WITHOUT_ADHESION

RECORD = Path(__file__).parent / "standings.json"
SCHEMA = "linecontact-challenge-standings/1"
HOME = "validation.routes"


@dataclass(frozen=True)
class Entrant:
    """A solver of the standings."""

    name: str
    settings: tuple[tuple[str, str], ...]  # (setting, "module:function"), coarsest first
    needs: tuple[str, ...] = ()  # modules that must be installed, of an extra
    grids: bool = False  # whether its settings are grids, each twice as fine as the one before

    @property
    def missing(self) -> tuple[str, ...]:
        """What of it is not installed."""
        return tuple(name for name in self.needs if find_spec(name) is None)


def _grids(module: str, *points: int) -> tuple[tuple[str, str], ...]:
    return tuple(
        (f"{count} points, {WITHOUT_ADHESION * count} without adhesion", f"{HOME}.{module}:on_{count}")
        for count in points
    )


ENTRANTS = (
    Entrant("boundary elements",
            tuple((f"tolerance 1e-{n}", f"{HOME}.boundary_elements:tol_1e_{n}") for n in (3, 6, 9, 12))),
    Entrant("finite elements", tuple((f"P{p}, {n} cells", f"{HOME}.finite_elements:p{p}_{n}")
                                     for p, n in ((2, 6), (2, 12), (4, 6)))),
    Entrant("the paper's method", tuple((f"{n} cells", f"{HOME}.paper_method:cells_{n}") for n in (4, 8, 16))),
    Entrant("Persson's theory", (("as published", f"{HOME}.persson_theory:plain"),)),
    Entrant("Persson's theory, corrected", (("calibrated in one direction", f"{HOME}.persson_theory:corrected"),)),
    Entrant("ContactMechanics and Adhesion", _grids("cohesive_grid", 256, 512, 1024, 2048),
            ("ContactMechanics", "Adhesion"), grids=True),
    Entrant("tamaas", _grids("tamaas_grid", 512, 1024, 2048, 4096), ("tamaas",), grids=True),
)  # fmt: skip
SOLVERS = tuple(entrant.name for entrant in ENTRANTS)


def recorded() -> dict[str, Any]:
    """Content of standings.json."""
    text = resources.files("validation.challenge").joinpath(RECORD.name).read_text("utf-8")
    return dict(json.loads(text))
