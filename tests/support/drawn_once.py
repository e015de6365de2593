"""Figures of pages, equal ones drawn once: most of what a page costs, for tests that read the rest of it."""

from functools import cache

from validation.harness.figure_data import Figure
from validation.report.figures import svg_of


def drawn_once(figure, prefix):
    """As `svg_of`, by which the pages of a test are filled."""
    return _drawn(figure.model_dump_json(), prefix)


@cache
def _drawn(figure, prefix):
    return svg_of(Figure.model_validate_json(figure), prefix)
