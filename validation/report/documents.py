"""Documents of the packages as text and as one HTML page: methods, keys, thresholds, as they were built.

The documents are Markdown beside the code: README.md, KEYS.md, THRESHOLDS.md; that of Python is made of the docstrings
of what `bem` exports and of what a result holds.  The page needs no network.  Of Markdown it knows what they use:
headings, paragraphs, lists, tables, code, emphasis, links, formulas.
"""

import inspect
import re
import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any

from markupsafe import Markup, escape

import bem
from bem.scene.result import Event, LargestTension
from bem.scene.state import State
from validation.report.formulas import formula
from validation.report.pages import filled

TOPICS = {  # of the terminal: package, and file beside its code
    "answer": ("validation", "ANSWER.md"),
    "keys": ("bem", "KEYS.md"),
    "bem": ("bem", "README.md"),
    "thresholds": ("bem", "THRESHOLDS.md"),
    "fem": ("fem_reference", "README.md"),
    "theory": ("persson", "README.md"),
    "python": ("bem", ""),
    "verification": ("validation", "README.md"),
    "challenge": ("validation.challenge", "README.md"),
}
INLINE = re.compile(
    r"``(.+?)``|`([^`]+)`|\$([^$]+)\$|\*\*(.+?)\*\*|\*([^*\s][^*]*)\*|\[([^\]]+)\]\(([^)\s]+)\)", re.DOTALL
)
ITEM = re.compile(r"(-|\d+\.) ")
HEADING = re.compile(r"(#{1,4}) (.+)")
WIDTH, MOST_HITS = 100, 12  # format: characters of a line, and paragraphs, of a search


class UnknownTopicError(ValueError):
    """Topic that no document has."""


@dataclass(frozen=True)
class Section:
    """Part of a document under a heading, with the text under it and its level."""

    level: int
    heading: str
    text: str


def document(topic: str) -> str:
    """Return the Markdown of a topic."""
    package, name = TOPICS[topic]
    if not name:
        return _docstrings()
    return resources.files(package).joinpath(name).read_text("utf-8")


def _docstrings() -> str:
    """Return the docstrings of what `bem` exports and a result holds, with public parts of classes, as Markdown."""
    text = ["# Python", "What `import bem` gives; a result and its states have the columns of `to_table` in SI units."]
    for owner in (*(getattr(bem, name) for name in bem.__all__), State, Event, LargestTension):
        name = owner.__name__
        parts = [(name, owner)]
        if inspect.isclass(owner):
            members = {key: value for base in reversed(owner.__mro__[:-1]) for key, value in vars(base).items()}
            parts += [(f"{name}.{key}", value) for key, value in members.items() if not key.startswith("_")]
        for title, part in parts:
            called = getattr(part, "__func__", part)
            if inspect.isclass(called) or inspect.isfunction(called) or isinstance(called, property):
                text.append(f"{'##' if called is owner else '###'} {title}")
                text.append(f"```\n{title}{_arguments(called)}\n\n{inspect.getdoc(called) or ''}\n```")
    return "\n\n".join(text) + "\n"


def _arguments(part: Any) -> str:
    """Return the arguments of a class or function with their defaults; their types are in its docstring."""
    if isinstance(part, property):
        return ""
    arguments = inspect.signature(part).parameters.values()
    named = [argument.replace(annotation=argument.empty) for argument in arguments if argument.name != "self"]
    return textwrap.fill(str(inspect.Signature(named)), WIDTH, subsequent_indent="    ")


def sections(text: str) -> list[Section]:
    """Return the sections of a document in order; headings inside code are no headings."""
    parts: list[tuple[int, str, list[str]]] = []
    fenced = False
    for line in text.splitlines():
        fenced ^= line.startswith("```")
        match = None if fenced else HEADING.fullmatch(line)
        if match:
            parts.append((len(match[1]), match[2], [line]))
        elif parts:
            parts[-1][2].append(line)
    return [Section(level, heading, "\n".join(lines).strip() + "\n") for level, heading, lines in parts]


def topic_text(topic: str, examples: Sequence[str] = ()) -> str:
    """Return the document of a topic, or the sections whose headings hold these words and what else does.

    `examples` are lines with the names and titles of the examples.

    Raises
    ------
    UnknownTopicError
        No heading and no line holds the words.
    """
    if topic.lower() in TOPICS:
        return document(topic.lower())
    words = topic.lower().split()
    topics = [words.pop(0)] if len(words) > 1 and words[0] in TOPICS else list(TOPICS)  # as in: keys loading
    parts: list[str] = []
    hits = [("linecontact example", line) for line in examples if _holds(line, words)]  # place and paragraph
    for name in topics:
        for section in sections(document(name)):
            if _holds(section.heading, words):
                parts.append(f"[{name}] {section.text}")
            else:
                hits += [
                    (f"[{name}] {section.heading}", block)
                    for block in _paragraphs(section.text)
                    if _holds(block, words)
                ]
    hits.sort(key=lambda hit: not hit[1].startswith(f"- `{' '.join(words)}"))  # keys of that name come first
    if not words or not parts + hits:
        raise UnknownTopicError(f"topic: {topic!r} is in no line; allowed: {', '.join(TOPICS)}, or words to search for")
    for place, block in hits[:MOST_HITS]:
        wrapped = textwrap.wrap(" ".join(block.split()), WIDTH - 4, break_on_hyphens=False)
        parts.append("\n    ".join([f"{place}:", *wrapped]))
    if len(hits) > MOST_HITS:
        parts.append(f"{len(hits) - MOST_HITS} more; a topic before the words has less, as in: docs keys {words[0]}")
    return "\n".join(parts)


def _paragraphs(text: str) -> Iterator[str]:
    """Yield the paragraphs, items of lists, rows of tables and indented parts of code of a section."""
    block: list[str] = []
    fenced = False
    for line in [*text.splitlines()[1:], ""]:
        begins = not line.strip() or ITEM.match(line) or line.startswith(("|", "```"))
        if block and (begins or (fenced and not line.startswith(" "))):
            yield "\n".join(block)
            block = []
        fenced ^= line.startswith("```")
        if line.strip() and not line.startswith("```"):
            block.append(line)


def _holds(text: str, words: Sequence[str]) -> bool:
    """Return whether a text holds all words, or words that begin with them, in any order and case, hyphens or not."""
    plain = text.lower().replace("-", "")
    return all(re.search(rf"(?<![a-z0-9]){re.escape(word.replace('-', ''))}", plain) for word in words)


def contents() -> str:
    """Return the topics with their titles and headings."""
    lines = []
    for topic in TOPICS:
        title, *parts = [section for section in sections(document(topic)) if section.level <= 2]
        lines += [f"{topic:<13} {title.heading}", *(f"{'':<15}{part.heading}" for part in parts)]
    return "\n".join(lines)


def documents_page(version: str) -> str:
    """Return one page with all documents."""
    pages = [(topic, _title(document(topic)), Markup("").join(_blocks(topic, document(topic)))) for topic in TOPICS]
    menu = [
        (topic, title, [part.heading for part in sections(document(topic)) if part.level == 2])
        for topic, title, _ in pages
    ]
    return filled("documents.jinja", {"anchor": anchor, "inline": inline}, version=version, pages=pages, menu=menu)


def _title(text: str) -> str:
    return sections(text)[0].heading


def anchor(topic: str, heading: str) -> str:
    """Return the place of a heading on the page.

    Examples
    --------
    >>> anchor("bem", "1. Problem and units")
    'bem-1-problem-and-units'
    """
    return f"{topic}-{'-'.join(re.findall('[a-z0-9]+', heading.lower()))}"


def _blocks(topic: str, text: str) -> Iterator[Markup]:
    """Yield the blocks of a document: headings, paragraphs, lists, tables, code."""
    lines = text.splitlines()
    while lines:
        line = lines[0]
        if not line.strip():
            lines.pop(0)
        elif line.startswith("```"):
            kind, code = lines.pop(0)[3:], _taken(lines, lambda rest: not rest.startswith("```"))
            lines[:1] = []
            block = "\n".join(code)
            if kind == "math":
                yield Markup('<div class="wide">{}</div>').format(formula(block, display=True))
            else:
                yield Markup("<pre><code>{}</code></pre>\n").format(block)
        elif match := HEADING.fullmatch(lines[0]):
            lines.pop(0)
            level = min(len(match[1]) + 1, 4)
            place = anchor(topic, match[2])
            yield Markup(f'<h{level} id="{{}}">{{}}</h{level}>\n').format(place, inline(match[2]))
        elif line.startswith("|"):
            yield _table(_taken(lines, lambda rest: rest.startswith("|")))
        elif ITEM.match(line):
            yield _list(_taken(lines, lambda rest: bool(ITEM.match(rest)) or rest.startswith("  ")))
        elif line.startswith("    "):
            yield Markup("<pre><code>{}</code></pre>\n").format(
                "\n".join(_taken(lines, lambda rest: rest.startswith("    ")))
            )
        else:
            words = _taken(lines, lambda rest: bool(rest.strip()) and not rest.startswith(("```", "|", "#", "- ")))
            yield Markup("<p>{}</p>\n").format(inline(" ".join(words)))


def _taken(lines: list[str], belongs: Callable[[str], bool]) -> list[str]:
    """Return the first lines that belong to a block, and remove them."""
    count = next((k for k, line in enumerate(lines) if k and not belongs(line)), len(lines)) if lines else 0
    if lines and not belongs(lines[0]):
        count = 0
    block, lines[:] = lines[:count], lines[count:]
    return block


def _list(lines: Sequence[str]) -> Markup:
    """Return a list, numbered if its first item is."""
    items: list[str] = []
    for line in lines:
        if ITEM.match(line):
            items.append(ITEM.sub("", line, count=1))
        else:
            items[-1] += " " + line.strip()
    kind = "ol" if lines[0][0].isdigit() else "ul"
    content = Markup("").join(Markup("<li>{}</li>\n").format(inline(item)) for item in items)
    return Markup(f"<{kind}>\n{{}}</{kind}>\n").format(content)


def _table(lines: Sequence[str]) -> Markup:
    """Return a table; its second line is a rule."""
    head, _, *body = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip().strip("|"))] for line in lines]
    cells = [Markup("").join(Markup("<td>{}</td>").format(inline(cell)) for cell in row) for row in body]
    heads = Markup("").join(Markup("<th>{}</th>").format(inline(cell)) for cell in head)
    rows = Markup("").join(Markup("<tr>{}</tr>\n").format(row) for row in cells)
    return Markup('<div class="wide"><table><thead><tr>{}</tr></thead><tbody>\n{}</tbody></table></div>\n').format(
        heads, rows
    )


def inline(text: str) -> Markup:
    """Return a line of Markdown: code, formulas, emphasis and links.

    Examples
    --------
    >>> print(inline("*residual* of `G/w`, <b>"))
    <em>residual</em> of <code>G/w</code>, &lt;b&gt;
    """
    parts, place = [], 0
    for match in INLINE.finditer(text):
        parts.append(escape(text[place : match.start()]))
        place = match.end()
        quoted, code, tex, strong, emphasis, words, address = match.groups()
        if tex is not None:
            parts.append(formula(tex))
        elif strong is not None:
            parts.append(Markup("<strong>{}</strong>").format(inline(strong)))
        elif emphasis is not None:
            parts.append(Markup("<em>{}</em>").format(inline(emphasis)))
        elif words is not None:
            web = address.startswith("https://")
            parts.append(Markup('<a href="{}">{}</a>').format(address, inline(words)) if web else inline(words))
        else:
            parts.append(Markup("<code>{}</code>").format(quoted or code))
    return Markup("").join([*parts, escape(text[place:])])
