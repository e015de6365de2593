"""Equations of cases as MathML, DOIs and arXiv numbers as links: text with `$...$` and references becomes markup.

Between dollar signs stands LaTeX, which latex2mathml converts when the page is rendered, so that the page needs no
script.  A command that it does not know it would hand on as it stands, backslash included: that is refused.
"""

from __future__ import annotations

import re
from xml.etree import ElementTree

from latex2mathml.converter import convert
from markupsafe import Markup, escape

FUNCTIONS = "sin|cos|tan|arcsin|sinh|cosh|ln"
# a function, with its power or not, before anything but an operator: a thin space is due there
_NAME = rf"<mi>(?:{FUNCTIONS})</mi>"
_APPLIED = re.compile(rf"((?:<msup>{_NAME}<mn>\d</mn></msup>)|{_NAME})(?=<m(?!o|space))")
_REFERENCE = re.compile(
    r"(?P<doi>doi:(?P<number>10\.\d{4,9}/[^\s,;]*[^\s,;.)]))|(?P<arxiv>arXiv:(?P<paper>\d{4}\.\d{4,5}))"
)


class TypesettingError(ValueError):
    """A text whose equations cannot be set."""


def typeset(text: str) -> Markup:
    """A plain text as markup: LaTeX between dollar signs as MathML, everything else escaped.

    TypesettingError for an odd number of dollar signs, or LaTeX that the converter does not know.

    Examples
    --------
    >>> typeset("load < K, whatever $H$").replace(' xmlns="http://www.w3.org/1998/Math/MathML" display="inline"', "")
    Markup('load &lt; K, whatever <math><mrow><mi>H</mi></mrow></math>')
    >>> typeset("from $a on")
    Traceback (most recent call last):
    ...
    validation.report.verification.typesetting.TypesettingError: from $a on: an equation begins at $ and does not end
    """
    pieces = text.split("$")
    if len(pieces) % 2 == 0:
        raise TypesettingError(f"{text}: an equation begins at $ and does not end")
    return Markup("").join(_mathml(piece) if place % 2 else escape(piece) for place, piece in enumerate(pieces))


def _mathml(latex: str) -> Markup:
    found = convert(latex)
    written = "".join(ElementTree.fromstring(found).itertext())
    if "\\" in written:
        raise TypesettingError(f"${latex}$: a command that the converter does not know")
    return Markup(_APPLIED.sub(r'\1<mspace width="0.17em"/>', found))


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


def subscripts(text: str) -> Markup:
    """A text with what follows an underscore set below the line, everything else escaped.

    Examples
    --------
    >>> subscripts("2 u_val & more")
    Markup('2 u<sub>val</sub> &amp; more')
    """
    return Markup(re.sub(r"_(\w+)", r"<sub>\1</sub>", str(escape(text))))
