"""Equations of cases as MathML, DOIs and arXiv numbers as links: text with `$...$` and references becomes markup.

Between dollar signs stands LaTeX, which latex2mathml reads into a tree when the page is rendered, so that the page
needs no script.  Of that tree only elements and attributes of MathML that set symbols are written, every text and value
escaped: a link or a style in it, or a command that is not known, makes the equation one that cannot be set, and such a
one is shown as it is written.  `unset` names it before the work; what is found on the page afterwards loses no verdict.
"""

import re
from collections.abc import Iterator
from html import unescape
from xml.etree.ElementTree import Element

from latex2mathml.converter import Converter
from markupsafe import Markup, escape

ELEMENTS = re.compile(
    "math|maction|menclose|merror|mfrac|mi|mn|mo|mover|mpadded|mphantom|mroot|mrow|mspace|msqrt|mstyle|msub|msubsup|"
    "msup|mtable|mtd|mtext|mtr|munder|munderover"
)
ATTRIBUTES = re.compile(
    "accent|accentunder|columnalign|columnlines|columnspacing|depth|display|displaystyle|fence|form|height|largeop|"
    "linebreak|linethickness|lspace|mathbackground|mathcolor|mathsize|mathvariant|maxsize|minsize|movablelimits|"
    "notation|rowlines|rowspacing|rspace|scriptlevel|separator|stretchy|voffset|width|xmlns"
)
FUNCTIONS = "sin|cos|tan|arcsin|sinh|cosh|ln"
# a function, with its power or not, before anything but an operator: a thin space is due there
_NAME = rf"<mi>(?:{FUNCTIONS})</mi>"
_APPLIED = re.compile(rf"((?:<msup>{_NAME}<mn>\d</mn></msup>)|{_NAME})(?=<m(?!o|space))")
_REFERENCE = re.compile(
    r"(?P<doi>doi:(?P<number>10\.\d{4,9}/[^\s,;]*[^\s,;.)]))|(?P<arxiv>arXiv:(?P<paper>\d{4}\.\d{4,5}))"
)


class TypesettingError(ValueError):
    """An equation that cannot be set."""


def typeset(text: str) -> Markup:
    r"""A plain text as markup: LaTeX between dollar signs as MathML, everything else escaped.

    An equation that cannot be set is shown as it is written, dollar signs included.

    Examples
    --------
    >>> typeset("load < K, whatever $H$").replace(' xmlns="http://www.w3.org/1998/Math/MathML" display="inline"', "")
    Markup('load &lt; K, whatever <math><mrow><mi>H</mi></mrow></math>')
    >>> typeset(r"from $\nonsense$ & $a on")
    Markup('from <code>$\\nonsense$</code> &amp; $a on')
    """
    return Markup("").join(escape(plain) if latex is None else _set_or_shown(latex) for plain, latex in _pieces(text))


def unset(text: str) -> list[str]:
    r"""Why equations of a text cannot be set, a sentence for each; empty where all can.

    Examples
    --------
    >>> unset(r"$K$"), unset("from $a on"), unset(r"$\nonsense$")
    ([], ['from $a on: an equation begins at $ and does not end'], ['$\\nonsense$: \\nonsense is not known'])
    """
    found = [] if text.count("$") % 2 == 0 else [f"{text}: an equation begins at $ and does not end"]
    for _, latex in _pieces(text):
        if latex is not None:
            try:
                _mathml(latex)
            except TypesettingError as error:
                found.append(str(error))
    return found


def _pieces(text: str) -> Iterator[tuple[str, str | None]]:
    """Plain text with None, and LaTeX; a dollar sign without its other one is plain text."""
    pieces = text.split("$")
    if len(pieces) % 2 == 0:
        pieces[-2:] = ["$".join(pieces[-2:])]
    for place, piece in enumerate(pieces):
        yield (piece, None) if place % 2 == 0 else ("", piece)


def _set_or_shown(latex: str) -> Markup:
    try:
        return _mathml(latex)
    except TypesettingError:
        return Markup("<code>${}$</code>").format(latex)


def _mathml(latex: str) -> Markup:
    """The MathML of LaTeX; TypesettingError where the converter cannot read it, or it asks for more than symbols."""
    try:
        found = Converter().convert_to_element(latex)
    except Exception as error:  # the converter raises whatever comes, RecursionError where the nesting is deep
        raise TypesettingError(f"${latex}$: {type(error).__name__}") from error
    try:
        return Markup(_APPLIED.sub(r'\1<mspace width="0.17em"/>', _written(found)))
    except (TypesettingError, RecursionError) as error:
        raise TypesettingError(f"${latex}$: {error}") from error


def _written(element: Element) -> Markup:
    if not ELEMENTS.fullmatch(element.tag):
        raise TypesettingError(f"<{element.tag}> is no symbol")
    beyond = [name for name in element.keys() if not ATTRIBUTES.fullmatch(name)]  # noqa: SIM118 (no mapping)
    if beyond:
        raise TypesettingError(f"{', '.join(beyond)} sets no symbol")
    given = unescape(element.text or "")  # the converter names characters as entities
    if "\\" in given:
        raise TypesettingError(f"{given} is not known")
    attributes = Markup("").join(Markup(' {}="{}"').format(name, value) for name, value in element.items())
    inner = escape(given) + Markup("").join(map(_written, element))
    return Markup("<{0}{1}>{2}</{0}>").format(element.tag, attributes, inner)


def with_links(text: str) -> Markup:
    """A text with links to the DOIs and arXiv numbers in it, everything else escaped.

    Examples
    --------
    >>> with_links("A & B, doi:10.1000/x(1)2.")
    Markup('A &amp; B, <a href="https://doi.org/10.1000/x(1)2">doi:10.1000/x(1)2</a>.')
    """
    found, end = Markup(""), 0
    for match in _REFERENCE.finditer(text):
        where = f"https://doi.org/{match['number']}" if match["doi"] else f"https://arxiv.org/abs/{match['paper']}"
        found += escape(text[end : match.start()]) + Markup('<a href="{}">{}</a>').format(where, match[0])
        end = match.end()
    return found + escape(text[end:])
