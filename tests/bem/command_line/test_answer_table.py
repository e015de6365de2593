"""The answer of a run: a line for each quantity in a unit that a person reads, and the same in SI."""

import csv
import io
import math
from dataclasses import replace

import pytest
from rough_scene import ROUGH

import bem
from bem.command_line.answer_table import (
    FORCED,
    NO_FLAW,
    NO_NUMBER,
    answer,
    csv_text,
    digits,
    fixed,
    pull_off,
    pull_off_words,
    readable,
    table_text,
    units_of,
)
from bem.scene.result import LargestTension, TensionError
from bem.scene_commands import main

PERIOD, HEIGHT, MODULUS = 0.01, 1e-4, 1e6 / 0.75
FRACTION = 0.4
SHARE = math.sin(math.pi * FRACTION / 2) ** 2
PRESSURE = math.pi * MODULUS * HEIGHT / PERIOD * SHARE
WAVE = {
    "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
    "profile": {"kind": "harmonics", "period": PERIOD, "orders": [1], "amplitudes": [HEIGHT], "phases": [0.0]},
    "loading": {"control": "mean_pressure", "targets": [PRESSURE]},
}


@pytest.fixture(scope="module")
def wave():
    return bem.solve(WAVE)


@pytest.fixture(scope="module")
def rough():
    return bem.solve(ROUGH)


def test_the_answer_of_a_wave_is_that_of_westergaard(wave):
    found = {name: values[0] for name, values in wave.to_table("targets").items()}
    separation = HEIGHT * (1 - SHARE + SHARE * math.log(SHARE))
    known = {
        "mean_pressure": PRESSURE,
        "contact_fraction": FRACTION,
        "separation": separation,
        "contact_pressure": PRESSURE / FRACTION,
        "peak_pressure": 2 * PRESSURE / math.sqrt(SHARE),
        "n_patches": 1,
        **dict.fromkeys(("width_least", "width_median", "width_largest"), FRACTION * PERIOD),
        "open_share": 1 - FRACTION,
        "open_gap_mean": separation / (1 - FRACTION),
    }
    assert {name: found[name] for name in known} == pytest.approx(known, rel=2e-6)  # of the peak; others 1e-9


def shown(result, inputs=None):
    """The texts of each target by their headings."""
    lines = answer(result, inputs)
    return [{head: texts[k] for head, texts in lines} for k in range(len(result.targets))]


def open_in(result, **shares):
    """Uncertainties of the input of the only target: shares of its numbers."""
    (state,) = result.targets
    return {0: {name: share * getattr(state, name) for name, share in shares.items()}}


def test_a_person_can_read_it(wave):
    (cells,) = shown(wave)
    assert cells["mean pressure (held)"] == "14.4719 kPa"
    assert (cells["contact fraction"], cells["± contact fraction"]) == ("0.4000", "< 0.01 % numerical")
    assert cells["widths: least, median, largest"] == "4.00, 4.00, 4.00 mm"
    assert "contact pressure: peak" in table_text(wave)


def test_digits_are_those_that_the_uncertainty_of_the_input_leaves(wave):
    (cells,) = shown(wave, open_in(wave, contact_fraction=0.14, separation=0.004))
    assert (cells["contact fraction"], cells["± contact fraction"]) == ("0.40", "< 0.01 % numerical, 14 % input")
    assert cells["± separation"] == "< 0.01 % numerical, 0.40 % input"
    assert len(cells["separation"].split()[0].replace(".", "")) == digits(0.004) == 3


def test_a_quantity_has_one_unit_in_all_columns():
    result = bem.solve(WAVE | {"loading": {"control": "mean_pressure", "targets": [500.0, 2000.0]}})
    for head, texts in answer(result):
        units = {text.split()[-1] for text in texts if text.endswith(("m", "Pa"))}
        assert len(units) < 2, (head, texts)
    assert dict(answer(result))["mean pressure (held)"] == ["500 Pa", "2000 Pa"]


def test_an_uncertainty_belongs_to_one_quantity_and_is_never_printed_at_another(wave):
    (cells,) = shown(wave, open_in(wave, contact_fraction=0.14))
    known = ["± contact fraction", "± contact pressure: mean"]  # this is the pressure held over the fraction
    assert [head for head, text in cells.items() if "14 %" in text] == known
    assert {head for head in cells if head.startswith("±")} == {*known, "± separation"}


def test_the_open_share_is_as_uncertain_as_the_contact_fraction(wave):
    nearly = bem.solve(WAVE | {"loading": {"control": "mean_pressure", "targets": [0.9999 * PRESSURE / SHARE]}})
    (cells,) = shown(nearly, open_in(nearly, contact_fraction=0.005))
    assert cells["contact fraction"] == "0.994"
    assert cells["open share of the period"] == "0.0064"  # 0.5 % of the one are 80 % of the other


def test_a_zero_has_the_uncertainty_of_the_input_in_its_unit():
    closed = bem.solve(WAVE | {"loading": {"control": "mean_pressure", "targets": [1.1 * PRESSURE / SHARE]}})
    (cells,) = shown(closed, {0: {"mean_cubic_root": 3.4e-7}})
    assert cells["± gap for flow along the ridges, <g³>^(1/3)"] == "340 nm input"


def test_what_is_not_known_is_a_dash_and_an_empty_cell(rough):
    apart = list(shown(rough)[-1].values())  # the surfaces are apart
    assert (
        apart.count(NO_NUMBER) == 6
    )  # uncertainties of no pressure and no area, both contact pressures and a ±, widths
    table = list(csv.DictReader(io.StringIO(csv_text(rough))))
    assert len(table) == len(rough.targets)
    assert table[-1]["peak_pressure / Pa"] == ""
    assert [float(row["contact_fraction"]) for row in table] == [state.contact_fraction for state in rough.targets]


def test_the_pull_off_is_said_with_its_own_error_and_where_the_surfaces_came_apart(rough):
    event = next(event for event in rough.events if event.kind == "pull_off")
    highest = rough.states[0].penetration + rough.states[0].separation
    assert rough.came_apart() == pytest.approx(highest - event.penetration, rel=1e-12)
    tension = LargestTension(-280.0, 1e-6, 8.5e-5, "fold", TensionError(2.8))
    words = pull_off_words(replace(rough, largest_tension=tension))
    assert "the largest tension on the way out is 280.0 Pa (± 1.0 % numerical), at a separation" in words
    assert "the surfaces come apart at" in words
    words = pull_off_words(replace(rough, largest_tension=tension), {None: {"pull_off": 22.4}})
    assert "is 280 Pa (± 1.0 % numerical, 8.0 % input), at" in words


def test_a_path_that_ends_in_tension_does_not_give_an_earlier_turn_as_its_pull_off(rough):
    """States and turns of the rough scene, up to one whose tension is above all turns before it."""
    end = next(state for state in rough.states if state.branch == "unloading" and state.mean_pressure < 0)
    way = rough.states[: rough.states.index(end)]
    ended = replace(
        rough, states=(*way, replace(end, target=True, index=len(rough.targets))), events=(), largest_tension=None
    )
    words = f"not reached. The way out ends in tension, {readable(-end.mean_pressure, 'Pa', 4)} at"
    assert words in pull_off_words(ended) and pull_off_words(ended).endswith("beyond.")
    before = LargestTension(end.mean_pressure / 2, 1e-6, 8.5e-5, "turn", TensionError(1e-3))
    turned = pull_off_words(replace(ended, largest_tension=before))
    assert words in turned and f"before that it turns at {readable(-end.mean_pressure / 2, 'Pa', 4)}" in turned
    beyond = replace(before, mean_pressure=end.mean_pressure - 1e-4)
    assert "largest tension on the way out" in pull_off_words(replace(ended, largest_tension=beyond))
    broken_off = replace(ended, states=(*way, replace(end, target=False)))  # its tension depends on the increment
    assert "The way out ends in tension, and larger tensions" in pull_off_words(broken_off)


FORCED_OPEN = {
    "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
    "profile": {"kind": "self_affine", "period": 0.01, "hurst": 0.8, "rms_height": 1e-6, "harmonics": 6, "seed": 2},
    "adhesion": {"work_of_adhesion": 0.05},
}


@pytest.mark.parametrize("increment", [0.3, 1.0])
def test_complete_contact_that_the_control_forces_open_has_no_largest_tension(increment):
    """The tensions of stored states have no part in the words: they grow without bound with a smaller increment."""
    loading = {"control": "separation", "targets": [0.0, 1e-6], "initial": "complete_contact"}
    accuracy = {"max_increment": increment}
    part = bem.solve(FORCED_OPEN | {"loading": loading, "accuracy": accuracy})
    factor, unit = units_of(part)["separation"]
    apart = f"{fixed(1e-6 * factor, 4)} {unit}"
    assert pull_off_words(part) == f"{FORCED} The way out ends in tension, 6.788 kPa at a separation of {apart}."
    assert pull_off(part) is None


def test_the_load_turns_after_complete_contact_was_forced_open():
    loading = {"control": "separation", "targets": [0.0, 20e-6], "initial": "complete_contact"}
    whole = bem.solve(FORCED_OPEN | {"loading": loading, "accuracy": {"max_increment": 1.0}})
    assert pull_off_words(whole) == (
        f"{FORCED} After that the load turns at 1.173 kPa (± < 0.01 % numerical), at a separation of 14.05 µm; "
        "the surfaces come apart at 14.05 µm."
    )
    assert pull_off(whole) is None


def test_without_tension_there_is_no_pull_off(wave):
    assert (wave.largest_tension, pull_off_words(wave)) == (None, "")


def test_complete_contact_without_a_flaw_has_no_pull_off_and_says_what_a_flaw_decides():
    loading = {"control": "mean_pressure", "targets": [2 * PRESSURE / SHARE, -PRESSURE]}
    held = bem.solve(WAVE | {"loading": loading, "adhesion": {"work_of_adhesion": 0.5}})
    assert [state.status for state in held.targets] == ["complete_contact"] * 2
    assert held.largest_tension is None
    assert pull_off_words(held) == NO_FLAW
    assert [cells["contacts"] for cells in shown(held)] == ["complete", "complete"]


def test_run_prints_it(tmp_path, capsys):
    main(["run", str(scene_file(tmp_path)), "--out", str(tmp_path / "out"), "--quiet", "--table"])
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["mean", "pressure", "(held)", "14.4719", "kPa"]
    assert lines[-1].startswith("converged: ")


def scene_file(folder):
    path = folder / "scene.toml"
    tables = [
        f"[{name}]\n" + "\n".join(f"{key} = {value!r}" for key, value in table.items()) for name, table in WAVE.items()
    ]
    path.write_text("\n".join(tables) + "\n")
    return path
