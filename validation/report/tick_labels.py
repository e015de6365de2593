"""Labels of logarithmic axes as plain text, 10⁻³ or 2×10⁻³: read, found and copied as they are seen.

As mathematical text, each of them is parsed anew, which takes a quarter of the time of a figure.
"""

import re

from matplotlib.axis import Axis
from matplotlib.ticker import LogFormatterSciNotation

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
POWER = re.compile(r"\$\\mathdefault\{(.*?)(?:\\times)?10\^\{(-?\d+)\}\}\$")


class PlainPowers(LogFormatterSciNotation):
    """Formatter that writes Matplotlib's powers of ten as plain text and keeps all other labels."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Return the label of a tick."""
        power = POWER.fullmatch(label := str(super().__call__(x, pos)))
        return f"{power[1]}{'×' * bool(power[1])}10{power[2].translate(RAISED)}" if power else label


def label_plainly(*axes: Axis) -> None:
    """Set plain labels on the logarithmic axes."""
    for axis in axes:
        if axis.get_scale() == "log":
            axis.set_major_formatter(PlainPowers())
            axis.set_minor_formatter(PlainPowers(labelOnlyBase=False))
