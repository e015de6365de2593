"""study.html of the study of a scene: what its accuracy costs and what is left open, from its study.json alone."""

import json
from pathlib import Path
from typing import Any

from bem.command_line.console import scene_text
from bem.scene.atomic_file import write_atomically
from validation.harness.schema import Figure
from validation.report.figures import svg_of
from validation.report.pages import filled
from validation.report.run_words import scene_in_words

FILE, PAGE = "study.json", "study.html"
DOUBTFUL = 0.1  # relative uncertainty of the input beyond which an answer is no more than a hint


def write_study_page(folder: Path) -> None:
    """Render the study.json of a folder into study.html beside it."""
    write_atomically(folder / PAGE, render_study(json.loads((folder / FILE).read_text("utf-8"))))


def render_study(content: dict[str, Any]) -> str:
    """The page of the content of study.json as text."""
    figure = Figure.model_validate(content["figure"])
    return filled(
        "study_page.jinja",
        {"share": share},
        doubtful=max((row["input"] or 0.0 for row in content["targets"]), default=0.0) > DOUBTFUL,
        heading=content["scene"]["title"] or "A scene",
        study=content,
        words=scene_in_words(content["scene"]),
        toml=scene_text(content["scene"]),
        figure=figure,
        svg=svg_of(figure, f"study-{figure.id}"),
    )


def share(relative: float | None) -> str:
    """A relative number: in per cent, or as it is where it is tiny.

    Examples
    --------
    >>> share(0.0832), share(2.5), share(3e-10), share(0.0), share(None)
    ('8.3 %', '250 %', '3e-10', '0', '–')
    """
    if relative is None:  # as JSON holds infinity, and numbers that do not exist
        return "–"
    if relative >= 1:
        return f"{100 * relative:.0f} %"
    return f"{100 * relative:.2g} %" if relative >= 1e-4 else f"{relative:.1g}"
