"""Views of a result: tables, a dataset of xarray, curves and a few words.

Columns are named as in result.json, with `error_estimate_` and `certificate_` before what these hold; edges and
reasons, which differ in number from state to state, are in `states` alone.  None reads as NaN.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import is_dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from bem.scene.array_names import FIELDS, split
from bem.scene.state import FINAL_STATUSES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

UNITS = {
    **dict.fromkeys(("penetration", "separation", "total_displacement", "position"), "m"),
    **dict.fromkeys(("certificate_min_gap", "certificate_mean_gap_error"), "m"),
    **dict.fromkeys(
        ("width_least", "width_median", "width_largest", "open_gap_mean", "open_gap_largest", "largest_gap"), "m"
    ),
    **dict.fromkeys(("open_gap_p10", "open_gap_p25", "open_gap_p50", "open_gap_p75", "open_gap_p90"), "m"),
    **dict.fromkeys(("mean_cubic_root", "widest_channel"), "m"),
    **dict.fromkeys(("contact_pressure", "peak_pressure"), "Pa"),
    **dict.fromkeys(("elastic_energy", "adhesion_energy", "total_energy", "energy_released"), "J/m^2"),
    **{"mean_pressure": "Pa", "stress_intensity_max": "Pa m^1/2", "contact_stiffness": "Pa/m", "cpu_seconds": "s"},
}
COORDINATES = {"branch", "target", "separation", "penetration", "mean_pressure", "event_kind", "event_penetration"}
COORDINATES |= {"field_q", "field_scan_x", "field_profile_x"}


class Views:
    """Views of a `Result`: tables, a dataset, curves and a few words."""

    scene: dict[str, Any]
    states: tuple[Any, ...]
    events: tuple[Any, ...]
    status: str
    warnings: tuple[Any, ...]
    fields: dict[str, NDArray[Any]]
    failure: str | None

    def to_table(self, of: Literal["states", "events", "targets"] = "states") -> dict[str, NDArray[Any]]:
        """Return states, events or the answer at targets by columns, one array each, as `pandas.DataFrame` takes them.

        Parameters
        ----------
        of : {"states", "events", "targets"}
            States and events have the names of result.json.

        Notes
        -----
        Columns of the targets, and error_estimate_ of the five from penetration to contact_fraction in their units; NaN
        where a number is not known.

        ========================================== ===== ==============================================
        column                                     unit  meaning
        ========================================== ===== ==============================================
        branch, status                                   loading or unloading; converged, or why not
        target                                     m, Pa value under control: a length, or a pressure
        penetration                                m     from first touch
        separation                                 m     mean gap over the period
        total_displacement                         m     of the plate of a layer
        mean_pressure                              Pa    load over the period
        contact_fraction                           1     length in contact over the period
        contact_pressure, peak_pressure            Pa    mean over the contacts; largest
        n_patches                                  1     number of contacts
        width_least, width_median, width_largest   m     of the contacts
        open_share                                 1     share of the period that is not in contact
        open_gap_mean, open_gap_largest            m     gap over the open length
        open_gap_p10, open_gap_p25, open_gap_p50   m     gap below which 10, 25, 50 % of it lie
        open_gap_p75, open_gap_p90                 m     gap below which 75, 90 % of it lie
        mean_cubic_root                            m     <g^3>^(1/3) over the period
        widest_channel                             m     longest stretch between two contacts
        certified                                        1 where the independent quadrature agrees
        ========================================== ===== ==============================================

        Units of the other columns, where they have any: energies J/m^2, stress_intensity_max Pa m^(1/2),
        contact_stiffness Pa/m, position m, cpu_seconds s, certificate_min_gap and certificate_mean_gap_error m.

        Raises
        ------
        ValueError
            Another value of `of`.
        """
        if of == "targets":
            return _answers([state for state in self.states if state.target], self.scene["loading"])
        if of not in ("states", "events"):
            raise ValueError(f'of = {of!r}; allowed: "states", "events" or "targets"')
        kind = get_type_hints(type(self))[of].__args__[0]
        return _columns(kind, getattr(self, of))

    @property
    def answered(self) -> bool:
        """Success of the scene: it ended as asked, or every target that was not met lies behind a pull-off.

        A tension beyond what the contact carries, asked for on the way out, is answered by the pull-off.
        """
        missed = [state for state in self.states if not state.found]
        pulled = [k for k, event in enumerate(self.events) if event.kind == "pull_off"]
        behind = [state.status == "unreachable" and bool(pulled) and pulled[0] < state.events for state in missed]
        return self.status in FINAL_STATUSES or (self.status == "unreachable" and any(behind) and all(behind))

    def came_apart(self) -> float | None:
        """Return the separation (m) at which the surfaces came apart for the last time; None where they did not."""
        depths = [event.penetration for event in self.events if event.kind == "pull_off"]
        first = next((state for state in self.states if state.found), None)
        return first.penetration + first.separation - depths[-1] if depths and first is not None else None

    def to_xarray(self) -> Any:
        """Return states, events (`event_...`) and fields as an `xarray.Dataset` (extra `xarray`).

        Every number has its unit ("1" where it has none).  Coordinates are the numbers of states and events, branch,
        separation, penetration and mean pressure of states, and the points on which fields are sampled.

        Raises
        ------
        ImportError
            xarray is not installed.
        """
        try:
            xarray = import_module("xarray")
        except ImportError as error:
            raise ImportError("xarray is not installed: pip install 'linecontact[xarray]'") from error
        variables: dict[str, Any] = {}
        for of, dimension, prefix in (("states", "state", ""), ("events", "event", "event_")):
            for name, column in self.to_table(of).items():  # type: ignore[arg-type]
                unit = UNITS.get(name.removeprefix("error_estimate_"), "1")
                variables[prefix + name] = (dimension, column, {"units": unit} if column.dtype.kind == "f" else {})
        for name, values in self.fields.items():
            stem, k = split(name)
            along, unit = FIELDS.get(stem, (f"of_{name}", "1"))
            attributes = {"units": unit} if values.dtype.kind == "f" else {}
            variables[f"field_{name}"] = (along.format(k=k) if values.ndim else (), values, attributes)
        of_points = [name for name in variables if name.rpartition("_")[0] in ("field_x", "field_sigma")]
        dataset = xarray.Dataset(variables, attrs={"title": self.scene.get("title", ""), "status": self.status})
        counted = {name: np.arange(dataset.sizes[name]) for name in ("state", "event")}
        return dataset.assign_coords(counted).set_coords([*(COORDINATES & set(variables)), *of_points])

    def plot(self) -> Figure:
        """Draw the mean pressure against contact fraction and against separation, with its estimated error."""
        figure: Figure = import_module("bem.scene.plots").curves(self.states)
        return figure

    def __repr__(self) -> str:
        words = [f"{len(self.states)} states", f"{sum(state.target for state in self.states)} at targets"]
        words.append(f"{len(self.events)} events")
        if self.warnings:
            words.append(f"{len(self.warnings)} warning{'s' * (len(self.warnings) != 1)} in .warnings")
        if states := [state for state in self.states if state.found]:
            last = states[-1]
            words.append(f"last at {last.mean_pressure:.6g} Pa, contact fraction {last.contact_fraction:.6g}")
        status = "unreachable, answered: pulled off" if self.status == "unreachable" and self.answered else self.status
        return f"<Result {status}: {', '.join(words)}>"


def _answers(states: Sequence[Any], loading: dict[str, Any]) -> dict[str, NDArray[Any]]:
    """Return the columns of the answer; `target` is the value under control: asked for, or held at a pressure."""
    targets = loading["targets"]
    held = [getattr(state, loading["control"]) if state.found else math.nan for state in states]
    asked = [
        targets[state.index] if state.index < len(targets) else value for value, state in zip(held, states, strict=True)
    ]
    target = np.array(asked, dtype=np.float64)
    named = ("branch", "status")
    columns: dict[str, NDArray[Any]] = {name: np.array([getattr(state, name) for state in states]) for name in named}
    rows = [_answer(state) for state in states]
    names = list(_answer(states[0])) if states else []
    columns["target"] = target
    return columns | {name: np.array([row[name] for row in rows], dtype=np.float64) for name in names}


def _answer(state: Any) -> dict[str, float | None]:
    """Return the numbers of a target; None where no state has them."""
    widths = sorted(b - a for a, b in state.edges) or [math.nan]
    known = state.found
    share = state.contact_fraction if known else math.nan
    opened = 1 - share
    numbers = ("penetration", "separation", "total_displacement", "mean_pressure")
    error = {f"error_estimate_{name}": getattr(state.error_estimate, name) for name in ("contact_fraction", *numbers)}
    return {
        **{name: getattr(state, name) if known else math.nan for name in numbers},
        "contact_fraction": share,
        **error,
        "contact_pressure": state.mean_pressure / share if share else math.nan,
        "peak_pressure": state.peak_pressure if known else None,
        "n_patches": state.n_patches if known else None,
        "width_least": widths[0],
        "width_median": float(np.median(widths)),
        "width_largest": widths[-1],
        "open_share": opened,
        "open_gap_mean": state.separation / opened if opened > 0 else 0.0 if known else math.nan,
        "open_gap_largest": state.largest_gap if known else None,
        **_gap_columns(state),
        "certified": state.certificate.ok,
    }


def _gap_columns(state: Any) -> dict[str, float]:
    """Return the numbers of leakage of a target, m; NaN where no state was found."""
    gaps = state.gaps if state.found else None
    levels = ("p10", "p25", "p50", "p75", "p90")
    columns = {f"open_gap_{level}": math.nan if gaps is None else getattr(gaps.quantiles, level) for level in levels}
    names = ("mean_cubic_root", "widest_channel")
    return columns | {name: math.nan if gaps is None else getattr(gaps, name) for name in names}


def _columns(kind: type, records: Sequence[Any], prefix: str = "") -> dict[str, NDArray[Any]]:
    """Return records of a dataclass by columns; columns of nested records begin with the name of the record."""
    columns: dict[str, NDArray[Any]] = {}
    for name, hint in get_type_hints(kind).items():
        values = [getattr(record, name) for record in records]
        if is_dataclass(hint):
            columns |= _columns(hint, values, f"{prefix}{name}_")  # type: ignore[arg-type]
        elif hint in (str, int, bool) or get_origin(hint) is Literal:
            columns[prefix + name] = np.array(values, dtype=hint if isinstance(hint, type) else str)
        elif hint in (float, float | None, int | None, bool | None):
            columns[prefix + name] = np.array(
                [np.nan if value is None else value for value in values], dtype=np.float64
            )
    return columns
