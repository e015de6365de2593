"""Is this scene what was meant?  The groups that decide what comes out, and what is out of the ordinary.

A profile in the wrong unit is solved as accurately as one in the right one; only its dimensionless groups tell.  With
the harmonics h_m of the profile, q_m = 2 pi m / period and E* = E / (1 - nu^2), `MEANINGS` says what
each of them is.  The energy of complete contact is after Persson, Tosatti, J. Chem. Phys. 115 (2001) 5597; of one wave
the group is 2 pi alpha^2 with the alpha of Johnson, Int. J. Solids Struct. 32 (1995) 423.  The Tabor parameter is
mu = (R w^2 / (E*^2 z0^3))^(1/3), R = 1 / rms curvature and z0 = 3e-10 m, the range of the forces: strict JKR holds
above 5 (Johnson, Greenwood, J. Colloid Interface Sci. 192 (1997) 326, for spheres; of line contacts see their
J. Phys. D 41 (2008) 155315).

The constants below are the limits beyond which a caution is given.  Nothing here changes what is computed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from bem.geometry.scaling import ATOMIC
from bem.scans.scan_keys import METRES
from bem.scene.result import Caution, State
from bem.scene.scene import Scene

MEANINGS = {
    "rms_height": "sqrt(sum h_m^2 / 2) of the profile as it is cut",
    "rms_height_over_period": "one axis read in another unit shows here",
    "rms_slope": "sqrt(sum q_m^2 h_m^2 / 2) of the profile as it is cut; the model is one of small slopes",
    "pressure_scale": "E* times the rms slope: mean pressures of this size press a half-space flat",
    "thickness_over_period": "waves longer than the layer is thick feel the plate behind it",
    "slope_share_kept": "rms slope of the waves that the cut keeps over that of all waves of the samples",
    "noise_share_of_slope": "share of the mean square slope that noise makes, of samples with a noise floor",
    "end_jump_over_step": "step from the last sample to the first of the next period over the rms step",
    "adhesion_over_elastic_energy": "w over the elastic energy of complete contact; above 1 contact closes by itself",
    "tabor_parameter": "(R w^2 / (E*^2 z0^3))^(1/3), R = 1 / rms curvature, z0 = 3e-10 m: strict JKR holds above 5",
    "least_target": "over the rms height; of mean pressures, over pressure_scale",
    "largest_target": "over the rms height; of mean pressures, over pressure_scale",
    "least_mean_pressure": "of the states found, over pressure_scale",
    "largest_mean_pressure": "of the states found, over pressure_scale",
}
SMALL_SLOPE = 0.5  # format: rms slope beyond which heights are not small to first order
LARGEST_SLOPE = 1.0  # format: which surfaces hardly have
LEAST_SLOPE = 1e-7  # format: smoother than a silicon wafer
PERIODS = (1e-9, 1.0)  # format: m
SCANS = (0.1, 1e-4)  # format: m: longest period, largest rms height of a profilometer's line in m, not in mm
MODULI = (1e2, 1e13)  # format: Pa: weakest gel to beyond diamond
LARGEST_WORK = 10.0  # format: J/m^2
LEAST_SHARE = 0.9  # format: of the rms slope that the cut keeps
MOST_NOISE = 0.5  # format: of the mean square slope
LARGEST_JUMP = 3.0  # format: rms steps
TILTED = 2.0  # format: rms heights without the tilt; a wave of one period has 1.6
HEIGHTS = (0.01, 20.0)  # format: rms heights: separations at which surfaces touch, but not all over
PRESSURES = (1e-7, 10.0)  # format: of E* h'_rms
LARGEST_ADHESION = 10.0  # format: of the elastic energy of complete contact
LEAST_TABOR = 5.0  # format: below which the forces reach beyond the edge of the contact
MUCH_MISSING = 0.1  # format: of the samples
LARGEST_TABLE = 1e9  # format: bytes
BYTES = 16 * 14 * 8 * 2 * 1.5  # derived: of the tables of a profile for each harmonic, at most twice this


def groups_of(scene: Scene) -> dict[str, float]:
    """The groups of a scene; those that need a rough profile only if it is one.

    Examples
    --------
    >>> from bem.scene.scene import parse_scene
    >>> scene = parse_scene({
    ...     "solid": {"youngs_modulus": 0.75e6, "poisson_ratio": 0.5},
    ...     "profile": {"kind": "harmonics", "period": 0.01, "orders": [1], "amplitudes": [1e-5], "phases": [0.0]},
    ...     "loading": {"control": "mean_pressure", "targets": [1e3]},
    ... })
    >>> groups = groups_of(scene)
    >>> round(groups["pressure_scale"]), round(groups["largest_target"], 3), cautions_of(scene, groups)
    (4443, 0.225, ())
    """
    surface, period = scene.surface(), float(scene.profile.period or np.nan)
    modulus = scene.solid.youngs_modulus / (1 - scene.solid.poisson_ratio**2)
    height, slope = surface.rms_height, surface.rms_slope
    groups = {"rms_height": height, "rms_height_over_period": height / period, "rms_slope": slope}
    groups["pressure_scale"] = modulus * slope
    if scene.layer is not None:
        groups["thickness_over_period"] = scene.layer.thickness / period
    if scene.scan is not None and isinstance(scene.profile.harmonics, int):
        groups["slope_share_kept"] = scene.scan.slope_share(scene.profile.harmonics)
        groups["end_jump_over_step"] = scene.scan.end_jump
        if scene.scan.spectrum.floor:
            groups["noise_share_of_slope"] = scene.scan.noise_share(scene.profile.harmonics)
    if slope == 0:
        return groups
    if scene.adhesion is not None:
        energy = modulus * float(np.sum(surface.q0 * surface.orders * surface.amplitudes**2)) / 8
        work = scene.adhesion.work_of_adhesion
        groups["adhesion_over_elastic_energy"] = work / energy
        groups["tabor_parameter"] = float(np.cbrt((work / modulus) ** 2 / surface.rms_curvature)) / ATOMIC
    unit = groups["pressure_scale"] if scene.loading.control == "mean_pressure" else height
    return groups | _ends("target", [target / unit for target in scene.loading.targets])


def pressure_groups(groups: Mapping[str, float], states: Sequence[State]) -> dict[str, float]:
    """Mean pressures of the states found, over E* h'_rms."""
    scale = groups["pressure_scale"]
    found = [state.mean_pressure / scale for state in states if np.isfinite(state.mean_pressure)] if scale > 0 else []
    return _ends("mean_pressure", found)


def _ends(name: str, values: Sequence[float]) -> dict[str, float]:
    return {f"least_{name}": min(values), f"largest_{name}": max(values)} if values else {}


def cautions_of(scene: Scene, groups: Mapping[str, float]) -> tuple[Caution, ...]:
    """What is out of the ordinary in a scene with these groups, with the probable cause."""
    judged = (
        _profile_cautions,
        _path_cautions,
        _material_cautions,
        _range_cautions,
        _sample_cautions,
        _noise_cautions,
    )
    return tuple(Caution(*said) for judge in judged for said in judge(scene, groups))


Said = Iterator[tuple[str, str]]


def _profile_cautions(scene: Scene, groups: Mapping[str, float]) -> Said:
    """Slopes and periods of another order of magnitude than those of surfaces."""
    slope, period = groups["rms_slope"], float(scene.profile.period or np.nan)
    scanned = scene.scan is not None
    if slope > SMALL_SLOPE or 0 < slope < LEAST_SLOPE:
        said = f"is below {LEAST_SLOPE:g}"
        if slope > SMALL_SLOPE:
            said = f"is above {SMALL_SLOPE:g}, beyond the limit of small slopes (bem/README.md, section 10)"
        cause = ""
        if not SMALL_SLOPE < slope <= LARGEST_SLOPE:
            cause = _slope_in_other_units(scene, slope) if scanned else "unit of the heights or of the period?"
        yield "rms_slope", _asked(f"the rms slope {slope:.3g} {said}", cause)
    if not PERIODS[0] <= period <= PERIODS[1]:
        side = f"above {PERIODS[1]:g} m" if period > PERIODS[1] else f"below {PERIODS[0]:g} m"
        cause = _units_doubted(scene, "unit_x") if scanned else "unit?"
        yield "profile.period", _asked(f"the period {period:.3g} m is {side}", cause)
    elif period > SCANS[0] and (cause := _units_doubted(scene, "unit_x")):
        yield "profile.period", _asked(f"the period {period:.3g} m is above {SCANS[0]:g} m", cause)
    if groups["rms_height"] > SCANS[1] and (cause := _units_doubted(scene, "unit_h")):
        yield "rms_height", _asked(f"the rms height {groups['rms_height']:.3g} m is above {SCANS[1]:g} m", cause)
    size = float(max(scene.profile.orders)) if scene.profile.orders else float(scene.profile.harmonics or 1)
    if size * BYTES > LARGEST_TABLE:
        yield "profile.harmonics", f"tables of the profile take up to {2 * size * BYTES / 1e9:.2g} GB of memory"


def _asked(told: str, cause: str) -> str:
    """What is out of the ordinary, and its probable cause if there is one."""
    return f"{told}: {cause}" if cause else told


def _doubtful(scene: Scene, *keys: str) -> list[str]:
    """Those units of a scan that the scene alone gives: what the file states is not doubted."""
    read = {} if scene.scan is None else scene.scan.steps[0]
    return [key for key in keys if read.get(f"{key}_from") == "scene"]


def _units_doubted(scene: Scene, *keys: str) -> str:
    """A question for the units of a scan that the file does not state; empty if it states them, or without a scan."""
    asked = ", ".join(f'{key} = "{getattr(scene.profile, key)}"' for key in _doubtful(scene, *keys))
    return f"{asked}?" if asked else ""


def _slope_in_other_units(scene: Scene, slope: float) -> str:
    """Which single unit of a scan, read as another, gives an ordinary slope; empty if the file states both."""
    tried = []
    for key in _doubtful(scene, "unit_h", "unit_x"):
        own = str(getattr(scene.profile, key))
        for unit, metres in METRES.items():
            if unit not in ("m", "mm", "um", "nm", own):
                continue
            ratio = metres / METRES[own]
            other = slope * (ratio if key == "unit_h" else 1 / ratio)
            if 1e-3 <= other <= LARGEST_SLOPE:
                tried.append(f'{key} = "{own}"? read as "{unit}" it is {other:.2g}')
    return "; or ".join(tried) or _units_doubted(scene, "unit_x", "unit_h")


def _path_cautions(scene: Scene, groups: Mapping[str, float]) -> Said:
    """Targets at which nothing touches, or everything does."""
    if "least_target" not in groups:
        return
    least, largest, control = groups["least_target"], groups["largest_target"], scene.loading.control
    units = "unit of the targets or of the heights?"
    if scene.scan is not None:
        heights = _units_doubted(scene, "unit_h")
        units = f"unit of the targets, or {heights}" if heights else "unit of the targets?"
    if control == "separation" and least > HEIGHTS[1]:
        yield "loading.targets", f"all separations are above {HEIGHTS[1]:g} rms heights, nothing touches: {units}"
    if control == "separation" and 0 < largest < HEIGHTS[0]:
        yield "loading.targets", f"all separations are below {HEIGHTS[0]:g} rms heights, nearly all touches: {units}"
    if control == "penetration" and least > HEIGHTS[1]:
        yield "loading.targets", f"all penetrations are above {HEIGHTS[1]:g} rms heights: {units}"
    if control == "mean_pressure" and least > PRESSURES[1]:
        told = f"all pressures are above {PRESSURES[1]:g} E* h'_rms, everything touches"
        yield "loading.targets", f"{told}: unit of youngs_modulus, or {units}"
    if control == "mean_pressure" and max(abs(least), abs(largest)) < PRESSURES[0] and (least or largest):
        yield (
            "loading.targets",
            f"all pressures are below {PRESSURES[0]:g} E* h'_rms, hardly a load: unit of youngs_modulus, or {units}",
        )


def _material_cautions(scene: Scene, groups: Mapping[str, float]) -> Said:
    """Moduli and works of adhesion of no known material."""
    modulus = scene.solid.youngs_modulus
    if not MODULI[0] <= modulus <= MODULI[1]:
        yield "solid.youngs_modulus", f"{modulus:.3g} Pa is outside {MODULI[0]:g} to {MODULI[1]:g} Pa: unit?"
    if scene.adhesion is not None and scene.adhesion.work_of_adhesion > LARGEST_WORK:
        work = scene.adhesion.work_of_adhesion
        yield "adhesion.work_of_adhesion", f"{work:.3g} J/m^2 is above {LARGEST_WORK:g} J/m^2: unit?"
    share = groups.get("adhesion_over_elastic_energy", 0.0)
    if share > LARGEST_ADHESION:
        yield (
            "adhesion_over_elastic_energy",
            f"adhesion is {share:.3g} times the elastic energy of complete contact: surfaces close by themselves; "
            "unit of the heights, or of the work of adhesion?",
        )


def _range_cautions(scene: Scene, groups: Mapping[str, float]) -> Said:
    """Forces that reach beyond the edge of the contact, which strict JKR leaves out."""
    tabor = groups.get("tabor_parameter", np.inf)
    if tabor < LEAST_TABOR:
        told = f"the Tabor parameter {tabor:.3g} is below {LEAST_TABOR:g}: adhesive forces reach beyond the edge of the"
        yield "tabor_parameter", f"{told} contact, and strict JKR overrates pull-off: bem/README.md, section 10"


def _sample_cautions(scene: Scene, groups: Mapping[str, float]) -> Said:
    """What the cut, the end of the period, spikes and gaps do to a scan."""
    scan = scene.scan
    if scan is None:
        return
    steps = {step["step"]: step for step in scan.steps}
    heights = scan.measured[1]
    if np.nanmin(heights) == np.nanmax(heights):
        yield "profile.file", "all heights are equal: another column?"
    elif heights[0] == heights[-1] and steps["periodic"]["method"] == "as_is":
        told = "the last height equals the first: does the file hold the first point of the next period?"
        yield "profile.file", f"{told} If so, remove the last line"
    share, jump = groups["slope_share_kept"], groups["end_jump_over_step"]
    if share < LEAST_SHARE and scene.profile.harmonics == scan.max_harmonics:
        told = f"{share:.2g} of the rms slope is kept by all {scan.max_harmonics} harmonics"
        cause = "heights alternate from sample to sample: two scans in turn, or noise?"
        yield "profile.file", f"{told}; the rest is in the highest order, of two samples a wave: {cause}"
    elif share < LEAST_SHARE and not _noise_beyond(scene):
        cut = (
            f"profile.harmonics = {scene.profile.harmonics} of {scan.max_harmonics} keeps {share:.0%} of the rms slope"
        )
        yield "profile.harmonics", f'{cut}: contact areas depend on it; more of them, or harmonics = "all"'
    if jump > LARGEST_JUMP:
        told = f"the step at the end of the period is {jump:.3g} times the rms step"
        yield "profile.periodic", f'{told}: periodic = "mirror" or periodic = "window" joins the ends'
    leaning, level = steps["detrend"]["rms_height"][1], steps["detrend"]["rms_without_tilt"]
    if leaning > TILTED * level:
        told = (
            f"a tilt of {steps['detrend']['tilt']:.3g} makes up most of the rms height {leaning:.3g} m; "
            f"without it, that is {level:.3g} m"
        )
        yield "profile.detrend", f'{told}: detrend = "line" takes it away'
    if "printed_to" in steps["spacing"]:
        told = f"positions are printed to {steps['spacing']['printed_to']:.3g} m; within that they are at equal steps"
        yield "profile.unequal_spacing", f"{told} of {scan.spacing:.6g} m: could a line be missing?"
    if "unlike_positions" in steps["read"]:
        yield "profile.file", f"{steps['read']['unlike_positions']} does not agree with the positions: unit_x?"
    dropped = steps["dropouts"]
    if dropped["count"] and dropped["method"] == "keep":
        told = f"{dropped['count']} samples may be dropouts, {dropped['values']} in {dropped['places']}"
        yield "profile.dropouts", f'{told}: dropouts = "missing" takes them for missing heights'
    if "apart" in dropped:
        few = dropped["apart"]
        told = f"{few['count']} samples, {few['places']}, are {few['distance']:.3g} m apart from all others"
        yield "profile.dropouts", f"{told}, which span {few['span']:.3g} m: where nothing was seen, write NaN there"
    spikes, gaps, count = steps["outliers"], steps["missing"], steps["read"]["samples"]
    if spikes["count"] and spikes["method"] == "keep":
        told = f"{spikes['count']} of {count} samples are spikes, the first at {spikes['first']}"
        yield "profile.outliers", f'{told}: outliers = "replace" sets them to the running median'
    if gaps["count"] > MUCH_MISSING * count:
        yield "profile.missing", f"{gaps['count']} of {count} heights were missing"


def _noise_beyond(scene: Scene) -> bool:
    """Whether waves shorter than those kept are below the noise of a scan."""
    scan, harmonics = scene.scan, scene.profile.harmonics
    if scan is None or not isinstance(harmonics, int) or scan.spectrum.crossing is None:
        return False
    return scan.period / harmonics <= scan.spectrum.crossing


def _noise_cautions(scene: Scene, groups: Mapping[str, float]) -> Said:
    """Slopes that are mostly noise, and where they would not be."""
    share = groups.get("noise_share_of_slope", 0.0)
    if scene.scan is None or share <= MOST_NOISE:
        return
    spectrum = scene.scan.spectrum
    told = f"{share:.0%} of the mean square slope is noise, of {spectrum.noise_rms:.2g} m rms in the scan"
    if spectrum.law is None or spectrum.crossing is None:
        yield (
            "profile.cutoff_short",
            f"{told}; the profile nowhere rises above it: contact areas are those of the noise",
        )
        return
    um = f"{spectrum.crossing * 1e6:.3g} um"
    reason = f"there the profile, as f^{-spectrum.law.exponent:.2g}, falls below the noise floor"
    yield "profile.cutoff_short", f"{told}: cutoff_short = {spectrum.crossing:.3g} ({um}), {reason}"
