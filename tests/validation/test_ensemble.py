"""Ensembles: stored one by one, computed once, the same on any number of workers, safe from kills and full disks."""

import errno
import json
import multiprocessing
import os
import re
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import example_members
import pytest
from example_members import members
from in_this_process import here
from stored_states import lasting

import bem
from bem.scene.result_file import FIELDS_FILE, RESULT_FILE, CorruptResultError
from bem.scene.scene import SceneError
from validation.harness.ensemble import Member, member_seed, read_member, run_ensemble
from validation.harness.executors import local_processes

SCRIPT = Path(example_members.__file__)


def run(planned, folder, opener=here, jobs=1):
    notes = []
    return run_ensemble(planned, folder, jobs, notes.append, opener), [note.text for note in notes]


def written(folder):
    return {path.parent.name: path.stat().st_mtime_ns for path in folder.glob(f"*/{RESULT_FILE}")}


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """Three members computed in this process; not to be changed."""
    folder = tmp_path_factory.mktemp("ensemble")
    outcome, _ = run(members(3), folder)
    return folder, outcome


def test_every_member_is_stored(stored):
    folder, outcome = stored
    assert outcome.computed == ("seed-00", "seed-01", "seed-02")
    assert [read_member(member, folder).status for member in members(3)] == ["converged"] * 3


def test_results_carry_the_sources_that_made_them(stored):
    folder, _ = stored
    facts = read_member(members(1)[0], folder).provenance
    assert {"commit", "sources_sha256", "scene_sha256"} <= set(facts)


def test_realisation_is_the_same_on_two_processes(stored, tmp_path):
    folder, _ = stored
    run(members(3), tmp_path, local_processes, jobs=2)
    for member in members(3):
        assert lasting(read_member(member, folder)) == lasting(read_member(member, tmp_path))


def test_second_run_computes_only_what_is_missing(tmp_path):
    run(members(2), tmp_path)
    before = written(tmp_path)
    outcome, _ = run(members(3), tmp_path)
    assert (outcome.found, outcome.computed) == (("seed-00", "seed-01"), ("seed-02",))
    assert before.items() <= written(tmp_path).items()


def flip(path):
    """Change a number's first digit in the middle: still of its format, never the same number (a 17th digit may be)."""
    raw = bytearray(path.read_bytes())
    at = re.compile(rb"(?<![\d.e+-])\d").search(raw, len(raw) // 2).start()
    raw[at] = ord("1") if raw[at] != ord("1") else ord("2")
    path.write_bytes(raw)


def cut(path):
    path.write_bytes(path.read_bytes()[:-100])


@pytest.mark.parametrize("damage", [flip, cut, Path.unlink], ids=["flipped", "cut", "gone"])
@pytest.mark.parametrize("file", [RESULT_FILE, FIELDS_FILE])
def test_damaged_member_is_told_and_computed_again(tmp_path, file, damage):
    run(members(1), tmp_path)
    damage(tmp_path / "seed-00" / file)
    outcome, notes = run(members(1), tmp_path)
    assert outcome.computed == ("seed-00",)
    if not (file == RESULT_FILE and damage is Path.unlink):  # which is a member that is not there
        assert outcome.damaged == ("seed-00",)
        assert "computed again" in notes[0]
    assert read_member(members(1)[0], tmp_path).status == "converged"


def test_result_of_another_scene_does_not_count(tmp_path):
    run(members(1), tmp_path)
    outcome, notes = run(members(1, seed=5), tmp_path)
    assert (outcome.damaged, outcome.computed) == (("seed-00",), ("seed-00",))
    assert "another scene" in notes[0]


def test_member_that_fails_is_named_and_spares_the_others(tmp_path, monkeypatch):
    solve = bem.solve

    def moody(scene):
        if scene.profile.seed == 0:
            raise ZeroDivisionError("the matrix is singular")
        return solve(scene)

    monkeypatch.setattr(bem, "solve", moody)
    outcome, _ = run(members(2), tmp_path)
    assert outcome.failed == {"seed-00": "ZeroDivisionError: the matrix is singular"}
    assert outcome.computed == ("seed-01",)


def test_mistake_in_a_scene_is_told_before_anything_runs(tmp_path):
    good = members(1)[0]
    wrong = Member("wrong", good.scene | {"solid": {"youngs_modulus": -1.0, "poisson_ratio": 0.5}})
    with pytest.raises(SceneError, match="youngs_modulus"):
        run([good, wrong], tmp_path)
    assert not written(tmp_path)


def test_two_members_of_one_name_are_refused(tmp_path):
    with pytest.raises(ValueError, match="named twice"):
        run(members(1) + members(1), tmp_path)


def test_killed_parent_loses_at_most_what_was_in_flight(tmp_path):
    count, harmonics = 4, 12
    command = [sys.executable, str(SCRIPT), str(tmp_path), str(count), str(harmonics)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    for line in process.stdout:
        if line.startswith("[2/"):
            break
    process.send_signal(signal.SIGKILL)
    process.communicate()
    before = written(tmp_path)
    outcome, _ = run(members(count, harmonics), tmp_path)
    assert len(before) >= 2
    assert outcome.damaged == ()
    assert len(outcome.found) == len(before)
    assert len(outcome.found) + len(outcome.computed) == count
    assert before.items() <= written(tmp_path).items()


def test_workers_end_with_a_killed_parent(tmp_path):
    command = [sys.executable, str(SCRIPT), str(tmp_path), "8", "24"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    process.stdout.readline()
    workers = [int(word) for word in Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()]
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert workers
    deadline = time.monotonic() + 20
    while any(alive(pid) for pid in workers) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(alive(pid) for pid in workers)


def alive(pid):
    """Whether a process runs; one that ended but was not waited for does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def test_killed_worker_costs_no_member(forked, tmp_path):
    notes = []

    def killing(note):
        notes.append(note.text)
        if len(notes) == 1:  # one member has ended: the worker that is killed has begun the next one, or is about to
            os.kill(multiprocessing.active_children()[0].pid, signal.SIGKILL)

    run_ensemble(members(4), tmp_path, 2, killing, local_processes)
    assert sorted(written(tmp_path)) == [member.name for member in members(4)]
    assert sum(text.startswith("[4/4]") for text in notes) == 1


def test_full_disk_is_an_error_and_corrupts_nothing(tmp_path):
    run(members(1), tmp_path)
    before = (tmp_path / "seed-00" / RESULT_FILE).read_bytes()

    def small_files():
        resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))

    command = [sys.executable, str(SCRIPT), str(tmp_path), "2", "3"]
    process = subprocess.run(command, capture_output=True, text=True, preexec_fn=small_files, check=False)
    assert process.returncode != 0
    assert "OSError" in process.stderr
    assert (tmp_path / "seed-00" / RESULT_FILE).read_bytes() == before
    assert not list(tmp_path.glob("*/.*"))
    outcome, _ = run(members(2), tmp_path)
    assert outcome.damaged == ()
    assert len(outcome.found) + len(outcome.computed) == 2


DYING = """
import os, signal, sys
from pathlib import Path
import bem.solver
from example_members import members
from in_this_process import here
from stored_states import lasting
from validation.harness.ensemble import run_ensemble

for folder, name, count in zip(*[iter(sys.argv[1:])] * 3):
    if (child := os.fork()) == 0:
        done, calls = getattr(os, name), []

        def dying(*words):
            calls.append(words)
            if len(calls) == int(count):
                os.kill(os.getpid(), signal.SIGKILL)
            return done(*words)

        setattr(os, name, dying)
        run_ensemble(members(3), Path(folder), 1, lambda note: None, here)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""
WRITTEN = [("fsync", 3), ("replace", 3), ("fsync", 4), ("replace", 4)]


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """Folders of ensembles, run by processes that killed themselves at a call of os.fsync or os.replace.

    There are two of each a member.  The last has a member that was to be replaced.
    """
    folders = {kill: tmp_path_factory.mktemp("killed") for kill in [*WRITTEN, ("replace", 2)]}
    run(members(1, seed=7), folders["replace", 2])
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(SCRIPT.parent), *filter(None, sys.path)])}
    words = [str(word) for kill, folder in folders.items() for word in (folder, *kill)]
    done = subprocess.run([sys.executable, "-c", DYING, *words], env=environment, capture_output=True, text=True)
    assert done.stdout.split() == [str(-signal.SIGKILL)] * len(folders), done.stderr
    return folders


@pytest.mark.parametrize("kill", WRITTEN)
def test_kill_while_a_member_is_written_loses_this_one_only(killed, kill):
    folder = killed[kill]
    before = written(folder)
    outcome, _ = run(members(3), folder)
    assert (outcome.found, outcome.damaged) == (("seed-00",), ())
    assert outcome.computed == ("seed-01", "seed-02")
    assert before.items() <= written(folder).items()


def test_kill_between_the_files_of_a_member_that_is_replaced_is_detected(killed):
    folder = killed["replace", 2]
    with pytest.raises(CorruptResultError, match="not the file written with"):
        read_member(members(1, seed=7)[0], folder)
    outcome, notes = run(members(1), folder)
    assert (outcome.damaged, outcome.computed) == (("seed-00",), ("seed-00",))
    assert "computed again" in notes[0]


@pytest.mark.parametrize("count", [3, 4], ids=["fields", "result"])
def test_disk_that_fills_up_ends_the_run_and_keeps_what_was_stored(tmp_path, monkeypatch, count):
    sync, calls = os.fsync, []

    def filling(descriptor):
        calls.append(descriptor)
        if len(calls) >= count:
            raise OSError(errno.ENOSPC, "No space left on device")
        sync(descriptor)

    monkeypatch.setattr(os, "fsync", filling)
    with pytest.raises(OSError, match="No space left"):
        run(members(3), tmp_path)
    assert not list(tmp_path.glob("*/.*"))
    monkeypatch.undo()
    outcome, _ = run(members(3), tmp_path)
    assert (outcome.found, outcome.damaged) == (("seed-00",), ())


def test_stored_file_is_json_with_its_checksum(stored):
    folder, _ = stored
    assert "checksum" in json.loads((folder / "seed-00" / RESULT_FILE).read_text())


def test_seeds_do_not_depend_on_the_size_of_the_ensemble():
    assert [member_seed(3, k) for k in range(2)] == [member_seed(3, k) for k in range(5)][:2]


def test_seeds_of_an_ensemble_differ():
    assert len({member_seed(3, k) for k in range(100)} | {member_seed(4, k) for k in range(100)}) == 200
