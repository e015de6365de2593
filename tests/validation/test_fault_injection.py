"""Faults as changes of text: they fit the sources, reach all that uses the copy, are counted, and leave no trace."""

import signal
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from validation.harness.case import registry
from validation.studies.faults.fault_injection import SIZE, Exposure, FaultError, Studied, examine, faults_in

FAULTS = faults_in()


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.id)
def test_fault_fits_the_sources(fault):
    """The message names fault and file: there the code has moved, and `before` is to be moved with it."""
    text = (Studied(()).root / fault.file).read_text("utf-8")
    assert Studied((fault,)).functions()
    for size in (1.0, 1e-3):
        wrong = fault.changed(text, size)
        compile(wrong, fault.file, "exec")
        assert wrong != text
    assert (SIZE in fault.after) == bool(fault.size)


def test_faults_of_all_packages_have_different_names_and_cases_of_the_quick_level():
    assert {fault.case for fault in FAULTS} <= {case.id for case in registry() if case.level == "quick"}
    assert len({fault.id for fault in FAULTS}) == len(FAULTS) >= 65
    assert {Path(fault.file).parts[0] for fault in FAULTS} == {"bem", "fem_reference", "persson", "validation"}


@pytest.fixture
def studied(monkeypatch):
    """The example, importable here."""
    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    for name in [name for name in sys.modules if name.split(".")[0] in ("example_faults", "example_cases")]:
        monkeypatch.delitem(sys.modules, name)
    import example_faults

    return example_faults.STUDIED


def examined(studied, folder, fault, *cases):
    chosen = next((known for known in studied.faults if known.id == fault), None)
    return examine(studied, folder, Exposure(chosen, 0.5, cases))


def test_every_use_of_a_function_has_the_fault(studied, tmp_path):
    cases = (("uses-function", 10.0), ("uses-function-loosely", 10.0))  # by its name, and by a table of functions
    answer = examined(studied, tmp_path, "off", *cases)
    assert [record.rows[0].computed for record in answer.records] == [[1.5], [1.5]]
    assert answer.calls == {"uses-function": {"off": 1}, "uses-function-loosely": {"off": 1}}


def test_control_counts_for_all_faults_and_changes_nothing(studied, tmp_path):
    answer = examined(studied, tmp_path, None, ("uses-function", 10.0), ("uses-method", 10.0))
    assert [record.rows[0].computed for record in answer.records] == [[1.0], [4.0]]
    assert answer.calls == {"uses-function": {"off": 1, "crash": 1, "blank": 1}, "uses-method": {"die": 1}}


def test_nothing_stays_of_a_fault(studied, tmp_path):
    def seen():
        handlers = [signal.getsignal(number) for number in (signal.SIGPROF, signal.SIGALRM)]
        return sys.modules["example_faults"], list(sys.path), sys.gettrace(), handlers

    source = studied.root / studied.faults[0].file
    before, text = seen(), source.read_text()
    examined(studied, tmp_path, "off", ("uses-function", 10.0))
    assert seen() == before
    assert source.read_text() == text
    assert list(tmp_path.iterdir()) == []
    assert [signal.getitimer(timer)[0] for timer in (signal.ITIMER_PROF, signal.ITIMER_REAL)] == [0.0, 0.0]


@pytest.mark.parametrize(
    ("change", "reported"),
    [
        ({"before": "return y\n"}, r"example_faults/sources.py holds 'return y\\n' 0 times, exactly once is needed"),
        ({"before": "return"}, r"holds 'return' \d+ times"),
        ({"before": "FUNCTIONS"}, "is in no function"),
        ({"file": "example_faults/absent.py"}, "absent.py: No such file"),
    ],
    ids=["gone", "several", "not in a function", "no file"],
)
def test_fault_that_does_not_fit_is_refused(studied, change, reported):
    unfit = replace(studied.faults[0], **change)
    with pytest.raises(FaultError, match=f"^off: .*{reported}"):
        replace(studied, faults=(unfit,)).functions()


@pytest.mark.parametrize("line", ["", "surprise = 1", "before = 3"], ids=["missing", "unknown", "no text"])
def test_malformed_table_is_refused(tmp_path, line):
    (tmp_path / "some.toml").write_text(f'["f".off]\nwhat = "w"\nafter = "a"\n{line}\n')
    with pytest.raises(FaultError, match=r"^some.toml: off: "):
        faults_in((tmp_path / "some.toml",))


@pytest.mark.parametrize(
    ("case", "message"),
    [("spins", "no answer in 0.2 s of the processor"), ("waits", "no answer in 2 s")],
)
def test_case_without_end_is_cut_off(studied, tmp_path, case, message):
    answer = examined(replace(studied, modules=("example_faults.endless",)), tmp_path, "off", (case, 0.2))
    assert answer.records[0].message == f"TooSlowError: {message}"


def test_seconds_by_the_clock_alone_cut_no_case_off(studied, tmp_path):
    """On a busy machine a case waits for its turn; here it sleeps through several times its limit."""
    (record,) = examined(
        replace(studied, modules=("example_faults.endless",)), tmp_path, "off", ("sleeps", 0.5)
    ).records
    assert record.status == "run"
    assert record.seconds < 0.5
