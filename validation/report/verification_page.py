"""report.html of a verification run, made from the content of its report.json alone."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from jinja2 import UndefinedError
from markupsafe import Markup

from bem.scene.atomic_file import write_atomically
from validation.harness.figure_data import Figure
from validation.report.figures import svg_of
from validation.report.pages import PAGE, ReportError, filled

REPORT = "report.json"
PASSED = ("passed", "skipped")
PRECISIONS = {"2 digits": 1e-2, "4 digits": 1e-4, "8 digits": 1e-8}  # relative error of the contact fraction


def write(folder: Path, content: Mapping[str, Any]) -> None:
    """Write report.json, and report.html from it."""
    text = json.dumps(content, indent=1, allow_nan=False) + "\n"
    write_atomically(folder / REPORT, text)
    write_atomically(folder / PAGE, page(json.loads(text)))


def page_of_file(content: Mapping[str, Any]) -> str:
    """Return the page of a report.json that was read from a file; ReportError where it is not as `write` makes it."""
    try:
        return page(content)
    except (KeyError, TypeError, ValueError, AttributeError, UndefinedError) as error:
        raise ReportError(f"{REPORT}: not as a report is written ({type(error).__name__}: {error})") from error


def page(content: Mapping[str, Any]) -> str:
    """Return the page of a report.json."""
    rows = [row | {"target": f"row-{number}"} for number, row in enumerate(content["rows"], 1)]
    cases = [_case(case, f"case-{number}", rows) for number, case in enumerate(content["cases"], 1)]
    groups: dict[str, list[dict[str, Any]]] = {}
    for case in cases:
        groups.setdefault(case["title"], []).append(case)
    compared = {row["quantity"] for row in rows if row["kind"] == "accuracy"}
    return filled(
        "verification.jinja",
        {"class": lambda text: text.replace(" ", "-"), "digit": digit},
        report=dict(content) | {"cases": cases},
        statements=sorted(content["statements"], key=lambda line: line["verdict"] == "not run"),
        groups=groups,
        anchors={row["case"]: "not-run" for row in rows} | {case["case"]: case["anchor"] for case in cases},
        failures=[row for row in rows if row["failed"]],
        matrix=matrix(rows),
        fronts=[(case, table) for case in cases for table in case["tables"] if table.get("front")],
        prices=prices(content["costs"]),
        precisions=PRECISIONS,
        run_of_paper=sum(line["verdict"] != "not run" for line in content["statements"]),
        quantities=[quantity for quantity in content["quantities"] if quantity in compared],
        passed=PASSED,
        draw=drawing,
    )


def _case(case: Mapping[str, Any], anchor: str, rows: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Return a case as the page shows it: its rows of accuracy, the others, and its figures."""
    own = [row for row in rows if row["case"] == case["case"]]
    file, _, name = case["case"].rpartition("::")
    figures = [{"front": False} | figure for figure in case["figures"]]
    return dict(case) | {
        "anchor": anchor,
        "file": file,
        "parameters": name.partition("[")[2].removesuffix("]"),
        "title": case["method"].split("\n\n")[0].rstrip(".") or file or "Study",
        "accuracy": [row for row in own if row["kind"] == "accuracy" and row["routes"]],
        "others": [row for row in own if row["kind"] != "accuracy"],
        "figures": figures,
        "has_front": any(figure["front"] for figure in figures),
    }


def matrix(rows: Iterable[Mapping[str, Any]]) -> dict[str, dict[str, dict[str, Any]]]:
    """Return comparisons by pair of codes and quantity: their number, and the share of the allowed error they use."""
    cells: dict[str, dict[str, list[Mapping[str, Any]]]] = {}
    for row in rows:
        if row["kind"] == "accuracy" and row["routes"]:
            pair, other = (" – ".join(codes) for codes in (row["routes"], row["routes"][::-1]))
            cells.setdefault(other if other in cells else pair, {}).setdefault(row["quantity"], []).append(row)
    return {pair: {quantity: _cell(of) for quantity, of in line.items()} for pair, line in sorted(cells.items())}


def prices(costs: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return by problem and route the cheapest measured line that is as precise as each of `PRECISIONS`, or None."""
    routes: dict[tuple[str, str], list[Mapping[str, Any]]] = {}
    problems = [line["problem"] for line in costs]
    for line in sorted(costs, key=lambda line: problems.index(line["problem"])):
        routes.setdefault((line["problem"], line["route"]), []).append(line)
    return [
        {
            "problem": problem,
            "route": route,
            "cheapest": [
                min((line for line in lines if line["error"] <= error), key=lambda line: line["seconds"], default=None)
                for error in PRECISIONS.values()
            ],
        }
        for (problem, route), lines in routes.items()
    ]


def _cell(rows: list[Mapping[str, Any]]) -> dict[str, Any]:
    worst = max(rows, key=lambda row: (row["failed"], row["share"] or 0.0))
    shares = [row["share"] for row in rows if row["share"] is not None]
    return {
        "median": median(shares) if shares else None,
        "largest": max(shares, default=None),
        "many": len(rows),
        "verdict": worst["verdict"],
        "target": worst["target"],
    }


def drawing(figure: Mapping[str, Any], prefix: str) -> Markup:
    """Return a figure as SVG whose ids begin with the prefix."""
    return svg_of(Figure.model_validate({key: value for key, value in figure.items() if key != "front"}), prefix)


def digit(value: float | None) -> str:
    """Return a share in as little room as possible.

    Examples
    --------
    >>> digit(0.234), digit(0.0), digit(1e-5), digit(12.0), digit(None)
    ('.23', '0', '<.01', '12', '–')
    """
    if value is None:
        return "–"
    if 0 < value < 0.995:
        return "<.01" if value < 0.01 else f"{value:.2f}"[1:]
    return f"{value:.2g}"
