"""Patches: they reach every module that holds the name, every kind of target, and count that they were called."""

import signal
import sys
import types
from pathlib import Path

import pytest

from validation.studies.faults import fault_injection
from validation.studies.faults.fault_injection import FaultError, Task, examine, inject


@pytest.fixture
def example(monkeypatch):
    """A fresh copy of the example module, seen as a package of the project."""
    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    for name in ("example_faults", "example_cases"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    import example_faults

    yield example_faults
    sys.modules.pop("example_faults", None)


def off(original, size):
    return lambda *given: original(*given) + size


@pytest.mark.parametrize(
    ("target", "use", "value"),
    [
        ("right", lambda module: module.right(1.0), 1.0),
        ("table", lambda module: module.table(2), 4.0),
        ("right", lambda module: module.FUNCTIONS["right"](1.0), 1.0),
        ("Thing.size", lambda module: module.Thing().size, 3.0),
        ("Thing.kept", lambda module: module.Thing().kept, 3.0),
        ("Thing.made", lambda module: module.Thing.made(5.0), 5.0),
        ("Thing.method", lambda module: module.Thing().method(), 3.0),
    ],
    ids=["function", "cached function", "table of functions", "property", "cached property", "classmethod", "method"],
)
def test_fault_takes_effect_and_is_counted(example, target, use, value):
    assert use(example) == value
    counter = inject(f"example_faults:{target}", off, 0.5)
    assert counter.calls == 0
    assert use(example) == value + 0.5
    assert counter.calls == 1


def test_module_that_imported_the_name_has_the_fault_too(example, monkeypatch):
    monkeypatch.setattr(fault_injection, "PACKAGES", ("importer",))
    importer = types.ModuleType("importer")
    importer.renamed = example.right
    monkeypatch.setitem(sys.modules, "importer", importer)
    inject("example_faults:right", off, 0.5)
    assert importer.renamed(1.0) == 1.5


@pytest.mark.parametrize(
    "target", ["example_faults:absent", "example_faults:Thing.value", "nowhere:f", "example_faults"]
)
def test_target_that_cannot_be_replaced_is_refused(example, target):
    with pytest.raises(FaultError, match=target.split(":")[0]):
        inject(target, off, 0.5)


def test_crash_under_a_fault_is_a_record_with_its_message(example):
    answer = examine(Task("example_faults", "crash", 1.0, (("uses-function", 10.0),), ("example_faults",)))
    assert [(record.status, record.message) for record in answer.records] == [
        ("error", "ZeroDivisionError: a fault divides by zero")
    ]
    assert answer.calls == {"uses-function": {"example_faults:right": 1}}


def test_control_counts_all_targets_and_changes_nothing(example):
    answer = examine(Task("example_faults", None, 0.0, (("uses-function", 10.0),), ("example_faults",)))
    assert answer.records[0].rows[0].computed == [1.0]
    assert answer.calls["uses-function"] == {
        "example_faults:right": 1,
        "example_faults:table": 0,
        "example_faults:never": 0,
    }


def spin():
    while True:
        pass


@pytest.mark.parametrize(
    ("compute", "message"),
    [("spin", "no answer in 0.2 s of the processor"), ("wait", "no answer in 2 s")],
    ids=["works on", "waits"],
)
def test_case_without_end_is_cut_off(example, monkeypatch, compute, message):
    endless = {"spin": spin, "wait": example.example_cases.wait}[compute]
    monkeypatch.setattr(example, "CASES", (example.case("endless", endless),))
    answer = examine(Task("example_faults", "off", 1.0, (("endless", 0.2),), ("example_faults",)))
    assert answer.records[0].message == f"TooSlowError: {message}"


def test_seconds_by_the_clock_alone_cut_no_case_off(example, monkeypatch):
    """On a busy machine a case waits for its turn; here it sleeps through several times its limit."""
    monkeypatch.setattr(example, "CASES", (example.case("sleeps", example.example_cases.dawdle),))
    answer = examine(Task("example_faults", "off", 1.0, (("sleeps", 0.5),), ("example_faults",)))
    assert answer.records[0].status == "run"
    assert answer.records[0].seconds < 0.5


def test_timers_and_handlers_are_as_before(example):
    timers = ((signal.SIGPROF, signal.ITIMER_PROF), (signal.SIGALRM, signal.ITIMER_REAL))
    before = [signal.getsignal(number) for number, _ in timers]
    examine(Task("example_faults", "off", 1.0, (("uses-function", 10.0),), ("example_faults",)))
    assert [signal.getsignal(number) for number, _ in timers] == before
    assert [signal.getitimer(timer)[0] for _, timer in timers] == [0.0, 0.0]
