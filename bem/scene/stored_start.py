"""Start of a path from a stored state, which must have converged and belong to the bodies of the scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bem.geometry.ranges import Mistake, shown
from bem.scene.result_file import read_result
from bem.scene.scene_rules import QUESTIONS
from bem.scene.state import FINAL_STATUSES, State
from bem.scene.stored_json import CorruptResultError


@dataclass(frozen=True)
class StartingState:
    """Stored state from which a path starts, with the resolved scene that it was computed for."""

    state: State
    scene: dict[str, Any]


def stored_start(initial: Any, control: str | None, base_dir: Path) -> tuple[StartingState | None, list[Mistake]]:
    """Return the state that a valid loading.initial names, None if loading.initial names no state, and the mistakes.

    The state must provide the quantity of loading.control; relative names start from `base_dir`.
    """
    if not isinstance(initial, Mapping):
        return None, []
    name, index = initial["result"], initial["state"]
    try:
        result = read_result(base_dir / name)
    except FileNotFoundError:
        return None, [Mistake("loading.initial.result", f"= {shown(name)}", "a folder with a result.json")]
    except (OSError, CorruptResultError) as error:
        return None, [
            Mistake("loading.initial.result", f"= {shown(name)}: {error}", "a folder with a sound result.json")
        ]
    if index >= len(result.states):
        allowed = f"an integer >= 0 and below {len(result.states)}, the number of states stored"
        return None, [Mistake("loading.initial.state", f"= {index}", allowed)]
    state = result.states[index]
    if state.status not in FINAL_STATUSES:
        return None, [Mistake("loading.initial.state", f"= {index} has status {state.status}", "a converged state")]
    if control is not None and getattr(state, control) is None:
        return None, [Mistake("loading.initial.state", f"= {index} has no {control}", "a state of a layer")]
    return StartingState(state, result.scene), []


def other_problem(resolved: Mapping[str, Any], start: StartingState | None) -> Iterator[Mistake]:
    """Yield a mistake for every table but `QUESTIONS` that differs between a stored start and the resolved scene."""
    if start is None:
        return
    for name in dict.fromkeys([*resolved, *start.scene]):
        if name not in QUESTIONS and resolved.get(name) != start.scene.get(name):
            yield Mistake("loading.initial.result", f"was computed with another [{name}]", "a result of the same one")
