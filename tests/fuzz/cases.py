"""The cases of a run, by its seed and their numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from random import Random
from typing import Final

from tests.fuzz.case import Case
from tests.fuzz.extremes import extreme_case, number_case
from tests.fuzz.files import file_case
from tests.fuzz.lines import line_case
from tests.fuzz.scenes import scene_case

KINDS: Final[Mapping[str, tuple[Callable[[Random], Case], float]]] = {
    "scenes": (scene_case, 0.6),
    "lines": (line_case, 0.2),
    "files": (file_case, 0.2),
    "extremes": (extreme_case, 0.0),
    "numbers": (number_case, 0.0),
}
"""What draws the cases of a kind, and its share of the cases where no kind is asked for."""


def draw(seed: int, number: int, kind: str | None = None) -> tuple[str, Case]:
    """The kind and the case of that number of a run."""
    rng = Random(f"{seed}/{number}")
    shares = {kind: 1.0} if kind else {name: share for name, (_, share) in KINDS.items()}
    chosen = rng.choices(list(shares), list(shares.values()))[0]
    return chosen, KINDS[chosen][0](rng)
