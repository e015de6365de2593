"""The page of a run: what it says, and how it looks in a real browser on a desk and on a phone."""

import html
import json
import re
from dataclasses import replace

import pytest
from browser import BROWSER
from devtools import found_at, tab
from drawn_once import drawn_once
from rough_scene import ROUGH

import bem
from bem.command_line.answer_table import answer, units_of
from bem.scene.digest import digest
from bem.scene.result import LargestTension, TensionError
from bem.scene.result_file import write_result
from validation.command_line.front_door import main
from validation.report import run_page
from validation.report.path_states import path_of
from validation.report.run_figures import figures_of
from validation.report.run_page import render_run
from validation.report.run_words import outcome, scene_in_words

LOOK = """
const box = document.getElementById("verdict").getBoundingClientRect();
found.width = innerWidth;
found.wide = document.documentElement.scrollWidth > innerWidth;
const answered = document.querySelector("#answer .wide");
found.hidden = answered.scrollWidth - answered.clientWidth;
found.verdict = [box.left, box.top, innerWidth - box.right, innerHeight - box.bottom];
const named = (svg, attribute) => document.getElementById(svg.getAttribute(attribute) ?? "")?.textContent ?? "";
const drawings = [...document.querySelectorAll("figure svg")].filter((svg) => !svg.closest("#paper"));
const label = (svg) => svg.getAttribute("aria-label") ?? named(svg, "aria-labelledby");
found.figures = drawings.map((svg) => [svg.getAttribute("role"), label(svg),
                                       named(svg, "aria-describedby"), svg.getBoundingClientRect().height > 50]);
const targets = [...document.querySelectorAll("a[href]")].map((link) => link.getAttribute("href"));
found.lost = targets.filter((target) => !target.startsWith("#") || !document.getElementById(target.slice(1)));
const ids = [...document.querySelectorAll("[id]")].map((element) => element.id);
found.repeated = ids.filter((id, place) => ids.indexOf(id) !== place);
found.resources = performance.getEntriesByType("resource").map((entry) => entry.name);
const table = document.querySelector("#states table");
table.querySelectorAll("thead th button")[1].click();
const first = document.querySelector("#answer tbody tr").getBoundingClientRect();
found.answer = [first.top, innerHeight - first.bottom];
found.order = [...table.tBodies[0].rows].map((row) => Number(row.cells[1].dataset.sort));
"""


@pytest.fixture(autouse=True)
def equal_figures_are_drawn_once(monkeypatch):
    monkeypatch.setattr(run_page, "svg_of", drawn_once)


@pytest.fixture(scope="module")
def result():
    return bem.solve(ROUGH)


@pytest.fixture(scope="module")
def page(result):
    return render_run(result)


@pytest.mark.skipif(BROWSER is None, reason="no Chromium here (Debian: apt-get install chromium)")
@pytest.mark.parametrize("width", [1280, 390])
def test_in_a_browser(page, result, tmp_path, width):
    found, console = found_at(tmp_path, page, LOOK, width)
    assert (found["width"], console) == (width, [])
    assert not found["wide"]
    assert width < 1000 or found["hidden"] == 0  # all columns of the answer
    assert min(found["verdict"]) >= 0  # on the first screen, all of it
    assert min(found["answer"]) >= 0  # and the first row of the answer
    assert len(found["figures"]) == 6  # five that move, and the area
    for role, name, description, drawn in found["figures"]:
        assert (role, drawn) == ("img", True)
        assert len(name) > 10
        assert " against " in (description or name) or name.startswith(("Surfaces.", "Pressure"))
    assert (found["lost"], found["repeated"], found["resources"]) == ([], [], [])
    assert found["order"] == sorted(found["order"])
    assert len(found["order"]) == len(result.targets)


SHOWN = """(() => {
  const numbers = [...document.querySelectorAll("#now dd")].map((cell) => cell.textContent.trim());
  const boxes = [...document.querySelectorAll("#marks text")].map((name) => name.getBoundingClientRect());
  const beside = (a, b) => a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
  const apart = boxes.every((a, k) => boxes.slice(k + 1).every((b) => beside(a, b)));
  const place = document.querySelector("#load circle[r='5.5']").getAttribute("cx");
  return [numbers, document.getElementById("event").textContent, place, apart,
          document.documentElement.scrollWidth > innerWidth];
})()"""


@pytest.mark.skipif(BROWSER is None, reason="no Chromium here (Debian: apt-get install chromium)")
@pytest.mark.parametrize("width", [1280, 390])
def test_keys_move_the_slider_and_the_numbers_are_those_of_the_states(page, result, tmp_path, width):
    path = tmp_path / "page.html"
    path.write_text(page, "utf-8")

    def press(opened, key, shift=False):
        for kind in ("keyDown", "keyUp"):
            opened.ask("Input.dispatchKeyEvent", type=kind, key=key, code=key, modifiers=8 if shift else 0)
        return opened.find(SHOWN)

    points, units = path_of(result), units_of(result)
    with tab(path) as opened:
        opened.show(width, 844)
        answered = next(k for k, point in enumerate(points) if point.state.target and point.state.contact_fraction)
        assert opened.find(SHOWN)[0][0].startswith(f"{answered + 1} of ")
        back = [press(opened, "ArrowLeft") for _ in range(answered)]
        seen = [back[-1], *(press(opened, "ArrowRight") for _ in points[1:])]
        assert press(opened, "ArrowLeft")[0] == seen[-2][0]
        assert press(opened, "ArrowRight", shift=True)[1].startswith("pull-off")
        assert opened.console == []
    for k, (point, (numbers, event, _, apart, wide)) in enumerate(zip(points, seen, strict=True)):
        state = point.state
        assert numbers[0] == f"{k + 1} of {len(points)}, {state.branch}"
        shown = [float(text.split()[0].replace("\N{MINUS SIGN}", "-")) for text in numbers[1:]]
        opened_share = 1 - state.contact_fraction
        factors = [units[name][0] for name in ("separation", "mean_pressure", "open_gap_mean")]
        known = [factors[0] * state.separation, factors[1] * state.mean_pressure, state.contact_fraction]
        assert shown == pytest.approx(
            [*known, factors[2] * state.separation / opened_share, state.n_patches], rel=1e-3, abs=1e-12
        )
        assert apart
        assert not wide
        assert (point.jump == "before") == (event == "just before the jump")
    events = [event for _, event, *_ in seen]
    for kind in ("first touch", "a new contact", "a contact vanishes", "pull-off"):
        assert sum(kind in event for event in events) == 1
    assert len({place for *_, place, _, _ in seen}) > 10


def test_everything_is_on_the_page(page, result):
    assert outcome(result).startswith("Converged: 4 states at targets (4 in the scene); ")
    for text in (outcome(result), *scene_in_words(result.scene)):
        assert text.replace("'", "&#39;") in page
    assert "rubber on &lt;glass&gt;" in page
    assert "<glass>" not in page
    assert page.count("energy released") == 1
    factor, _ = units_of(result)["mean_pressure"]
    for event in result.events:
        assert f"{factor * event.mean_pressure:.9g} ± {factor * event.error_estimate.mean_pressure:.1g}" in page
    assert all(effect.reason in page.replace("&#34;", '"') for effect in result.effects)
    assert result.provenance["scene_sha256"] in page


def test_curves_have_error_bars_of_the_estimated_errors(result):
    area = next(figure for figure in figures_of(result, []) if figure.id == "area")
    bars = next(series for series in area.solution.series if series.style == "bars")
    spread = [(high - low) / 2 for low, high in zip(bars.y, bars.upper, strict=True)]
    targets = [state for state in result.targets if state.mean_pressure == state.mean_pressure]
    assert spread[0] == pytest.approx(targets[0].error_estimate.mean_pressure * 1e-3, rel=1e-2)  # kPa


def test_without_a_study_the_banner_does_not_praise_an_answer_of_unknown_uncertainty(page):
    assert 'class="verdict neutral">Converged' in page
    assert "✓" not in page.partition("</header>")[0]


def test_the_answer_of_the_page_is_that_of_the_terminal_a_line_for_each_quantity(page, result):
    table = page.partition('answer">')[2].partition("</table>")[0]
    lines = [re.findall(r"<t[hd][^>]*>([^<]*)</t", line) for line in table.split("<tr>")[1:]]
    assert [(html.unescape(head), [*map(html.unescape, texts)]) for head, *texts in lines] == answer(result)


def test_what_a_later_version_adds_is_shown(result):
    class Caution:
        about, message = "profile.period", "above 1 m: is the unit mm?"

    richer = replace(result)
    added = {"groups": {"rms_slope": 0.125, "pressure_scale": 1.25e6}, "warnings": (Caution,)}
    added["profile_preparation"] = (
        {"step": "detrend", "method": "line", "removed": [3e-6, 4e-6], "rms_height": [2e-6, 1e-6]},
    )
    vars(richer).update(added)
    page = render_run(richer)
    assert "above 1 m: is the unit mm?" in page
    assert 'rms slope</th><td class="num">0.125</td>' in page
    assert "3 µm at the first sample and 4 µm at the last; rms height 2 µm before, 1 µm after.</li>" in page
    assert "1.25 MPa" in page


def test_a_run_that_failed_says_so_first_and_by_its_exit_code(result, tmp_path, capsys):
    failed = replace(result, status="not_converged", failure="target 2 of 3, 4e-05: no equilibrium was found")
    write_result(failed, tmp_path)
    assert main(["report", str(tmp_path)]) == 1
    assert "no equilibrium was found" in capsys.readouterr().err
    page = (tmp_path / "report.html").read_text()
    assert 'class="verdict deviates">✗ Not converged' in page


def test_report_of_a_run_is_written_beside_it(result, tmp_path, capsys):
    write_result(result, tmp_path)
    assert main(["report", str(tmp_path)]) == 0
    assert capsys.readouterr().out == f"{outcome(result)} report: {tmp_path / 'report.html'}\n"
    assert (tmp_path / "report.html").read_text() == render_run(bem.read_result(tmp_path))


@pytest.mark.parametrize("content", [None, "{}"], ids=["nothing", "corrupt"])
def test_a_folder_without_a_result_is_told(tmp_path, capsys, content):
    if content is not None:
        (tmp_path / "result.json").write_text(content)
    assert main(["report", str(tmp_path)]) == 2
    assert "error: " in capsys.readouterr().err
    assert not (tmp_path / "report.html").exists()


def test_a_run_without_states_has_a_page(result):
    empty = replace(result, states=(), events=(), fields={}, status="interrupted")
    assert "0 of 0" in render_run(empty)


def study_beside(result, folder, shares, **changes):
    """A folder with a result, and with the study of its scene, in which the input leaves these shares open."""
    write_result(result, folder)
    met = [state for state in result.targets if state.found]
    rows = [
        {
            "target": state.index,
            "quantity": name.replace("_", " "),
            "value": getattr(state, name),
            "input": share * getattr(state, name),
        }
        for state, share in zip(met, shares, strict=bool(shares))
        for name in ("contact_fraction", "mean_pressure")
    ]
    study = {"scene_sha256": result.provenance["scene_sha256"], "answers": rows} | changes
    study = {key: value for key, value in study.items() if value is not None}
    (folder / "study.json").write_text(json.dumps(study | {"checksum": digest(study)}))


def test_the_answer_comes_first_with_the_uncertainty_of_the_input_of_a_study_beside_it(result, tmp_path, capsys):
    study_beside(result, tmp_path, [0.02, 0.34, 0.0, 0.0])
    assert main(["report", str(tmp_path)]) == 0
    page = (tmp_path / "report.html").read_text()
    assert page.index('id="answer"') < page.index('id="figures"') < page.index('id="scene"') < page.index('id="states"')
    assert 'class="verdict doubtful">! Converged' in page
    assert re.search("The input leaves open up to 34 % of the (contact fraction|mean pressure) at ", page)
    certain = {0: {"contact_fraction": 0.02 * result.targets[0].contact_fraction}}
    assert 'class="verdict agrees">✓ Converged' in render_run(result, certain)
    assert "numerical, 34 % input</td>" in page
    table = (tmp_path / "answer.csv").read_text().splitlines()
    assert len(table) == 1 + len(result.targets)


def test_the_pull_off_has_the_uncertainty_of_the_input_of_its_study(result, tmp_path):
    tension = -0.5 * max(state.mean_pressure for state in result.states)
    pulled = replace(
        result, largest_tension=LargestTension(tension, 1e-6, 8.5e-5, "fold", TensionError(-1e-3 * tension))
    )
    row = {"target": None, "quantity": "pull-off", "value": -tension, "input": -0.1 * tension}
    study_beside(pulled, tmp_path, [], answers=[row])
    assert run_page.inputs_of(pulled, tmp_path) == {None: {"pull_off": -0.1 * tension}}
    assert "numerical, 10 % input" in render_run(pulled, run_page.inputs_of(pulled, tmp_path))
    study_beside(pulled, tmp_path, [], answers=[row | {"value": -1.1 * tension}])
    assert run_page.inputs_of(pulled, tmp_path) == {}


@pytest.mark.parametrize("changes", [{"answers": None}, {"scene_sha256": "0"}], ids=["not done", "of another scene"])
def test_a_study_that_does_not_belong_to_the_run_is_not_used(changes, result, tmp_path):
    study_beside(result, tmp_path, [0.34] * 4, **changes)
    assert run_page.inputs_of(result, tmp_path) == {}


def test_a_study_of_other_numbers_is_not_used(result, tmp_path):
    study_beside(
        replace(result, states=tuple(replace(s, contact_fraction=0.1) for s in result.states)), tmp_path, [0.3] * 4
    )
    assert run_page.inputs_of(result, tmp_path) == {}


@pytest.mark.parametrize(
    ("answers", "key"),
    [
        ([{}], "answers.0.quantity"),
        ([{"quantity": "mean pressure", "target": 99, "value": 1.0}], "answers.0.target is 99"),
        ([{"quantity": "mean pressure", "target": 0, "value": 1.0, "input": -1.0}], "answers.0.input"),
    ],
)
def test_a_file_that_is_no_study_is_told_by_its_key(answers, key, result, tmp_path, capsys):
    write_result(result, tmp_path)
    study = {"scene_sha256": result.provenance["scene_sha256"], "answers": answers}
    (tmp_path / "study.json").write_text(json.dumps(study | {"checksum": digest(study)}))
    assert main(["report", str(tmp_path)]) == 2
    assert f"study.json: not the study of a scene: {key}" in capsys.readouterr().err


def test_many_events_are_folded(result, page):
    assert "<details>" not in page
    assert "<details><summary>" in render_run(replace(result, events=result.events * 6))
