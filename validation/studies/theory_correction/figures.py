"""Figures of the theory correction: area and separation on the hold-out, before and after, with ensemble error bars."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from validation.harness.schema import Figure, Panel, Series
from validation.studies.theory_correction.judge import CALIBRATED, PLAIN, Judged


def chosen(judged: Sequence[Judged], adhesive: bool, low: float = 0.0, high: float = 1.0) -> list[Judged]:
    """Those without or with adhesion at loads in [low, high)."""
    return [one for one in judged if one.adhesive == adhesive and low <= one.load < high]


def figures_of(judged: Sequence[Judged]) -> list[Figure]:
    """Two figures without adhesion, and two with it where it was judged."""
    figures = []
    for adhesive in (False, True):
        some = chosen(judged, adhesive)
        if not some:
            continue
        words = "with" if adhesive else "without"
        at = [one.contact_fraction for one in some]
        figures.append(
            Figure(
                id=f"landing-correction-{words}-adhesion",
                caption=f"Hold-out {words} adhesion: contact fraction by the plain and the corrected theory against "
                "that of the ensembles; below the relative errors with two standard errors of the ensembles.",
                solution=Panel(
                    xlabel="contact fraction of the ensembles",
                    ylabel="of the theory",
                    xscale="log",
                    yscale="log",
                    series=[
                        Series(label="calibrated", x=at, y=_times(some, CALIBRATED), style="points"),
                        Series(label="plain theory", x=at, y=_times(some, PLAIN), style="points"),
                        Series(label="equal", x=[min(at), max(at)], y=[min(at), max(at)]),
                    ],
                ),
                error=Panel(
                    xlabel="contact fraction of the ensembles",
                    ylabel="relative error",
                    xscale="log",
                    series=[
                        Series(label="calibrated", x=at, y=[one.area[CALIBRATED] for one in some], style="points"),
                        Series(label="plain theory", x=at, y=[one.area[PLAIN] for one in some], style="points"),
                        _noise(some),
                    ],
                ),
            )
        )
        figures.append(_separation_figure(some, words))
    return figures


def _separation_figure(some: Sequence[Judged], words: str) -> Figure:
    ordered = sorted(some, key=lambda one: one.separation)
    at = [one.separation for one in ordered]
    noise: list[float | None] = [known(2 * one.separation_noise / one.separation) for one in ordered]
    return Figure(
        id=f"correction-separation-{words}-adhesion",
        caption=f"Hold-out {words} adhesion: relative error of the separation, before and after, with two standard "
        "errors of the ensembles.",
        solution=Panel(
            xlabel="separation of the ensembles / h_rms",
            ylabel="relative error",
            xscale="log",
            series=[
                *(
                    Series(
                        label=name,
                        x=at,
                        y=[known(one.separations.get(name, np.nan) / one.separation - 1) for one in ordered],
                        style="points",
                    )
                    for name in (CALIBRATED, PLAIN)
                ),
                Series(
                    label="two standard errors",
                    x=at,
                    y=[None if value is None else -value for value in noise],
                    upper=noise,
                    style="band",
                ),
            ],
        ),
    )


def _times(some: Sequence[Judged], name: str) -> list[float | None]:
    return [one.contact_fraction * (1 + one.area[name]) for one in some]


def _noise(some: Sequence[Judged]) -> Series:
    ordered = sorted(some, key=lambda one: one.contact_fraction)
    noise: list[float | None] = [2 * one.area_noise for one in ordered]
    return Series(
        label="two standard errors",
        x=[one.contact_fraction for one in ordered],
        y=[None if value is None else -value for value in noise],
        upper=noise,
        style="band",
    )


def known(value: float) -> float | None:
    """A number, or None for what is none."""
    return float(value) if np.isfinite(value) else None
