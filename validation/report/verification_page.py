"""report.html of a verification run, made from the content of its report.json alone."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from statistics import median
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from bem.scene.atomic_file import write_atomically
from validation.harness.schema import Figure, Panel, Series
from validation.report.figures import svg_of


def write(folder: Path, content: Mapping[str, Any]) -> None:
    """Write report.json, and report.html from it."""
    text = json.dumps(content, indent=1, allow_nan=False) + "\n"
    write_atomically(folder / "report.json", text)
    write_atomically(folder / "report.html", page(json.loads(text)))


def matrix(rows: Iterable[Mapping[str, Any]]) -> dict[str, dict[str, dict[str, Any]]]:
    """Return comparisons by pair of codes and quantity: how many, and how much of what is allowed they use."""
    cells: dict[str, dict[str, list[Mapping[str, Any]]]] = {}
    for row in rows:
        if row["kind"] == "accuracy" and row["routes"]:
            cells.setdefault(" – ".join(row["routes"]), {}).setdefault(row["quantity"], []).append(row)
    return {pair: {quantity: _cell(of) for quantity, of in line.items()} for pair, line in sorted(cells.items())}


def _cell(rows: list[Mapping[str, Any]]) -> dict[str, Any]:
    shares = [math.inf if row["share"] is None else row["share"] for row in rows]
    return {"median": median(shares), "largest": max(shares), "many": len(rows),
            "verdict": max(rows, key=lambda row: (row["failed"], row["share"] or 0.0))["verdict"]}  # fmt: skip


def page(content: Mapping[str, Any]) -> str:
    """Return the page of a report.json."""
    environment = Environment(loader=PackageLoader("validation.report", "."), autoescape=True,
                              undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)  # fmt: skip
    environment.filters |= {"number": _number, "short": _short}
    rows: dict[str, list[Mapping[str, Any]]] = {}
    for row in content["rows"]:
        rows.setdefault(row["case"], []).append(row)
    compared = {row["quantity"] for row in content["rows"] if row["kind"] == "accuracy"}
    quantities = [quantity for quantity in content["quantities"] if quantity in compared]
    return environment.get_template("verification.jinja").render(
        report=content, rows=rows, matrix=matrix(content["rows"]), quantities=quantities,
        failures=[row for row in content["rows"] if row["failed"]],
        drawing=drawing, names={case["case"]: case["question"].split("\n\n")[0] for case in content["cases"]},
    )  # fmt: skip


def drawing(figure: Mapping[str, Any], prefix: str) -> Markup:
    """Return curves as SVG."""
    scale = {axis: "log" if axis in figure["log"] else "linear" for axis in "xy"}
    styles = ("line", "points", "dashed")
    series = [Series(label=label, x=x, y=y, style="line" if number == 0 else styles[number % 3])
              for number, (label, (x, y)) in enumerate(figure["curves"].items())]  # fmt: skip
    panel = Panel(xlabel=figure["x"], ylabel=figure["y"], xscale=scale["x"], yscale=scale["y"], series=series)
    return svg_of(Figure(id="figure", caption=figure["title"] or "figure", solution=panel), prefix)


def _number(value: float | int | str | None) -> str:
    if value is None or isinstance(value, str):
        return value or "–"
    return str(value) if isinstance(value, int) else f"{value:.9g}"


def _short(value: float | None) -> str:
    return "–" if value is None else f"{value:.2g}"
