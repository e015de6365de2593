"""All commands of `linecontact`: scenes and their results, the verification, and the studies.

`python -m bem` and `python -m validation` have a part of them, by the same parsers; `verify` is `run` there.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from difflib import get_close_matches
from pathlib import Path

import bem
import validation.__main__ as harness
from bem import scene_commands as scenes
from bem.command_line.perform import BAD_INPUT, DONE, FAILED
from bem.scene.atomic_file import write_atomically
from validation.command_line import comparison, examples, fem_answer, trace_answer
from validation.report.documents import TOPICS, UnknownTopicError, contents, documents_page, topic_text


def main(arguments: Sequence[str]) -> int:
    """Run one command of `linecontact` and return its exit code."""
    parser, names = _parser()
    if arguments and not arguments[0].startswith("-") and arguments[0] not in names:
        near = get_close_matches(arguments[0], names, 1)
        meant = f"; did you mean {near[0]}" if near else ""
        if Path(arguments[0]).is_file():
            meant = f", but a file; linecontact answer {arguments[0]} .. takes a trace, linecontact run a scene"
        parser.error(f"no command {arguments[0]!r}{meant}; allowed: {', '.join(names)}")
    options = parser.parse_args(harness.without_kind(arguments))
    perform: Callable[[argparse.Namespace], int] = options.perform
    return perform(options)


def _parser() -> tuple[argparse.ArgumentParser, list[str]]:
    """Return the parser of all commands, and their names."""
    parser = argparse.ArgumentParser(prog="linecontact", description="Adhesive contact of rough profiles, verified.")
    parser.add_argument("--version", action="version", version=f"%(prog)s {bem.__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    example = commands.add_parser("example", help="list examples, or write one into the current folder")
    example.add_argument("name", nargs="?", choices=examples.NAMES, metavar="NAME", help=", ".join(examples.NAMES))
    example.set_defaults(command=_example, perform=harness.perform)

    docs = commands.add_parser("docs", help="methods and keys, as this package was built: topics, or one topic")
    docs.add_argument("topic", nargs="*", metavar="TOPIC", help=f"{', '.join(TOPICS)}, or words to search for")
    docs.add_argument("--html", type=Path, metavar="FILE", help="write all of them as one page, which needs no network")
    docs.add_argument("--overwrite", action="store_true", help="replace FILE")
    docs.set_defaults(command=_docs, perform=harness.perform)

    scenes.add_commands(commands)
    trace_answer.add_command(commands)
    fem_answer.add_command(commands, harness.perform)
    harness.add_commands(commands, run_name="verify")

    two = commands.add_parser("compare", help="two results, or two verification reports, by their uncertainties")
    two.add_argument("a", type=Path, metavar="A")
    two.add_argument("b", type=Path, metavar="B")
    two.set_defaults(command=_compare, perform=harness.perform)
    return parser, list(commands.choices)


def _example(options: argparse.Namespace) -> int:
    if options.name is None:
        print("\n".join(examples.listed()))
        return DONE
    for path in examples.write_example(options.name, Path()):
        print(path)
    return DONE


def _docs(options: argparse.Namespace) -> int:
    """Print the topics or a topic, or write all of them as a page and print its path."""
    try:
        if options.html is None:
            print(topic_text(" ".join(options.topic), examples.listed()) if options.topic else contents())
            return DONE
    except UnknownTopicError as error:
        print(f"error: {error}", file=sys.stderr)
        return BAD_INPUT
    if options.html.exists() and not options.overwrite:
        raise FileExistsError(17, "is there already, nothing is written; --overwrite replaces it", str(options.html))
    write_atomically(options.html, documents_page(bem.__version__))
    print(options.html)
    return DONE


def _compare(options: argparse.Namespace) -> int:
    """Print the differences, the largest of each quantity, and the number of compared numbers."""
    compared = comparison.compare(options.a, options.b)
    differing, apart = compared.differing, sum(number.differs for number in compared.numbers)
    most = max(compared.numbers, key=lambda number: number.ratio / number.limit)
    ending = f"they agree; at most, {most}"
    if differing:
        ending = f"{apart} differ, and {len(compared.others)} other differences"
    lines = [*compared.notes, *(f"DIFFERS {line}" for line in differing)]
    print(*lines, f"{len(compared.numbers)} numbers compared: {ending}", sep="\n")
    return FAILED if differing else DONE
