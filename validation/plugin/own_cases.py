"""Cases without code: case_*.toml, a scene with a table [expected] of numbers of its last target.

[expected.contact_fraction]
value = 0.137            # a list gives one number for every target
uncertainty = 0.001      # U (k = 2), in SI units
source = "my measurement"
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from typing import Any

import pytest

from bem.geometry.regular_file import read_regular
from validation.plugin.case_rows import rows_of
from validation.plugin.rows import Code, Quantity

QUANTITIES: dict[str, tuple[Quantity, str]] = {
    "contact_fraction": (Quantity.AREA, ""),
    "mean_pressure": (Quantity.PRESSURE, "Pa"),
    "penetration": (Quantity.LENGTH, "m"),
    "separation": (Quantity.LENGTH, "m"),
    "total_displacement": (Quantity.LENGTH, "m"),
    "elastic_energy": (Quantity.ENERGY, "J/m^2"),
    "adhesion_energy": (Quantity.ENERGY, "J/m^2"),
    "total_energy": (Quantity.ENERGY, "J/m^2"),
    "stress_intensity_max": (Quantity.INTENSITY, "Pa m^1/2"),
    "contact_stiffness": (Quantity.STIFFNESS, "Pa/m"),
    "n_patches": (Quantity.COUNT, ""),
}
KEYS = {"value", "uncertainty", "source"}


class OwnCaseError(ValueError):
    """Mistake in a file with expected numbers."""


class SceneFile(pytest.File):
    """File of one scene with expected numbers."""

    def collect(self) -> Iterable[pytest.Item]:
        """Return its case."""
        try:
            tables = tomllib.loads(read_regular(self.path).decode())
            expected = checked(tables.pop("expected", {}))
        except (ValueError, OSError) as error:  # TOML, UTF-8 and ours
            raise self.CollectError(f"{self.path.name}: {error}") from error
        case = SceneCase.from_parent(self, name=str(tables.get("title", "scene")))
        case.tables, case.expected = tables, expected
        yield case


class SceneCase(pytest.Item):
    """Comparison of the targets of a scene with expected numbers."""

    tables: dict[str, Any]
    expected: dict[str, dict[str, Any]]

    def runtest(self) -> None:
        """Solve the scene and compare."""
        import bem

        rows = rows_of(self)
        targets = bem.solve(bem.parse_scene(self.tables)).targets
        for name, known in self.expected.items():
            quantity, unit = QUANTITIES[name]
            states = targets if isinstance(known["value"], list) else targets[-1:]
            estimates = [getattr(state.error_estimate, name, None) or 0.0 for state in states]
            rows.compare(
                name.replace("_", " "),
                [getattr(state, name) for state in states],
                known["value"],
                of=Code.BEM,
                by=Code.USER,
                quantity=quantity,
                unit=unit,
                source=str(known.get("source", "")),
                uncertainty=(estimates, known["uncertainty"]),
            )

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Show a mistake in a scene as one sentence."""
        if isinstance(excinfo.value, ValueError):
            return f"{self.path.name}: {excinfo.value}"
        return super().repr_failure(excinfo, style)


def checked(expected: Any) -> dict[str, dict[str, Any]]:
    """Return the table [expected] if every entry has a known name, numbers and an uncertainty."""
    if not isinstance(expected, Mapping) or not expected:
        raise OwnCaseError("needs a table [expected] with a quantity, such as [expected.contact_fraction]")
    for name, known in expected.items():
        if name not in QUANTITIES:
            raise OwnCaseError(f"expected.{name}: not a quantity of a state; allowed: {', '.join(QUANTITIES)}")
        if not isinstance(known, Mapping) or not {"value", "uncertainty"} <= set(known) <= KEYS:
            raise OwnCaseError(f"expected.{name}: write value = ..., uncertainty = ... and, if known, source = ...")
        numbers = known["value"] if isinstance(known["value"], list) else [known["value"]]
        for number in (*numbers, known["uncertainty"]):
            if isinstance(number, bool) or not isinstance(number, int | float):
                raise OwnCaseError(f"expected.{name}: {number!r} is not a number")
    return {str(name): dict(known) for name, known in expected.items()}
