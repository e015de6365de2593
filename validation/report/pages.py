"""Pages from templates: one style sheet, one script, everything escaped, nothing undefined."""

import math
import re
from collections.abc import Callable, Mapping
from importlib import resources
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

PAGE = "report.html"
_NO_PAGE_HOLDS = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


class ReportError(ValueError):
    """A report that cannot be read or rendered."""


def filled(template: str, filters: Mapping[str, Callable[..., Any]] | None = None, **values: Any) -> str:
    """Return a page from its template, with the style and the script of all pages.

    Only `Markup` that this package has made stands on the page as it is; no template marks a value as safe.
    """
    environment = Environment(
        loader=PackageLoader("validation.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"number": number, "subscripts": subscripts, "counted": counted}
    environment.filters |= {"sorted_by": sorted_by, "printable": printable} | dict(filters or {})
    style, script = Markup(asset("style.css")), Markup(asset("sort.js"))
    return printable(environment.get_template(template).render(style=style, script=script, **values))


def number(value: Any, digits: int = 4) -> str:
    """Return a number with so many digits, None as a dash; other values as they are.

    Examples
    --------
    >>> number(1.23456789e-12), number(0.25), number(3), number(None)
    ('1.235e-12', '0.25', '3', '–')
    """
    if value is None:
        return "–"
    if isinstance(value, bool) or not isinstance(value, float):
        return str(value)
    if math.isnan(value):
        return "not a number"
    return f"{value:.{digits}g}"


def counted(count: int, word: str, many: str | None = None) -> str:
    """Return a count with its noun.

    Examples
    --------
    >>> counted(1, "case"), counted(0, "case"), counted(2, "process", "processes")
    ('1 case', '0 cases', '2 processes')
    """
    return f"{count} {word if count == 1 else many or word + 's'}"


def judgement(good: Any) -> tuple[str, str]:
    """Return verdict and mark of a condition."""
    return ("agrees", "✓") if good else ("deviates", "✗")


def sorted_by(value: Any) -> Any:
    """Return the key by which a cell is sorted, empty where its number is not known."""
    return "" if value is None else value


def printable(text: str) -> str:
    r"""Return a text in which control characters and halves of surrogate pairs are written as their escapes.

    Examples
    --------
    >>> printable("a\x00b\udc80\n")
    'a\\x00b\\udc80\n'
    """
    return _NO_PAGE_HOLDS.sub(lambda match: match[0].encode("unicode_escape").decode(), text)


def subscripts(text: str) -> Markup:
    """Return a text in which the part of a name after an underscore is set as a subscript.

    Examples
    --------
    >>> subscripts("2 u_val & more")
    Markup('2 u<sub>val</sub> &amp; more')
    """
    return Markup(re.sub(r"_(\w+)", r"<sub>\1</sub>", str(escape(text))))


def asset(name: str) -> str:
    """Return the text of a file beside the templates."""
    return resources.files("validation.report").joinpath(name).read_text("utf-8")
