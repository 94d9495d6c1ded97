"""Standard scales (ISO 5455)."""

from __future__ import annotations

from fractions import Fraction
from typing import Final

LARGEST: Final = 50

SMALLEST: Final = 100_000


def scales() -> tuple[Fraction, ...]:
    """Millimetres of paper for each of the part, the largest first."""
    sizes = [step * 10**power for power in range(6) for step in (1, 2, 5)]
    up = [Fraction(size) for size in sizes if size <= LARGEST]
    down = [Fraction(1, size) for size in sizes if 1 < size <= SMALLEST]
    return (*reversed(up), *down)


def spelled(scale: Fraction) -> str:
    """As it stands in the title block, "1:2"."""
    return f"{scale.numerator}:{scale.denominator}"


def scale_of(text: str) -> Fraction:
    """The scale that is spelled so."""
    first, _, second = text.partition(":")
    return Fraction(int(first), int(second))
