"""Rows of one case: made when the case asks for them, with what is stored of it."""

from pathlib import Path

import pytest

from validation.plugin import stored
from validation.plugin.rows import Rows

ROWS = pytest.StashKey[Rows]()


class RowFailure(pytest.fail.Exception):  # type: ignore[name-defined, misc]
    """Failure of rows, shown without a traceback."""

    def __init__(self, message: str) -> None:
        super().__init__(message, pytrace=False)


RowFailure.__module__, RowFailure.__qualname__ = "builtins", "Rows"  # pytest shows "Rows: 1 of 6 rows: ..."


def stored_file(item: pytest.Item) -> Path | None:
    """Return the stored.csv of a case."""
    return stored.file_for(item.path, item.config.rootpath)


def case_key(item: pytest.Item, file: Path) -> str:
    """Return the name of a case in stored.csv: its file below the folder, and its function."""
    return f"{item.path.relative_to(file.parent).as_posix()}::{item.nodeid.partition('::')[2]}"


def rows_of(item: pytest.Item) -> Rows:
    """Return the rows of a case, with its stored numbers."""
    if ROWS not in item.stash:
        file, option = stored_file(item), item.config.option
        known = (
            None if file is None or option.store or option.unstored else stored.errors_of(case_key(item, file), file)
        )
        item.stash[ROWS] = Rows(known, eager=item.config.option.usepdb, failure=RowFailure)
    return item.stash[ROWS]
