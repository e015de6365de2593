"""Labels of logarithmic axes as plain text, 10⁻³ or 2×10⁻³: read, found and copied as they are seen.

As mathematical text, each of them is parsed anew, which takes a quarter of the time of a figure.
"""

import re

from matplotlib.axis import Axis
from matplotlib.ticker import LogFormatterSciNotation

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
POWER = re.compile(r"\$\\mathdefault\{(?:(?P<factor>[^{}]+)\\times)?10\^\{(?P<exponent>-?\d+)\}\}\$")


class PlainPowers(LogFormatterSciNotation):
    """Formatter that writes Matplotlib's powers of ten as plain text and keeps all other labels."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Return the label of a tick."""
        label: str = super().__call__(x, pos)
        return plain(label)


def plain(label: str) -> str:
    r"""Return a power of ten in Matplotlib's mathematical text as plain text.

    Examples
    --------
    >>> plain(r"$\mathdefault{10^{-3}}$"), plain(r"$\mathdefault{2\times10^{4}}$"), plain("0.5")
    ('10⁻³', '2×10⁴', '0.5')
    """
    power = POWER.fullmatch(label)
    if power is None:
        return label
    factor = "" if power["factor"] is None else f"{power['factor']}×"
    return f"{factor}10{power['exponent'].translate(RAISED)}"


def label_plainly(*axes: Axis) -> None:
    """Set plain labels on the logarithmic axes."""
    for axis in axes:
        if axis.get_scale() == "log":
            axis.set_major_formatter(PlainPowers())
            axis.set_minor_formatter(PlainPowers(labelOnlyBase=False))
