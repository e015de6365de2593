"""Replication of the paper: verdicts of statements, members, fits on known data, a short form to the end."""

import csv
import io
import json

import numpy as np
import pytest

from persson import double_gaussian
from validation.harness.figure_data import Figure, Panel, Series
from validation.paper import pressures, profiles, replicate, spectra
from validation.paper.curves import banded, joined
from validation.paper.ensemble import estimate, jackknife, read_ensemble, read_member, solve_members
from validation.paper.load_curves import curvature, departures
from validation.paper.members import LOADS, PAPER, Member, Size, members_of
from validation.paper.pressures import decay_power, density
from validation.paper.statements import Measured, Statement, headline, judge, statements
from validation.references import paper_problem
from validation.references.paper_problem import MODULUS
from validation.report.figures import table_of

TINY = Size(seeds=2, harmonics=16, fewer_harmonics=12, hurst_seeds=2)


def verdict(ours, uncertainty, shortfall="", **claim):
    statement = Statement("exponent", "section 5", "exponent", **{"allowed": 0.2, "printed": 1.0} | claim)
    return statement.judged(Measured(ours, uncertainty / 2), shortfall)["verdict"]


# the paper's curvature, as it was measured on its ensemble
BENT = {"printed": 0.0, "allowed": 0.015, "excluded": -0.034, "claim": "vanishes"}


@pytest.mark.parametrize(
    ("judged", "expected"),
    [
        (verdict(1.05, 0.1), "reproduced"),
        (verdict(1.05, 0.2), "not established"),
        (verdict(1.3, 0.05), "not reproduced"),
        (verdict(1.3, 0.2), "not established"),
        (verdict(np.nan, 0.0), "not run"),
        (verdict(1.0, 0.0, "2 realisations"), "not run"),
        (verdict(1.3, 0.05, claim="differs"), "reproduced"),
        (verdict(1.05, 0.1, claim="differs"), "not reproduced"),
        (verdict(1.3, 0.2, claim="differs"), "not established"),
        (verdict(1.05, 0.1, claim="vanishes"), "reproduced"),
        (verdict(1.15, 0.04, claim="vanishes"), "not established"),
        (verdict(-0.0148, 2 * 0.0063, **BENT), "not established"),
        (verdict(-0.006, 0.004, **BENT), "not established"),  # nearly straight, but resolved as bent
        (verdict(1.16, 0.0, excluded=1.3), "not reproduced"),  # nearer to what is excluded
    ],
)
def test_verdict_of_a_statement(judged, expected):
    assert judged == expected


def test_every_statement_has_its_own_measure_and_can_be_told_from_what_it_excludes():
    table = statements()
    assert len({statement.measure for statement in table}) == len(table) == 39
    fixed = [one for one in table if one.excluded is not None and np.isfinite(one.printed)]
    assert all(one.allowed <= abs(one.excluded - one.printed) / 2 * (1 + 1e-12) for one in fixed)


def test_a_statement_without_a_number_is_not_run():
    rows = judge({"area over theory": Measured(1.9, 0.01)}, "")
    assert headline(rows) == "1 of 39 statements run: 1 reproduced"
    assert headline(judge({"area over theory": Measured(1.9, 0.01)}, "short form")) == "0 of 39 statements run"
    others = judge({"area over theory": Measured(1.9, 0.01)}, "", "the ensemble")
    assert [row["note"] for row in others[:2]] == ["", "the ensemble"]
    assert [row["verdict"] for row in others[:2]] == ["reproduced", "not run"]


def test_ensemble_is_the_papers():
    groups = members_of(PAPER)
    planned = groups["loading"]
    assert [one.scene["profile"]["seed"] for one in planned] == list(range(11))
    assert {one.scene["profile"]["harmonics"] for one in planned} == {1000}
    assert {one.scene["loading"]["stop_at_mean_pressure"] for one in planned} == {0.025 * 1e6 / 0.75}
    (shapes,) = groups["shapes"]
    assert shapes.scene["profile"]["seed"] == 2  # seeds 0 and 1 have crests of 84.4 and 85.1 um
    assert shapes.scene["output"]["shapes"] == [86e-6, 48e-6, 38e-6, 9.6e-6]
    names = [one.name for group in groups.values() for one in group]
    assert len(set(names)) == len(names) == 11 + 1 + 1 + 12 + 18


def test_exponent_of_noisy_lines_is_within_its_error():
    order = np.arange(1.0, 201.0)
    noise = np.random.default_rng(3).exponential(size=(11, 200))
    fitted = spectra.of_realisations(order**-2.7 * noise, [(3, 30), (10, 100)])
    assert abs(fitted.value + 2.7) < 3 * fitted.error
    assert 0.01 < fitted.error < 0.2


def verdicts(measured, load=""):
    """Return number and verdict of every statement that has a number here, by measure."""
    rows = judge({f"{name}{load}": number for name, number in measured.items()}, "")
    names = [statement.measure.removesuffix(load) for statement in statements()]
    return {name: row for name, row in zip(names, rows, strict=True) if row["ours"] is not None}


ORDERS = np.arange(1.0, 1001.0)


@pytest.mark.parametrize(
    ("factor", "scatter", "verdict"),
    [(1.5, 0.01, "reproduced"), (1.0, 0.01, "not reproduced"), (1.4, 0.6, "not established")],
)
def test_a_shift_of_a_spectrum_is_judged_whatever_its_exponent(factor, scatter, verdict):
    power = np.outer([1 - scatter, 1.0, 1 + scatter], factor * ORDERS**-2.7)
    shift = verdicts(spectra.of_spectrum(power, ORDERS**-2.7), " 0.02")["shift of C_u"]
    assert shift["verdict"] == verdict
    assert shift["ours"] == pytest.approx(factor, rel=1e-9)


def test_exponents_of_the_middle_and_of_the_high_end_are_judged():
    bent = np.where(ORDERS < 150, ORDERS**-2.7, 150**-0.3 * ORDERS**-2.4)
    power = np.array([bent, 1.1 * bent, 0.9 * bent])
    rows = verdicts(spectra.of_spectrum(power, bent), " 0.02")
    assert rows["exponent of C_u"]["ours"] == pytest.approx(-2.7, abs=1e-9)
    high = [rows[name] for name in ("exponent of C_sigma at high q", "rise of the exponent of C_sigma")]
    assert [row["ours"] for row in high] == pytest.approx([-0.4, 0.3], abs=1e-9)
    assert {row["verdict"] for name, row in rows.items() if name != "shift of C_u"} == {"reproduced"}
    straight = verdicts(spectra.of_spectrum(np.array([ORDERS**-2.7] * 3), bent), " 0.02")
    assert straight["rise of the exponent of C_sigma"]["verdict"] == "not reproduced"
    assert straight["exponent of C_sigma at high q"]["verdict"] == "not reproduced"


def test_windows_of_a_curved_spectrum_are_told():
    curved = np.exp(-0.1 * np.log(np.arange(1.0, 200.0)) ** 2)
    steepest = spectra.exponents(curved, [(10, 100)])[0]
    assert f"windows: {steepest:.3f} to" in spectra.of_realisations(np.array([curved] * 2), [(3, 30), (10, 100)]).note


def test_scatter_that_grows_with_the_order_steepens_single_fits_and_not_the_fit_of_the_mean():
    order = np.arange(1.0, 201.0)
    spread = 0.9 * order / 200
    power = order**-2.0 * np.array([1 + spread, 1 - spread])
    windows = [(10.0, 100.0), (20.0, 200.0)]
    assert spectra.of_mean(power, windows).value == pytest.approx(-2.0, abs=1e-9)
    assert spectra.of_realisations(power, windows).value < -2.1  # -2.169


def test_jackknife_of_a_mean_is_its_standard_error():
    values = np.random.default_rng(0).normal(size=(9, 1))
    mean, error = estimate(values)
    assert jackknife(lambda one: float(one[0]), values) == pytest.approx((float(mean[0]), float(error[0])), rel=1e-12)


def test_bands_keep_the_mean_of_every_order():
    order, value = banded(np.arange(1.0, 101.0), 5)
    assert len(order) == 5
    assert value[-1] == pytest.approx(np.mean(np.arange(41.0, 101.0)))  # 101^(4/5) = 40.1


def test_moments_of_heights_under_random_phases():
    amplitudes, rng = np.array([1.0, 0.7, 0.5, 0.4]), np.random.default_rng(1)
    x, orders = 2 * np.pi * np.arange(64) / 64, np.arange(1, 5)
    phases = rng.uniform(0, 2 * np.pi, (4000, 4, 1))
    heights = np.sum(amplitudes[:, np.newaxis] * np.cos(np.outer(orders, x) + phases), axis=1)
    heights /= np.sqrt(np.sum(amplitudes**2) / 2)
    third, fourth = profiles.expected_moments(amplitudes)
    for moments, expected in ((np.mean(heights**3, axis=1) ** 2, third**2), (np.mean(heights**4, axis=1), fourth)):
        mean, error = estimate(moments)
        assert abs(mean - expected) < 3 * error < 0.1 * expected


@pytest.mark.parametrize("power", [1.0, 2.0, 3.0])
def test_power_of_the_decay_is_recovered(power):
    sigma = np.linspace(0.1, 0.5, 30)
    assert decay_power(sigma, np.exp(2 - 40 * sigma**power)) == pytest.approx(power, abs=1e-4)


def test_straight_lines_and_their_departures():
    assert departures(lambda load: 7 * load) == pytest.approx([0.0, 0.0], abs=1e-12)
    assert curvature([1.0, 2.0, 3.0], [1.0, 2.0, 3.0]) == pytest.approx(0.0, abs=1e-12)


def test_joined_curves_have_gaps_between_them():
    assert joined([([1.0, 2.0], [3.0, 4.0]), ([5.0], [6.0])]) == ([1.0, 2.0, None, 5.0], [3.0, 4.0, None, 6.0])


def of_double_gaussian(end, factor=1.0, added=0.0):
    """Return the fit's rows for three realisations of one double Gaussian that ends at -end; the theory's at -0.05."""
    sigma = pressures.CENTRES
    shape = factor * double_gaussian(sigma, 0.02, end, 0.018 / (2 * 0.02**2)) + added
    return verdicts(pressures.of_fit(0.02, np.outer([0.9, 1.0, 1.1], shape), 0.05), " 0.02")


@pytest.mark.parametrize(
    ("end", "verdict"),
    [(0.075, "reproduced"), (0.062, "reproduced"), (0.059, "not reproduced"), (0.05, "not reproduced")],
)
def test_the_factor_is_judged_by_the_nearer_number(end, verdict):
    row = of_double_gaussian(end)["sigma_a of the fit over theory"]
    assert row["ours"] == pytest.approx(end / 0.05, abs=1e-5)
    assert row["verdict"] == verdict


def test_a_factor_that_depends_on_the_window_is_not_established():
    tail = 0.05 * np.exp(10 * pressures.CENTRES) * (pressures.CENTRES < 0.05)
    row = of_double_gaussian(0.075, added=tail)["sigma_a of the fit over theory"]
    assert row["verdict"] == "not established"


def test_a_double_gaussian_approximates_itself_and_not_twice_itself():
    assert of_double_gaussian(0.075)["residual of the fit"]["verdict"] == "reproduced"
    assert of_double_gaussian(0.075, 2.0)["residual of the fit"]["verdict"] == "not reproduced"


@pytest.mark.parametrize(("power", "verdict"), [(0.5, "reproduced"), (0.1, "not reproduced")])
def test_faint_adhesion_gains_little_area(power, verdict):
    gains = np.array([0.0, 1e-6**power, 0.03**power])[:, np.newaxis] * [3.0, 3.1, 3.2]
    areas = (1 + gains)[..., np.newaxis] * [0.01, 0.02]
    row = verdicts({"gain by faint adhesion": profiles.of_faint_adhesion(areas)})["gain by faint adhesion"]
    assert row["ours"] == pytest.approx(3.1 * 1e-6**power, rel=1e-9)
    assert row["verdict"] == verdict


FIGURE = Figure(
    id="one",
    caption="Two series.",
    solution=Panel(
        xlabel="x",
        ylabel="y",
        series=[
            Series(label="line", x=[1.0, None, 2.0], y=[3.0, None, 4.0], style="thin"),
            Series(label="band", x=[1.0], y=[2.0], upper=[5.0], style="band"),
        ],
    ),
)


def test_csv_of_a_figure_has_every_point():
    lines = list(csv.reader(io.StringIO(table_of(FIGURE))))
    assert lines[1:] == [["line", "1.0", "3.0", ""], ["line", "2.0", "4.0", ""], ["band", "1.0", "2.0", "5.0"]]


def test_members_are_stored_used_again_and_solved_again_where_damaged(tmp_path):
    wave = paper_problem.lines([1], [1e-4], [0.0])
    targets = {"control": "mean_pressure", "targets": [1e4]}
    planned = [Member(name, paper_problem.scene(name, wave, targets)) for name in ("a", "b")]
    refused = Member("c", paper_problem.scene("c", wave, {"control": "mean_pressure", "targets": []}))
    notes = []
    assert solve_members(planned, tmp_path, 1, notes.append) == {"a": "converged", "b": "converged"}
    (tmp_path / "b" / "result.json").write_text("{}")
    notes.clear()
    assert solve_members(planned, tmp_path, 1, notes.append) == {"b": "converged"}
    assert notes == ["1 of 2 members are stored already", "[1/1] b: converged"]
    (failure,) = solve_members([refused], tmp_path, 1, notes.append).values()
    assert failure.startswith("SceneError: ") and "loading.targets" in failure
    assert all(read_member(member, tmp_path).status == "converged" for member in planned)


@pytest.fixture(scope="module")
def replicated(tmp_path_factory):
    """Folder of a tiny replication, its report, and the exit code."""
    folder = tmp_path_factory.mktemp("replicate")
    code = replicate.replicate(folder, quick=True, jobs=2, size=TINY)
    return folder, json.loads((folder / "report.json").read_text()), code


@pytest.mark.slow
def test_short_form_runs_to_the_end_and_says_that_little_was_run(replicated):
    folder, report, code = replicated
    assert code == 0
    assert len(report["statements"]) == 39
    assert report["headline"] == "short form: 0 of 39 statements run"
    page = (folder / "report.html").read_text()
    assert "Passed" not in page and report["headline"] in page
    drawings = [folder / name for name in report["figures"]]
    assert len(drawings) == 8
    assert all(path.stat().st_size for path in drawings)


@pytest.mark.slow
def test_stored_realisations_are_used_again_and_damaged_ones_are_not(replicated):
    folder, _, _ = replicated
    assert read_member(members_of(TINY)["loading"][0], folder / "members").status == "converged"
    assert read_member(members_of(PAPER)["loading"][0], folder / "members") is None  # another scene of this name
    ensemble = read_ensemble(PAPER, folder / "members", {"loading-00": "ZeroDivisionError: singular"})
    assert ensemble.missing["loading-00"] == "ZeroDivisionError: singular"
    assert ensemble.shortfall == f"only 0 of 11 realisations reached {LOADS[-1]:g} E*"
    content, figures = replicate.report(ensemble)
    assert content["headline"] == "0 of 39 statements run" and not figures


@pytest.mark.slow
def test_numbers_of_a_realisation(replicated):
    folder, report, _ = replicated
    member = read_ensemble(TINY, folder / "members", {}).loading[0]
    bounds = np.linspace(-50.0, 5.0, 40001)
    share = float(np.sum(density(member, 0.02, bounds) * np.diff(bounds)))
    assert share == pytest.approx(member.result.targets[member.target_at(0.02)].contact_fraction, rel=1e-3)
    states = sorted(member.result.states, key=lambda state: state.mean_pressure)
    middle = (states[-2].mean_pressure + states[-1].mean_pressure) / 2 / MODULUS  # jumped over: on the line between
    assert member.target_at(middle) is None
    area = member.value_at(middle, lambda state: state.contact_fraction)
    assert area == pytest.approx((states[-2].contact_fraction + states[-1].contact_fraction) / 2, rel=1e-12)
    assert member.final_load == pytest.approx(0.025)
    assert [row[0] for row in report["conventions"]] == [
        "normalisation of a continuous spectrum",
        "normalisation of a continuous spectrum",
        "area factor in U_ad",
        "a load that an instability jumps over",
    ]
