"""Figures of the theory correction: area and separation on the hold-out, before and after, with ensemble error bars."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from validation.harness.figure_data import drawn, loglog, marks, semilogx, shaded, trace
from validation.harness.schema import Figure, Series
from validation.studies.theory_correction.hold_out import CALIBRATED, PLAIN, HeldOut


def chosen(judged: Sequence[HeldOut], adhesive: bool, low: float = 0.0, high: float = 1.0) -> list[HeldOut]:
    """Those without or with adhesion at loads in [low, high)."""
    return [one for one in judged if one.adhesive == adhesive and low <= one.load < high]


def figures_of(judged: Sequence[HeldOut]) -> list[Figure]:
    """Two figures without adhesion, and two with it where it was judged."""
    figures = []
    for adhesive in (False, True):
        some = chosen(judged, adhesive)
        if not some:
            continue
        words = "with" if adhesive else "without"
        at = [one.contact_fraction for one in some]
        figures.append(
            drawn(f"landing-correction-{words}-adhesion",
                  f"Hold-out {words} adhesion: contact fraction by the plain and the corrected theory against "
                  "that of the ensembles; below the relative errors with two standard errors of the ensembles.",
                  loglog("contact fraction of the ensembles", "of the theory",
                         marks("calibrated", at, _times(some, CALIBRATED)),
                         marks("plain theory", at, _times(some, PLAIN)),
                         trace("equal", [min(at), max(at)], [min(at), max(at)])),
                  semilogx("contact fraction of the ensembles", "relative error",
                           marks("calibrated", at, [one.area[CALIBRATED] for one in some]),
                           marks("plain theory", at, [one.area[PLAIN] for one in some]), _noise(some))),
        )  # fmt: skip
        figures.append(_separation_figure(some, words))
    return figures


def _separation_figure(some: Sequence[HeldOut], words: str) -> Figure:
    ordered = sorted(some, key=lambda one: one.separation)
    at = [one.separation for one in ordered]
    noise: list[float | None] = [known(2 * one.separation_noise / one.separation) for one in ordered]
    return drawn(f"correction-separation-{words}-adhesion",
                 f"Hold-out {words} adhesion: relative error of the separation, before and after, with two standard "
                 "errors of the ensembles.",
                 semilogx("separation of the ensembles / h_rms", "relative error",
                          *(
                              marks(name, at,
                                    [known(one.separations.get(name, np.nan) / one.separation - 1) for one in ordered])
                              for name in (CALIBRATED, PLAIN)
                          ),
                          shaded("two standard errors", at, [None if value is None else -value for value in noise],
                                 noise)))  # fmt: skip


def _times(some: Sequence[HeldOut], name: str) -> list[float | None]:
    return [one.contact_fraction * (1 + one.area[name]) for one in some]


def _noise(some: Sequence[HeldOut]) -> Series:
    ordered = sorted(some, key=lambda one: one.contact_fraction)
    noise: list[float | None] = [2 * one.area_noise for one in ordered]
    return shaded("two standard errors", [one.contact_fraction for one in ordered],
                  [None if value is None else -value for value in noise], noise)  # fmt: skip


def known(value: float) -> float | None:
    """A finite number as it is, any other as None."""
    return float(value) if np.isfinite(value) else None
