"""The study of stability: endings and correctness counted apart, nothing lost, an interrupted study continues."""

import json
from dataclasses import replace

import example_outcomes as examples
import pytest
from carried import carried, failing, lines

from validation import __main__ as command_line
from validation.cases.suite import reduced_hard_cases as registered
from validation.cases.suite.reduced_hard_cases import QUICK
from validation.corpus.endings import ENDINGS, Trial, counts, row_of, tasks_of
from validation.harness import store
from validation.harness.execution import Ended
from validation.harness.verdict import verdict_of
from validation.studies import stability
from validation.studies.stability import judged, summary

FLAT = Trial("bem", "flat", "reduced", 120.0)
TASKS = (FLAT, Trial("fem", "apart", "reduced", 120.0), Trial("persson", "one_line", "reduced", 120.0))


@pytest.mark.parametrize("quick", [True, False], ids=["reduced", "full"])
def test_every_case_of_every_code_is_planned_once(quick):
    tasks = tasks_of(quick)
    assert len({(task.code, task.id) for task in tasks}) == len(tasks)
    assert {task.code for task in tasks} == {"bem", "fem", "persson"}
    assert {task.form for task in tasks} == {"reduced" if quick else "full"}


def test_both_forms_have_the_same_denominator():
    assert [(t.code, t.id) for t in tasks_of(True)] == [(t.code, t.id) for t in tasks_of(False)]


# Each ending by its name: (outcome or exception, ending, stands)


@pytest.mark.parametrize(
    ("changes", "ending", "stands"),
    [
        ({}, "converged", True),
        ({"correct": False, "findings": ("dense route differs",)}, "converged", False),
        ({"observed": ("converged", "unreachable")}, "not converged", False),
        ({"observed": (), "correct": False, "refused": "SceneError: no"}, "refused", False),
        ({"observed": ("converged", "converged"), "refused": "value: detaches"}, "refused as expected", True),
    ],
    ids=["converged", "converged and wrong", "not converged", "refused", "refused as expected"],
)
def test_endings_of_an_answer(changes, ending, stands):
    row = row_of(FLAT, examples.outcome(**changes))
    assert (row.ending, row.stands) == (ending, stands)


def test_refusal_with_another_reason_than_expected_is_a_failure():
    row = row_of(FLAT, examples.outcome(observed=("refused: control",), correct=False, refused="control: no"))
    assert (row.ending, row.stands, row.message) == ("refused", False, "control: no")


def test_crash_is_a_row_with_its_message():
    row = row_of(FLAT, ZeroDivisionError("the matrix is singular"), 2.0)
    assert (row.ending, row.correct, row.message) == ("crashed", False, "ZeroDivisionError: the matrix is singular")
    assert row.expected == ("converged", "complete_contact")


def test_no_answer_is_a_timeout():
    row = row_of(FLAT, None, 121.0)
    assert (row.ending, row.stands, row.message) == ("timed out", False, "no answer in 120 s")


def test_converged_and_correct_are_counted_apart():
    answers = [
        examples.outcome(),
        examples.outcome(correct=False),
        examples.outcome(observed=("converged", "separated")),
        ValueError("no"),
        None,
    ]
    found = counts(row_of(FLAT, answer) for answer in answers)
    assert sum(found[ending] for ending in ENDINGS) == len(answers)
    assert (found["converged"], found["correct"], found["converged, not correct"]) == (2, 2, 1)
    assert (found["not converged"], found["crashed"], found["timed out"]) == (1, 1, 1)


def test_rows_name_the_denominator_and_every_failure():
    rows = [row_of(FLAT, examples.outcome()), row_of(TASKS[1], ValueError("no"))]
    assert [row.quantity for row in judged(rows)] == [
        f"{code}: of 1 cases, {what}"
        for code in ("bem", "fem")
        for what in ("not ended as expected", "ended as expected and not correct")
    ]
    assert [row.message for row in judged(rows) if row.computed != [0.0]] == [
        "fem apart: crashed, NOT correct; ValueError: no"
    ]


def test_slow_reduced_cases_are_named():
    slow = replace(row_of(FLAT, examples.outcome()), seconds=11.0)
    assert ["bem", "above 10 s of CPU time: flat", "11.0 s"] in summary([slow]).rows
    assert not any("above" in str(line[1]) for line in summary([replace(slow, form="full")]).rows)


# The whole study


@pytest.fixture
def here(monkeypatch):
    """Everything in this process: starting another takes seconds."""
    begun = []

    def in_this_process(function, items, jobs, **options):
        for item in items:
            begun.append(item.id)
            try:
                yield Ended(item, function(item))
            except Exception as error:
                yield Ended(item, error)

    monkeypatch.setattr(store, "run_in_processes", in_this_process)
    return begun


def study(folder, measure=None, tasks=TASKS, jobs=1):
    return carried(stability, folder, tasks=tasks, measure=measure, jobs=jobs)


def stored(folder):
    return json.loads((folder / "stability.json").read_text())


def test_study_writes_its_table(here, tmp_path):
    report = study(tmp_path, examples.converge)
    assert failing(report) == []
    assert (stored(tmp_path)["planned"], stored(tmp_path)["reported"]) == (3, 3)
    assert [row[1] for row in report.cases[0].tables[1].rows] == ["flat", "apart", "one_line"]


def test_a_failure_fails_the_report(here, tmp_path):
    assert len(failing(study(tmp_path, examples.crash))) == 3  # one for each code
    assert stored(tmp_path)["counts"]["crashed"] == 3


def test_finished_cases_are_not_run_again(here, tmp_path):
    study(tmp_path, examples.converge, TASKS[:2])
    here.clear()
    assert failing(study(tmp_path, examples.converge)) == []
    assert here == ["one_line"]
    assert [row["id"] for row in stored(tmp_path)["rows"]] == ["flat", "apart", "one_line"]


def test_cases_that_crashed_are_run_again(here, tmp_path):
    study(tmp_path, examples.crash)
    here.clear()
    assert failing(study(tmp_path, examples.converge)) == []
    assert here == ["flat", "apart", "one_line"]


def test_rows_of_other_sources_are_not_kept(here, tmp_path, monkeypatch):
    study(tmp_path, examples.converge)
    here.clear()
    monkeypatch.setattr(store, "sources_digest", lambda: "other")
    study(tmp_path, examples.converge)
    assert here == ["flat", "apart", "one_line"]


def test_rows_of_the_other_form_do_not_count(here, tmp_path):
    study(tmp_path, examples.converge)
    full = [replace(task, form="full") for task in TASKS]
    assert failing(study(tmp_path, examples.converge, full)) == []
    assert {row["form"] for row in stored(tmp_path)["rows"]} == {"full"}


def test_a_lost_case_is_an_error_of_the_study(here, tmp_path, monkeypatch):
    monkeypatch.setattr(stability, "_rows", lambda *_: iter([row_of(FLAT, examples.outcome())]))
    assert failing(study(tmp_path, examples.converge)) == ["error, RuntimeError: planned 3 cases, 1 of them reported"]


def test_dead_process_is_a_crashed_row(forked, tmp_path):
    assert failing(study(tmp_path, examples.die, [FLAT]))
    assert stored(tmp_path)["rows"][0]["message"].startswith("WorkerDiedError")


def test_cases_side_by_side_end_as_alone_and_stand_in_order(forked, tmp_path):
    assert failing(study(tmp_path, examples.one_dies_one_crashes, jobs=2))
    assert [(row["id"], row["message"].split(":")[0]) for row in stored(tmp_path)["rows"]] == [
        ("flat", "WorkerDiedError"),
        ("apart", "ZeroDivisionError"),
        ("one_line", ""),
    ]


def test_time_limit_of_a_case_leaves_that_beside_it(forked, tmp_path):
    tasks = [replace(TASKS[0], limit=1.0), *TASKS[1:]]
    assert failing(study(tmp_path, examples.one_never_ends, tasks, jobs=2))
    assert [row["ending"] for row in stored(tmp_path)["rows"]] == ["timed out", "converged", "converged"]


@pytest.mark.parametrize(("words", "jobs"), [([], 1), (["--jobs", "2"], 2)], ids=["alone", "side by side"])
def test_command_line_takes_one_case_at_a_time_unless_asked(words, jobs, tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr(stability, "cases", lambda bench: seen.append(bench.jobs) or [])
    assert command_line.main(["study", "stability", *words, "--out", str(tmp_path)]) == 0
    assert seen == [jobs]


@pytest.mark.parametrize("task", TASKS, ids=[task.code for task in TASKS])
def test_cases_of_every_code_run_for_real(task, here, tmp_path):
    assert failing(study(tmp_path, None, [task])) == []


# Random scenes

RANDOM = stability.random_tasks(3, 7)


def random_study(folder, measure, jobs=1, tasks=RANDOM):
    return carried(stability, folder, tasks=tasks, measure=measure, jobs=jobs, file=stability.RANDOM_FILE)


def random_stored(folder):
    return json.loads((folder / stability.RANDOM_FILE).read_text())


def test_random_scenes_do_not_depend_on_their_number():
    assert [task.id for task in RANDOM] == ["seed_7_scene_0", "seed_7_scene_1", "seed_7_scene_2"]
    assert stability.random_tasks(5, 7)[:3] == RANDOM


def test_findings_are_counted_by_kind_and_scene(here, tmp_path):
    report = random_study(tmp_path, examples.found)
    assert len(failing(report)) == 1
    assert {"all with a finding of energy balance 1", "all with a finding of shift 1"} <= set(lines(report))
    stored = random_stored(tmp_path)
    assert stored["findings"] == {"energy balance": 1, "shift": 1}
    assert (stored["counts"]["correct"], stored["counts"]["converged, not correct"]) == (2, 1)


def test_scenes_that_do_not_stand_are_written(here, tmp_path):
    random_study(tmp_path, examples.found)
    assert [path.name for path in (tmp_path / stability.RANDOM_FOLDER).glob("*.toml")] == ["seed_7_scene_1.toml"]


def test_random_rows_leave_those_of_the_hard_cases(here, tmp_path):
    study(tmp_path, examples.converge)
    random_study(tmp_path, examples.converge)
    here.clear()
    study(tmp_path, examples.converge)
    assert here == []


def test_more_scenes_of_a_seed_go_on_where_fewer_ended(here, tmp_path):
    random_study(tmp_path, examples.converge)
    here.clear()
    random_study(tmp_path, examples.converge, tasks=stability.random_tasks(5, 7))
    assert here == ["seed_7_scene_3", "seed_7_scene_4"]


@pytest.mark.parametrize("jobs", [1, 2])
def test_scene_that_kills_the_process_it_shares_costs_no_other(forked, tmp_path, jobs):
    assert failing(random_study(tmp_path, examples.die_at_the_second, jobs))
    assert [row["ending"] for row in random_stored(tmp_path)["rows"]] == ["converged", "crashed", "converged"]


def test_scene_that_never_ends_costs_no_other(forked, tmp_path):
    tasks = [RANDOM[0], replace(RANDOM[1], limit=0.3), RANDOM[2]]
    assert failing(random_study(tmp_path, examples.sleep_at_the_second, tasks=tasks))
    assert [row["ending"] for row in random_stored(tmp_path)["rows"]] == ["converged", "timed out", "converged"]


def test_a_random_scene_runs_for_real(here, tmp_path):
    assert failing(random_study(tmp_path, None, tasks=stability.random_tasks(1, 0))) == []


def test_command_line_takes_random_scenes(tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr(stability, "cases", lambda bench, **named: seen.append((bench.jobs, named)) or [])
    words = ["study", "stability", "--random", "3", "--seed", "7", "--jobs", "2", "--out", str(tmp_path)]
    assert command_line.main(words) == 0
    assert seen == [(2, {"tasks": RANDOM, "file": stability.RANDOM_FILE})]


@pytest.mark.parametrize(
    "words", [["convergence", "--random", "3"], ["stability", "--seed", "3"]], ids=["another study", "seed alone"]
)
def test_random_scenes_where_there_are_none_are_bad_input(words, tmp_path, capsys):
    assert command_line.main(["study", *words, "--out", str(tmp_path)]) == 2
    assert words[1] in capsys.readouterr().err


# The same as cases of the registry


def verdicts(case):
    return [verdict_of(row) for row in case.compute().rows]


@pytest.mark.parametrize("case", registered.CASES, ids=[case.id for case in registered.CASES])
def test_registered_case_has_a_row_for_every_hard_case(case, monkeypatch):
    monkeypatch.setattr("validation.cases.suite.reduced_hard_cases.measured", examples.converge)
    found = verdicts(case)
    assert set(found) == {"agrees"}
    (find,) = case.compute.args  # what yields the rows: of one code, or of all
    (code,) = getattr(find, "args", (None,))
    asked = [
        task
        for task in tasks_of(True)
        if (code is None and task.id in QUICK[task.code]) or (task.code == code and task.id not in QUICK[code])
    ]
    assert len(found) == 1 + len(asked) > 5


def test_the_quick_case_names_hard_cases_and_lists_the_others(monkeypatch):
    monkeypatch.setattr("validation.cases.suite.reduced_hard_cases.measured", examples.converge)
    every = {(task.code, task.id) for task in tasks_of(True)}
    assert {(code, name) for code, names in QUICK.items() for name in names} <= every
    (table,) = registered.CASES[-1].compute().tables
    assert {(row[0], row[1]) for row in table.rows} == every
    assert len(table.rows) == len(every)


@pytest.mark.parametrize("wrong", ["crash", "wrong"])
def test_registered_case_fails_with_what_it_finds(wrong, monkeypatch):
    answers = {"crash": examples.crash, "wrong": lambda task: examples.outcome(correct=False, findings=("no",))}
    monkeypatch.setattr("validation.cases.suite.reduced_hard_cases.measured", answers[wrong])
    assert set(verdicts(registered.CASES[2])) == {"deviates"}
