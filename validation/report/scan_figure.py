"""A scan before and after its preparation: heights as measured and as solved, and its power spectrum.

The numbers are those that a result stores (`PeriodicSamples.drawn` in bem/scans): scan_x, scan_h and
profile_x, profile_h in m.  Both lines are drawn about their own mean.  A second figure is the power spectrum of the
scan, scan_density over scan_wavelength, with its noise floor and the profile's power law, as far as they are found, and
the wavelengths at which it is cut and should be (bem/scans/noise_floor.py).
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bem.command_line.answer_table import axis_unit
from bem.scans.scan_keys import CUTOFFS
from validation.harness.figure_data import axes, drawn, loglog, trace
from validation.harness.schema import Figure


def preparation_figure(fields: Mapping[str, NDArray[np.float64]]) -> Figure | None:
    """Draw the scan and the profile of a result from its fields; None without a scan."""
    if "scan_x" not in fields:
        return None
    lengths, heights = fields["profile_x"] - fields["profile_x"][0], fields["scan_h"] - np.nanmean(fields["scan_h"])
    (length, across), (height, upward) = (axis_unit(float(np.nanmax(np.abs(a))), "m") for a in (lengths, heights))
    series = []
    for name, label, style in (("scan", "as measured", "thin"), ("profile", "as prepared", "line")):
        x, h = length * fields[f"{name}_x"], height * fields[f"{name}_h"]
        y = [float(value) if np.isfinite(value) else None for value in h - np.nanmean(h)]
        series.append(trace(label, x, y, style))
    return drawn(
        "preparation", "Scan as measured and as prepared.", axes(f"x / {across}", f"height / {upward}", *series)
    )


def spectrum_figure(fields: Mapping[str, NDArray[np.float64]], steps: Sequence[Mapping[str, Any]]) -> Figure | None:
    """Draw the power spectrum over wavelengths; None for a result without a spectrum, or with equal heights."""
    positive = np.flatnonzero(fields.get("scan_density", np.zeros(0)) > 0)
    if not positive.size:
        return None
    wavelength, density = (fields[name][positive] for name in ("scan_wavelength", "scan_density"))
    length, unit = axis_unit(float(wavelength.min()), "m")
    series = [trace("power spectrum of the scan", length * wavelength, density)]
    facts = {key: value for step in steps for key, value in step.items() if step["step"] == "spectrum"}
    if "noise_density" in facts:
        ends = (wavelength.min(), wavelength.max())
        series.append(trace("noise floor", [length * end for end in ends], [facts["noise_density"]] * 2, "dashed"))
    height = [float(density.min()), float(density.max())]
    series += [trace(f"{name}, {length * at:.3g} {unit}", [length * at] * 2, height) for name, at in _cuts(steps)]
    return drawn(
        "spectrum", "Power spectrum of the scan, one-sided.", loglog(f"wavelength / {unit}", "density / m³", *series)
    )


def _cuts(steps: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, float]]:
    """Yield names and wavelengths (m) of the cuts of a scan and of the suggested cut."""
    by_name = {step["step"]: step for step in steps}
    if "period" in by_name.get("periodic", {}) and "cut" in by_name:
        yield "harmonics end", by_name["periodic"]["period"] / by_name["cut"]["harmonics"]
    for key in CUTOFFS:
        if key in by_name.get("filter", {}):
            yield key, by_name["filter"][key]
    if "suggested_cutoff" in by_name.get("spectrum", {}):
        yield "suggested cut", by_name["spectrum"]["suggested_cutoff"]
