"""Figures as data: what cases, studies and pages draw, and what report.json holds of it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

Text = Annotated[str, Field(min_length=1)]
Id = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]*$")]  # of elements of the page, and of files
Style = Literal["line", "points", "dashed", "band", "bars", "thin"]
DRAWN = 1e250  # largest number of a figure: beyond it the margins of axes are no numbers


def _numbers(values: Iterable[float | None]) -> list[float | None]:
    return [None if value is None else float(value) for value in values]


Values = Annotated[list[float | None], BeforeValidator(_numbers)]  # from lists, arrays or generators


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Series(_Strict):
    """Curve or set of points; a `band` or error `bars` lie between `y` and `upper`, `thin` curves stay behind.

    None is not drawn.  Series of one `hue` share a colour; without it, each takes the next one.
    """

    label: str
    x: Values
    y: Values
    style: Style = "line"
    upper: Values | None = None
    hue: int | None = Field(None, ge=0)

    @model_validator(mode="after")
    def _of_one_length(self) -> Series:
        if len(self.x) != len(self.y) or (self.upper is not None and len(self.upper) != len(self.x)):
            raise ValueError(f"series {self.label!r}: {len(self.x)} values of x for {len(self.y)} of y")
        if (self.style in ("band", "bars")) != (self.upper is not None):
            raise ValueError(f"series {self.label!r}: a band or bars have an upper side, and nothing else has")
        for value in (*self.x, *self.y, *(self.upper or ())):
            if value is not None and DRAWN < abs(value) < math.inf:
                raise ValueError(f"series {self.label!r}: {value:g}, at most {DRAWN:g} can be drawn")
        return self


class Panel(_Strict):
    """Axes with their series."""

    xlabel: str
    ylabel: str
    xscale: Literal["linear", "log"] = "linear"
    yscale: Literal["linear", "log"] = "linear"
    series: list[Series] = Field(min_length=1)


class Figure(_Strict):
    """A figure with its caption."""

    id: Id
    caption: Text
    solution: Panel


def trace(label: str, x: Any, y: Any, style: str = "line", hue: int | None = None, upper: Any = None) -> Series:
    """Return a series; arguments as of `Series`."""
    return Series(label=label, x=x, y=y, style=style, hue=hue, upper=upper)


def drawn(name: str, caption: str, xlabel: str, ylabel: str, *series: Series, log: str = "") -> Figure:
    """Return a figure with a name unique in the report; `log` names its logarithmic axes, such as "xy"."""
    scales: Any = {f"{axis}scale": "log" if axis in log else "linear" for axis in "xy"}
    return Figure(id=name, caption=caption, solution=Panel(xlabel=xlabel, ylabel=ylabel, series=list(series), **scales))
