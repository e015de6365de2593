"""Error of a scene that cannot be solved, with all its mistakes."""

from __future__ import annotations

from collections.abc import Iterable

from bem.geometry.ranges import Mistake


class SceneError(ValueError):
    """Scene that cannot be solved; `mistakes` lists all its mistakes."""

    def __init__(self, mistakes: Iterable[Mistake]) -> None:
        self.mistakes = tuple(mistakes)
        count = f"{len(self.mistakes)} mistake{'s' * (len(self.mistakes) != 1)} in the scene"
        super().__init__("\n  ".join([f"{count}:", *map(str, self.mistakes)]))

    def __reduce__(self) -> tuple[type[SceneError], tuple[tuple[Mistake, ...]]]:
        """Return what pickle needs to build an equal error in another process."""
        return SceneError, (self.mistakes,)
