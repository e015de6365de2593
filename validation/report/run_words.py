"""Resolved scene and outcome of a run in sentences, with units that suit the size of each quantity."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from bem.command_line.answer_table import common_unit, quantity, units_of
from bem.command_line.console import summary
from bem.scene.result import Result
from validation.report.pages import counted

CONTROLS = {
    "separation": ("the separation of the mean planes", "m"),
    "penetration": ("the penetration from first touch", "m"),
    "mean_pressure": ("the mean pressure", "Pa"),
    "total_displacement": ("the displacement of the plate from first touch", "m"),
}
LISTED = 8  # targets that are spelt out


def outcome(result: Result) -> str:
    """Return the first sentence of a page: status, certified states, events and the last state."""
    facts = summary(result, "", len(result.scene["loading"]["targets"]))
    how = {"converged": "Converged", "not_converged": "Not converged"}.get(result.status, result.status.capitalize())
    missed, beyond = len(result.states) - facts["states"], ""
    if result.answered and missed:
        how, beyond = "Pulled off", f", {counted(missed, 'target')} beyond what the contact carries"
    words = [
        f"{how}: {counted(facts['target_states'], 'state')} at targets ({facts['targets']} in the scene{beyond})",
        f"{facts['certified']} of {facts['states']} states certified by the independent quadrature",
        counted(facts["events"], "event"),
    ]
    if facts["states"]:
        load = facts["mean_pressure"]
        factor, unit = units_of(result)["mean_pressure"]
        pressure = "any mean pressure" if load is None else f"{load * factor:.6g} {unit}"
        words.append(f"last at {pressure} and contact fraction {facts['contact_fraction']:.4g}")
    why = "" if result.failure is None or result.answered else f" Why: {result.failure}."
    return "; ".join(words) + "." + why


def succeeded(result: Result) -> bool:
    """Return whether a run has its answer, with every target that was met certified."""
    return result.answered and all(state.certificate.ok for state in result.targets if state.found)


def scene_in_words(scene: Mapping[str, Any]) -> list[str]:
    """Return sentences on the bodies in contact and on the loading."""
    solid, layer, adhesion, loading = (scene[name] for name in ("solid", "layer", "adhesion", "loading"))
    modulus = solid["youngs_modulus"] / (1 - solid["poisson_ratio"] ** 2)
    body = "A half-space" if layer is None else f"A layer of {quantity(layer['thickness'], 'm')} on a rigid plate"
    words = [
        f"{body}, Young's modulus {quantity(solid['youngs_modulus'], 'Pa')}, Poisson's ratio "
        f"{solid['poisson_ratio']:g} (plane strain: E* = {quantity(modulus, 'Pa')}).",
        f"{_profile_in_words(scene['profile'])}.",
        "No adhesion."
        if adhesion is None
        else f"Work of adhesion {quantity(adhesion['work_of_adhesion'], 'J/m²')}, counted on the "
        + ("true length of the profile." if adhesion["slope_term"] else "projected length."),
    ]
    return [*words, *_loading_in_words(loading), f"Accuracy asked for: {scene['accuracy']['tolerance']:g}."]


def _profile_in_words(profile: Mapping[str, Any]) -> str:
    period = quantity(profile["period"], "m")
    if profile["kind"] == "self_affine":
        return (
            f"Self-affine rough profile: period {period}, Hurst exponent {profile['hurst']:g}, rms height "
            f"{quantity(profile['rms_height'], 'm')}, {profile['harmonics']} harmonics, seed {profile['seed']}"
        )
    if profile["kind"] == "samples":
        return (
            f"Measured profile {profile['file']}: period {period}, cut at {profile['harmonics']} harmonics, "
            f"detrended by {profile['detrend']}"
        )
    count = len(profile["orders"])
    return f"Profile of {counted(count, 'harmonic')} up to order {max(profile['orders'])}: period {period}"


def _loading_in_words(loading: Mapping[str, Any]) -> Iterator[str]:
    name, unit = CONTROLS[loading["control"]]
    initial = loading["initial"]
    start = "a stored state" if isinstance(initial, Mapping) else {"separated": "surfaces apart"}.get(initial, initial)
    targets: Sequence[float] = loading["targets"]
    factor, prefixed = common_unit(targets, unit)
    listed = [f"{target * factor:.6g} {prefixed}" for target in targets]
    if len(targets) > LISTED:
        listed = [*listed[: LISTED - 2], "…", listed[-1]]
    yield (
        f"Beginning with {start.replace('_', ' ')}, {name} is held at {', '.join(listed)} "
        f"({counted(len(targets), 'target')}, in this order)."
    )
    if loading["at_mean_pressures"]:
        yield "Kept on the way: " + ", ".join(quantity(value, "Pa") for value in loading["at_mean_pressures"]) + "."
    if loading.get("stop_at_mean_pressure") is not None:
        yield f"The path ends at {quantity(loading['stop_at_mean_pressure'], 'Pa')}."
    if loading.get("flaw") is not None:
        yield f"A flaw of {quantity(loading['flaw'], 'm')} lets complete contact open."
