"""The cases of a run, by its seed and their numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from random import Random
from typing import Final

from tests.fuzz.case import Case
from tests.fuzz.files import file_case
from tests.fuzz.lines import line_case
from tests.fuzz.scenes import scene_case

KINDS: Final[Mapping[str, tuple[Callable[[Random], Case], float]]] = {
    "scenes": (scene_case, 0.6),
    "lines": (line_case, 0.2),
    "files": (file_case, 0.2),
}
"""What draws the cases of a kind, and its share of the cases."""


def draw(seed: int, number: int, kind: str | None = None) -> tuple[str, Case]:
    """The kind and the case of that number of a run."""
    rng = Random(f"{seed}/{number}")
    kinds = [kind] if kind else list(KINDS)
    chosen = rng.choices(kinds, [KINDS[each][1] for each in kinds])[0]
    return chosen, KINDS[chosen][0](rng)
