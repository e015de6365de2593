"""What was computed is kept on disk, a file for each piece, and taken again only where the same sources made it.

A file holds the key of what made it, the answer and a SHA-256 of that; it is written under a temporary name, flushed
and renamed, so that an interruption leaves the old file or the new one.  Answers are data classes, lists of them, or
pydantic models; every float comes back bit by bit, nan and infinity too.  Records of cases (runner.py) and answers of
studies (kept_answers.py) lie so.  Members of ensembles do not: they are results of the solver, in the files that its
own commands read and go by their scene, whatever sources made them (ensemble.py).
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from bem.scene.atomic_file import write_atomically

Answer = TypeVar("Answer")


class DamagedError(ValueError):
    """A file that is not what was written."""


def keep(path: Path, form: type[Answer], answer: Answer, key: str) -> None:
    """Write an answer of this form, with the key of what made it: sources, versions and whatever else decides it."""
    plain = json.loads(json.dumps(TypeAdapter(form).dump_python(answer)))
    write_atomically(path, json.dumps({"key": key, "sha256": _digest(plain), "answer": plain}, indent=1) + "\n")


def kept(path: Path, form: type[Answer], key: str) -> Answer | None:
    """The answer of a file, None where it is not there or has another key; DamagedError where it was changed or cut."""
    try:
        content = json.loads(path.read_text("utf-8"))
        if content["key"] != key:
            return None
        if content["sha256"] != _digest(content["answer"]):
            raise DamagedError(f"{path.name} is damaged")
        return TypeAdapter(form).validate_python(content["answer"])
    except FileNotFoundError:
        return None
    except (ValueError, KeyError, TypeError, ValidationError, RecursionError) as error:
        raise DamagedError(f"{path.name} is damaged") from error


def _digest(plain: Any) -> str:
    return hashlib.sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()
