"""Warnings about a scene whose numbers are probably mistaken, as in a wrong unit.

A profile in a wrong unit is solved as accurately as one in the right unit.  Only dimensionless groups tell.  With the
harmonics h_m of the profile, q_m = 2 pi m / period and E* = E / (1 - nu^2), `MEANINGS` defines each group.  The energy
of complete contact is that of Persson, Tosatti, J. Chem. Phys. 115 (2001) 5597; for one wave the group is 2 pi alpha^2
with the alpha of Johnson, Int. J. Solids Struct. 32 (1995) 423.

Looked for are lengths in mm instead of m, pressures or moduli in MPa instead of Pa, slopes beyond small strain, a layer
that is thin beside its heights, adhesion that outweighs elasticity; and in a scan spikes, a cut within the noise, no
heights but constant ones, and a form (an arc) that is kept.  Nothing that is computed depends on this module.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from bem.scene.result import Caution
from bem.scene.scene import Scene

MEANINGS = {
    "rms_height": "sqrt(sum h_m^2 / 2) of the profile as it is cut, m",
    "rms_slope": "sqrt(sum q_m^2 h_m^2 / 2) of the profile as it is cut; the model is one of small slopes",
    "pressure_scale": "E* times the rms slope, Pa: mean pressures of this size press a half-space flat",
    "adhesion_over_elastic_energy": "w over the elastic energy of complete contact; above 1 contact closes by itself",
    "noise_share_of_slope": "share of the mean square slope that noise makes, of samples with a noise floor",
}
SMALL_SLOPE = 0.5  # format: rms slope above which small strain fails
SQUEEZED = 0.1  # format: rms height over the thickness of a layer above which small strain fails
SLOPES = (1e-7, 1.0)  # format: rms slopes of real surfaces, from a silicon wafer on
PERIODS = (1e-9, 1.0)  # format: m, lengths that are probably right
SCANS = (0.1, 1e-4)  # format: m, longest period and largest rms height of a scan whose unit the scene states
HEIGHTS = (0.01, 20.0)  # format: rms heights, separations at which surfaces touch but not everywhere
LOADS = (1e-7, 10.0)  # format: of E* times the rms slope
MODULI = (1e2, 1e13)  # format: Pa, from the weakest gel to beyond diamond
LARGEST_WORK = 10.0  # format: J/m^2
LARGEST_ADHESION = 10.0  # format: of the elastic energy of complete contact
LAST_DIGITS = 4.0  # derived: of heights less a trend, in their last digit
MOST_NOISE = 0.5  # format: of the mean square slope
MOST_BOW = 0.8  # format: of the variance of heights; 3 % of self-affine lines of H = 0.8 without roll-off have more


def groups_of(scene: Scene) -> dict[str, float]:
    """Return the groups of a scene; without a rough profile or a scan, the groups that need one are absent.

    Examples
    --------
    >>> from bem.scene.scene import parse_scene
    >>> scene = parse_scene({
    ...     "solid": {"youngs_modulus": 0.75e6, "poisson_ratio": 0.5},
    ...     "profile": {"kind": "harmonics", "period": 0.01, "orders": [1], "amplitudes": [1e-5], "phases": [0.0]},
    ...     "loading": {"control": "mean_pressure", "targets": [1e3]},
    ... })
    >>> round(groups_of(scene)["pressure_scale"]), cautions_of(scene, groups_of(scene))
    (4443, ())
    """
    surface = scene.surface()
    modulus = scene.solid.plane_strain_modulus
    groups = {"rms_height": surface.rms_height, "rms_slope": surface.rms_slope}
    groups["pressure_scale"] = modulus * surface.rms_slope
    if scene.adhesion is not None and not surface.is_flat:
        energy = modulus * float(np.sum(surface.q0 * surface.orders * surface.amplitudes**2)) / 8
        groups["adhesion_over_elastic_energy"] = scene.adhesion.work_of_adhesion / energy
    if scene.scan is not None and isinstance(scene.profile.harmonics, int) and scene.scan.spectrum.floor:
        groups["noise_share_of_slope"] = scene.scan.noise_share(scene.profile.harmonics)
    return groups


def cautions_of(scene: Scene, groups: Mapping[str, float]) -> tuple[Caution, ...]:
    """Return the warnings about a scene with these groups, each with the probable cause."""
    warnings = (_lengths, _pressures, _slopes, _adhesion, _spikes, _noise, _constant, _form)
    return tuple(Caution(about, message) for warn in warnings for about, message in warn(scene, groups))


Warnings = Iterator[tuple[str, str]]


def _lengths(scene: Scene, groups: Mapping[str, float]) -> Warnings:
    """Yield warnings of lengths in mm instead of m: period, heights, and separations beside heights."""
    period, height, slope = float(scene.profile.period or np.nan), groups["rms_height"], groups["rms_slope"]
    if not PERIODS[0] <= period <= PERIODS[1] or (_doubted(scene, "unit_x") and period > SCANS[0]):
        yield "profile.period", f"the period is {period:.3g} m{_unit(scene, 'unit_x')}"
    if _doubted(scene, "unit_h") and height > SCANS[1]:
        yield "rms_height", f"the rms height is {height:.3g} m{_unit(scene, 'unit_h')}"
    if slope and not SLOPES[0] <= slope <= SLOPES[1]:
        expected = f"surfaces have {SLOPES[0]:g} to {SLOPES[1]:g}"
        yield "rms_slope", f"the rms slope is {slope:.3g}, {expected}{_unit(scene, 'unit_h', 'unit_x')}"
    if scene.loading.control == "mean_pressure" or height == 0:
        return
    least, largest = (extreme(scene.loading.targets) / height for extreme in (min, max))
    near = scene.loading.control == "separation" and 0 < largest < HEIGHTS[0]
    if least > HEIGHTS[1] or near:
        told = f"all targets are {'below' if near else 'above'} {HEIGHTS[not near]:g} rms heights"
        yield (
            "loading.targets",
            f"{told}; are the targets in another unit than m, or the heights{_unit(scene, 'unit_h')}",
        )


def _pressures(scene: Scene, groups: Mapping[str, float]) -> Warnings:
    """Yield warnings of pressures, moduli or works of adhesion in MPa or another unit instead of Pa and J/m^2."""
    modulus, scale = scene.solid.youngs_modulus, groups["pressure_scale"]
    if not MODULI[0] <= modulus <= MODULI[1]:
        yield "solid.youngs_modulus", f"{modulus:.3g} Pa is outside {MODULI[0]:g} to {MODULI[1]:g} Pa: in MPa or GPa?"
    if scene.adhesion is not None and scene.adhesion.work_of_adhesion > LARGEST_WORK:
        work = scene.adhesion.work_of_adhesion
        yield "adhesion.work_of_adhesion", f"{work:.3g} J/m^2 is above {LARGEST_WORK:g} J/m^2: in mJ/m^2?"
    if scene.loading.control != "mean_pressure" or scale == 0:
        return
    least, most = min(scene.loading.targets) / scale, max(map(abs, scene.loading.targets)) / scale
    cause = "are pressures or youngs_modulus in MPa, or heights in mm?"
    if 0 < most < LOADS[0]:
        yield ("loading.targets", f"all pressures are below {LOADS[0]:g} times E* h'_rms, hardly a load: {cause}")
    if least > LOADS[1]:
        yield "loading.targets", f"all pressures are above {LOADS[1]:g} times E* h'_rms, all touches: {cause}"


def _slopes(scene: Scene, groups: Mapping[str, float]) -> Warnings:
    """Yield warnings of slopes, and of layers thin beside the heights, beyond the limit of small strain."""
    slope = groups["rms_slope"]
    if SMALL_SLOPE < slope <= SLOPES[1]:
        yield "rms_slope", f"the rms slope {slope:.3g} is above {SMALL_SLOPE:g}, the limit of small strain"
    if scene.layer is not None and groups["rms_height"] > SQUEEZED * scene.layer.thickness:
        told = f"the rms height {groups['rms_height']:.3g} m is above {SQUEEZED:g} of the thickness"
        yield "layer.thickness", f"{told}: contact squeezes the layer beyond small strain"


def _adhesion(scene: Scene, groups: Mapping[str, float]) -> Warnings:
    """Yield a warning of adhesion that outweighs the elastic energy of complete contact."""
    share = groups.get("adhesion_over_elastic_energy", 0.0)
    if share > LARGEST_ADHESION:
        told = f"adhesion is {share:.3g} times the elastic energy of complete contact, surfaces close by themselves"
        cause = "is the unit of the heights or of the work of adhesion right?"
        yield "adhesion_over_elastic_energy", f"{told}: {cause}"


def _spikes(scene: Scene, groups: Mapping[str, float]) -> Warnings:
    """Yield a warning of spikes in a scan that are kept as heights."""
    if scene.scan is None:
        return
    step = scene.scan.step("outliers")
    if step["count"] and step["method"] == "keep":
        spikes = "a spike" if step["count"] == 1 else f"{step['count']} spikes"
        told = f"{spikes} of up to {step['largest']:.3g} m, the first at {step['first']}"
        yield "profile.outliers", f'{told}: measured so? outliers = "replace" takes the median of the neighbours'


def _noise(scene: Scene, groups: Mapping[str, float]) -> Warnings:
    """Yield a warning of slopes that are mostly noise, with the cut that leaves the noise out."""
    share = groups.get("noise_share_of_slope", 0.0)
    if scene.scan is None or share <= MOST_NOISE:
        return
    spectrum = scene.scan.spectrum
    told = f"{share:.0%} of the mean square slope is noise, of {spectrum.noise_rms:.2g} m rms in the scan"
    if spectrum.crossing is None:
        told = f"{told}; the profile nowhere rises above it: contact areas are those of the noise"
    else:
        reason = "there the profile falls below the noise floor"
        told = f"{told}: cutoff_short = {spectrum.crossing:.3g} ({spectrum.crossing * 1e6:.3g} um), {reason}"
    yield "profile.cutoff_short", told


def _constant(scene: Scene, groups: Mapping[str, float]) -> Warnings:
    """Yield a warning of a scan that is flat to the rounding of its heights."""
    if scene.scan is None:
        return
    highest = np.nanmax(np.abs(scene.scan.measured.h))
    if groups["rms_height"] <= LAST_DIGITS * np.spacing(highest):
        told = "the heights are constant, less their trend: a flat surface is solved; are they the heights?"
        yield "rms_height", told


def _form(scene: Scene, groups: Mapping[str, float]) -> Warnings:
    """Yield a warning of a bow that is most of the heights of a scan and that its detrending leaves."""
    bowed = scene.profile.detrend in ("none", "mean", "line")
    if scene.scan is None or not bowed or next(_constant(scene, groups), None) is not None:
        return
    step = scene.scan.step("detrend")
    if step["rms_bow"] ** 2 > MOST_BOW * step["rms_without_tilt"] ** 2:
        share = step["rms_bow"] / step["rms_without_tilt"]
        told = f"a bow of {step['bow'] * 1e6:.3g} um is {share:.0%} of the rms height"
        yield "profile.detrend", f'{told}: form? detrend = "quadratic" subtracts it'


def _doubted(scene: Scene, *keys: str) -> list[str]:
    """Return the units of a scan that the scene alone states; a unit that the file states is right."""
    read = {} if scene.scan is None else scene.scan.steps[0]
    return [key for key in keys if read.get(f"{key}_from") == "scene"]


def _unit(scene: Scene, *keys: str) -> str:
    """Return the question for a unit that ends a warning, empty where the file of a scan states the unit."""
    if scene.scan is None:
        return ": in mm instead of m?"
    asked = ", ".join(f'{key} = "{getattr(scene.profile, key)}"' for key in _doubted(scene, *keys))
    return f": {asked}?" if asked else ""
