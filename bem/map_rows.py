"""Rows of a map, each solved as a ridge of its own, and the median and scatter of their answers.

With profile.row = "all" a scene is solved for the rows 0, n, 2 n, .. of its map, profile.every = n.  A row is solved as
if it stood alone in the scene, so that results do not depend on the number of worker processes.  A row that is refused
or does not converge is named with its reason and takes no part in the statistics.

Of each answer at each target: the median over rows, and the scatter, half of the distance between the 16 % and 84 %
quantiles, which is the standard deviation of a normal distribution.  Limits: a ridge model; neighbouring rows of a map
are alike, and the scatter is of rows, not the error of a two-dimensional contact.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from bem.geometry.ranges import Mistake, shown
from bem.geometry.table import plain
from bem.loading.crew import at_work
from bem.scene.digest import digest
from bem.scene.result import Result
from bem.scene.result_file import RESULT_FILE, read_result, write_result
from bem.scene.result_views import UNITS
from bem.scene.scene import Scene, Tables, parse_scene, refuse_unclear
from bem.scene.scene_error import SceneError
from bem.scene.scene_file import read_tables
from bem.scene.scene_scan import ALL_ROWS, measured_line, without_arrays
from bem.scene.scene_tables import ProfileTable
from bem.scene.state import FINAL_STATUSES
from bem.scene.stored_json import CorruptResultError
from bem.solver import solve

ROW_FOLDERS = "row-[0-9]*"  # of `folder_of_row`
OUTCOMES, ANSWERED = "rows.csv", "answered"  # file of the outcome of each row, and that of a row with an answer
QUANTILES = (0.16, 0.5, 0.84)  # format: of the answers of all rows
SKIPPED = ("branch", "status", "target", "certified")  # columns of the answer that are no quantities

Content = Mapping[str, Any]
OfRows = tuple[Content, Path, Path | None]  # tables, folder of file names, folder of results
Outcome = tuple[Result | None, str]  # of a row: the result, and the reason where there is no answer


@dataclass(frozen=True, repr=False)
class RowResults:
    """Results of the rows of a map by their numbers, and the reasons of rows without an answer."""

    results: dict[int, Result]
    failures: dict[int, str]

    def to_table(self) -> dict[str, NDArray[Any]]:
        """Return median and scatter of each quantity at each target, one array a column, as pandas takes them.

        Columns: target (m or Pa), branch, quantity, unit, rows (their number), median, and scatter, half of the
        distance between the quantiles of 16 % and 84 %.
        """
        columns: dict[str, list[Any]] = {
            name: [] for name in ("target", "branch", "quantity", "unit", "rows", "median", "scatter")
        }
        for (target, branch, name), values in self._answers().items():
            entry = (target, branch, name, UNITS.get(name, ""), len(values), *median_and_scatter(values))
            for column, value in zip(columns.values(), entry, strict=True):
                column.append(value)
        return {name: np.array(values) for name, values in columns.items()}

    def __repr__(self) -> str:
        failed = f", {len(self.failures)} failed, reasons in .failures" if self.failures else ""
        return f"<RowResults: {len(self.results)} rows of a map answered{failed}>"

    def _answers(self) -> dict[tuple[float, str, str], list[float]]:
        """Return the known values of each quantity over the rows, by target and branch."""
        answers: dict[tuple[float, str, str], list[float]] = {}
        for result in self.results.values():
            table = result.to_table("targets")
            names = [name for name in table if name not in SKIPPED and not name.startswith("error_estimate_")]
            for k, (target, branch) in enumerate(zip(table["target"], table["branch"], strict=True)):
                for name in names:
                    values = answers.setdefault((float(target), str(branch), name), [])
                    if np.isfinite(table[name][k]):
                        values.append(float(table[name][k]))
        return {key: values for key, values in answers.items() if values}


def median_and_scatter(values: Sequence[float]) -> tuple[float, float]:
    """Return the median of some numbers, and half of the distance between their 16 % and 84 % quantiles."""
    low, median, high = np.quantile(values, QUANTILES).tolist()
    return median, (high - low) / 2


def rows_of(tables: Content, base: Path) -> tuple[range, Scene]:
    """Return the rows that a scene with row = "all" asks for, and the scene of the first row that can be solved.

    Raises
    ------
    SceneError
        No row can be solved: the mistakes of the first.
    """
    every = tables["profile"].get("every", 1)
    if not isinstance(every, int) or isinstance(every, bool) or every < 1:
        raise SceneError([Mistake("profile.every", f"= {shown(every)}", "an integer >= 1")])
    first: SceneError | None = None
    row, count = 0, 1
    while row < count:
        try:
            scene = parse_scene(tables_of_row(tables, row), base)
        except SceneError as error:
            first, count = first or error, _count(tables, base, error)
            row += every
            continue
        assert scene.scan is not None
        return range(0, scene.scan.steps[0]["rows"], every), scene
    assert first is not None
    raise first


def _count(tables: Content, base: Path, error: SceneError) -> int:
    """Return the number of rows of the map of a scene whose row cannot be solved; raise the error if none is read."""
    from bem.scans.scan_file_error import ScanFileError

    data, arrays, _ = without_arrays(tables_of_row(tables, 0))
    try:
        raw = measured_line(data["profile"], base, arrays)
    except (ScanFileError, KeyError, TypeError) as unread:
        raise error from unread
    return int(raw.facts["rows"])


def tables_of_row(tables: Content, row: int) -> dict[str, Any]:
    """Return the tables of the scene of a row."""
    profile = {key: value for key, value in tables["profile"].items() if key != "every"}
    return {**tables, "profile": profile | {"row": row}}


def asks_for_rows(tables: Content) -> bool:
    """Return whether a scene asks for all rows of a map."""
    profile = tables.get("profile")
    return isinstance(profile, Mapping) and profile.get("row") == ALL_ROWS


def folder_of_row(folder: Path, row: int) -> Path:
    """Return the folder of the result of a row."""
    return folder / f"row-{row:04d}"


def solve_rows(
    scene: Path | str | Content | None = None,
    jobs: int = 1,
    folder: Path | None = None,
    progress: Callable[[int, str], None] | None = None,
    **given: Unpack[Tables],
) -> RowResults:
    """Solve the rows of a map.

    Parameters
    ----------
    scene : path or mapping, optional
        Scene file or tables, with profile.row = "all" and perhaps profile.every.
    jobs : int
        Worker processes; results do not depend on it.  ChildProcessError if one is killed.
    folder : Path, optional
        Every row is written into a folder of it when it is solved, and rows that the folder holds are not solved again.
    progress : callable, optional
        Called with each row, and "answered" or the reason why it is not.
    **given
        `profile`, `solid`, `loading`, `layer`, ...: objects or mappings, where no scene is given.  The profile may be
        {"kind": "samples", "h": heights, "spacing": 1e-6, "row": "all"} with an array of two indices, the first along
        x, as `linecontact keys profile` has it.

    Raises
    ------
    SceneError
        No row that can be solved.
    TypeError
        A scene without profile.row = "all"; neither a scene nor tables, or both.
    """
    refuse_unclear(scene, given)
    tables: Content = given if scene is None else scene if isinstance(scene, Mapping) else read_tables(scene)
    base = Path(scene).parent if isinstance(scene, str | Path) else Path()
    if isinstance(tables.get("profile"), ProfileTable):
        tables = {**tables, "profile": plain(tables["profile"])}
    if not asks_for_rows(tables):
        parse_scene(tables, base)
        raise TypeError('solve_rows: the scene is of one profile; bem.solve solves it, profile.row = "all" has rows')
    rows, _ = rows_of(tables, base)
    shared: OfRows = tables, base, folder
    results, failures = {}, {}
    with at_work(min(jobs, len(rows)), shared) as each:
        for row, (result, reason) in zip(rows, each(solved_row, rows), strict=True):
            if result is not None and result.status == "interrupted":
                raise KeyboardInterrupt
            if reason or result is None:
                failures[row] = reason
            else:
                results[row] = result
            if progress is not None:
                progress(row, reason or ANSWERED)
    return RowResults(results, failures)


def read_rows(folder: Path | str) -> RowResults:
    """Read the rows of a map that a run has solved into a folder.

    Raises
    ------
    CorruptResultError
        The folder holds no map that was solved to its end, or a row that cannot be read.
    """
    path = Path(folder) / OUTCOMES
    try:
        with path.open(encoding="utf-8", newline="") as file:
            outcomes = {int(line["row"]): line["outcome"] for line in csv.DictReader(file)}
    except FileNotFoundError as error:
        raise CorruptResultError(f"{folder}: holds no map that was solved row by row to its end") from error
    except (KeyError, ValueError) as error:
        raise CorruptResultError(f"{path}: not the outcomes of the rows of a map") from error
    answered = [row for row, outcome in outcomes.items() if outcome == ANSWERED]
    results = {row: read_result(folder_of_row(Path(folder), row)) for row in answered}
    return RowResults(results, {row: outcome for row, outcome in outcomes.items() if row not in results})


def solved_row(shared: OfRows, row: int) -> Outcome:
    """Return the outcome of a row, stored or solved."""
    tables, base, folder = shared
    try:
        scene = parse_scene(tables_of_row(tables, row), base)
    except SceneError as error:
        return None, "; ".join(map(str, error.mistakes))
    try:
        result = None if folder is None else _stored(scene, folder_of_row(folder, row))
    except CorruptResultError as error:
        return None, f"{error}; --overwrite solves all rows again"
    if result is None:
        result = solve(scene)
        if folder is not None and result.status != "interrupted":
            write_result(result, folder_of_row(folder, row))
    if result.answered:
        return result, ""
    return result, f"{result.status.replace('_', ' ')}: {result.failure or 'a target was not met'}"


def _stored(scene: Scene, folder: Path) -> Result | None:
    """Return the finished result of a scene in a folder; None without one."""
    if not (folder / RESULT_FILE).exists():
        return None
    result = read_result(folder)
    same = digest(result.scene) == digest(scene.resolved())
    return result if same and result.status in FINAL_STATUSES else None
