"""Results or profiles of an ensemble as one table: what `pandas.DataFrame` and the like take, grouped by `member`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from bem.geometry.profile import Profile
from bem.scene.result import Result

Member = Result | Profile


def ensemble_table(
    members: Sequence[Member] | Mapping[str, Member], of: Literal["states", "events"] = "states"
) -> dict[str, NDArray[Any]]:
    """Columns of all members below one another, `member` first: its number from 0, or its name in a mapping.

    Parameters
    ----------
    members : sequence or mapping of Result, or of Profile
        Of one kind.
    of : {"states", "events"}
        Which table of results; their columns are those of `Result.to_table`.  Profiles have `x` and `height`, m.

    Raises
    ------
    ValueError
        No members, members of two kinds, or another table.

    Examples
    --------
    >>> waves = {name: Profile.from_harmonics(0.01, [order], [1e-6]) for name, order in (("long", 1), ("short", 3))}
    >>> table = ensemble_table(waves)
    >>> list(table), [str(name) for name in np.unique(table["member"])]
    (['member', 'x', 'height'], ['long', 'short'])
    """
    named = dict(members) if isinstance(members, Mapping) else dict(enumerate(members))
    kinds = {type(member) for member in named.values()}
    if kinds not in ({Result}, {Profile}):
        found = ", ".join(sorted(kind.__name__ for kind in kinds)) or "none"
        raise ValueError(f"members = {found}; allowed: at least one Result, or at least one Profile")
    tables = {name: _columns(member, of) for name, member in named.items()}
    counts = [len(next(iter(table.values()))) for table in tables.values()]
    columns = next(iter(tables.values()))
    joined = {column: np.concatenate([table[column] for table in tables.values()]) for column in columns}
    return {"member": np.repeat(np.array(list(named)), counts)} | joined


def _columns(member: Member, of: Literal["states", "events"]) -> dict[str, NDArray[Any]]:
    """The table of one member."""
    if isinstance(member, Result):
        return member.to_table(of)
    x, height = member.grid
    return {"x": x, "height": height}
