"""Tables of a scene file, unchecked: TOML in UTF-8."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from bem.geometry.ranges import Mistake
from bem.geometry.regular_file import read_regular
from bem.scans.read_bytes import BACKSLASHES
from bem.scene.scene_error import SceneError

NUMBERS = re.compile(r"^[ \t]*[-+]?[.,]?\d[-+\d.,;eE \t]*\r?$", re.MULTILINE)  # line of numbers alone


def read_tables(path: Path | str) -> dict[str, Any]:
    """Read the tables of a scene file, unchecked; SceneError if the path is no regular file or no TOML."""
    path = Path(path)
    try:
        text = read_regular(path).decode("utf-8-sig")
        return tomllib.loads(text)
    except OSError as error:
        scenes = [str(file) for file in sorted(path.glob("*.toml"))[:3]] if path.is_dir() else []
        allowed = " or ".join(["a TOML file", *scenes])
        raise SceneError([Mistake(str(path), f"cannot be read ({error.strerror})", allowed)]) from error
    except tomllib.TOMLDecodeError as error:
        mistake = _trace_mistake(path, text) or _syntax_mistake(path, text, str(error))
        raise SceneError([mistake]) from error
    except (ValueError, RecursionError) as error:
        mistake = Mistake(str(path), f"is not TOML ({error})", "a TOML file in UTF-8")
        trace = _trace_mistake(path, None) if isinstance(error, UnicodeDecodeError) else None
        raise SceneError([trace or mistake]) from error


def _trace_mistake(path: Path, text: str | None) -> Mistake | None:
    """Return the mistake of a measured trace in place of a scene, with the command that solves it.

    None for a file that is named as a scene, and for a text without a line of numbers; `text` is None of other bytes.
    """
    if path.suffix.lower() == ".toml" or (text is not None and NUMBERS.search(text) is None):
        return None
    solved = f"linecontact answer {path} --youngs-modulus E --poisson-ratio NU --pressure P"
    return Mistake(str(path), "is a measured trace, no scene", f"a TOML file; a trace is solved by: {solved}")


def _syntax_mistake(path: Path, text: str, error: str) -> Mistake:
    """Return the mistake of a text that is not TOML: the line that the parser names, and what is allowed there."""
    place = re.search(r"\(at line (\d+), column \d+\)", error)
    number = int(place[1]) if place else 0
    line = text.splitlines()[number - 1].strip() if 0 < number <= len(text.splitlines()) else ""
    sign = re.search("[\u2010-\u2015\u2212]\\s*[0-9.]", text)
    if sign is not None:
        allowed = f"- before numbers, not {sign[0][0]}"
    elif error.startswith(("Invalid hex value", "Unescaped '\\'")):  # a name of a file under Windows
        allowed = f"names with {BACKSLASHES}"
    elif error.startswith("Cannot overwrite a value"):
        allowed = f"each key once, and {line.partition('=')[0].strip()} is there before"
    elif re.fullmatch(r"[^=]*=\s*[-+]?\d+,\d+\s*(#.*)?", line):
        allowed = "a decimal point, as in 0.5"
    else:
        allowed = "key = value: a number, a text in quotes, true, false, or a list of these in []"
    return Mistake(str(path), f"is not TOML in line {number}: {line}" if line else f"is not TOML: {error}", allowed)
