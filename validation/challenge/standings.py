"""Who takes part in the recorded standings, at which settings, and the record itself, standings.json.

Every entrant is a route (validation/routes/), called at a setting through the same door as any other solver.  A solver
with grids has one more line, extrapolated from them (record_standings.py).
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from validation.routes.uniform_grid import WITHOUT_ADHESION

RECORD = Path(__file__).parent / "standings.json"
SCHEMA = "linecontact-challenge-standings/1"


@dataclass(frozen=True)
class Entrant:
    """A solver of the standings."""

    name: str
    route: str  # file of validation/routes
    settings: Mapping[str, Any]  # of its knob, by what they are called, coarsest first
    needs: tuple[str, ...] = ()  # modules that must be installed, of an extra
    grids: bool = False  # whether its settings are grids, each twice as fine as the one before

    @property
    def doors(self) -> dict[str, str]:
        """How the judge names the solver at each setting."""
        home = f"validation.routes.{self.route}:solve"
        return {called: f"{home}@{setting!r}" for called, setting in self.settings.items()}

    @property
    def missing(self) -> tuple[str, ...]:
        """What of it is not installed."""
        return tuple(name for name in self.needs if find_spec(name) is None)


def _grids(*points: int) -> dict[str, int]:
    return {f"{count} points, {WITHOUT_ADHESION * count} without adhesion": count for count in points}


ENTRANTS = (
    Entrant("boundary elements", "boundary_elements", {f"tolerance 1e-{n}": float(f"1e-{n}") for n in (3, 6, 9, 12)}),
    Entrant("finite elements", "finite_elements",
            {f"P{p}, {n} cells": (p, n, 14) for p, n in ((2, 6), (2, 12), (4, 6))}),
    Entrant("the paper's method", "paper_method", {f"{n} cells": n for n in (4, 8, 16)}),
    Entrant("Persson's theory", "persson_theory", {"as published": "published"}),
    Entrant("ContactMechanics and Adhesion", "cohesive_grid", _grids(256, 512, 1024, 2048),
            ("ContactMechanics", "Adhesion"), grids=True),
    Entrant("tamaas", "tamaas_grid", _grids(512, 1024, 2048, 4096), ("tamaas",), grids=True),
)  # fmt: skip
SOLVERS = tuple(entrant.name for entrant in ENTRANTS)


def recorded() -> dict[str, Any]:
    """Content of standings.json."""
    return dict(json.loads(RECORD.read_text("utf-8")))
