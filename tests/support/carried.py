"""A study carried out as its command does, and what of the report fails."""

from validation.harness.executors import local_processes
from validation.harness.schema import with_checksum
from validation.report.render import failures
from validation.studies.bench import Bench, carried_out


def silent(note):
    return None


def carried(module, folder, *, quick=True, say=silent, jobs=1, opener=local_processes, **given):
    bench = Bench(folder, quick, say, jobs, opener)
    return with_checksum(carried_out("example", module.cases(bench, **given), bench, "study example"))


def failing(report):
    return [why for _, why in failures(report)]


def lines(report):
    """Every line of every table, as text."""
    return [" ".join(map(str, row)) for case in report.cases for table in case.tables for row in table.rows]
