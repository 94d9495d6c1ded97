"""The lengths of crank and coupler at which a slider-crank just reaches the pin."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from camgeo.mechanism.linkage_protocol import Size


class Dimensions(Protocol):
    """What is read of a `camgeo.mechanism.slider_crank.SliderCrank`."""

    @property
    def crank(self) -> float: ...

    @property
    def coupler(self) -> float: ...

    @property
    def deflection(self) -> float: ...

    @property
    def leans_away(self) -> bool: ...

    @property
    def slider_side(self) -> int: ...

    @property
    def stroke_direction(self) -> int: ...

    @property
    def guide_height(self) -> float: ...


def size_limits(linkage: Dimensions, size: Size, strokes: tuple[float, float]) -> tuple[float, ...]:
    """See `Linkage.size_limits`.

    With X = a (l_4 - b l_sk sin alpha) + eps_s s, a the side of the slider, b = +1 if the crank
    leans away, and d^2 = X^2 + (l_sk cos alpha)^2, the condition d = l_sk + l_4 as well as
    d = |l_sk - l_4| is linear in each of the two lengths: their squares cancel. Between the ends of
    the stroke d is least where X = 0, at the height of the guide.
    """
    found = _of_coupler(linkage, strokes) if size == "coupler" else _of_crank(linkage, strokes)
    return tuple(top / bottom for top, bottom in found if bottom != 0.0)


def _of_coupler(linkage: Dimensions, strokes: tuple[float, float]) -> Iterator[tuple[float, float]]:
    """Numerators and denominators for l_4."""
    crank, height, side = linkage.crank, linkage.guide_height, linkage.slider_side
    lean = crank * math.sin(linkage.deflection)
    lean = lean if linkage.leans_away else -lean
    yield crank + height, 1.0
    yield crank - height, 1.0
    for stroke in strokes:
        rest = linkage.stroke_direction * stroke - side * lean  # X = a l_4 + rest
        # l_sk^2 - e_sk^2 is the square of the lean
        top = (lean - rest) * (lean + rest)
        yield top, 2.0 * (side * rest - crank)
        yield top, 2.0 * (side * rest + crank)
        yield -side * rest, 1.0


def _of_crank(linkage: Dimensions, strokes: tuple[float, float]) -> Iterator[tuple[float, float]]:
    """Numerators and denominators for l_sk."""
    coupler, side = linkage.coupler, linkage.slider_side
    sine, cosine = math.sin(linkage.deflection), math.cos(linkage.deflection)
    sine = sine if linkage.leans_away else -sine
    yield coupler, 1.0 + cosine
    yield coupler, 1.0 - cosine
    for stroke in strokes:
        rest = side * linkage.stroke_direction * stroke + coupler  # a X = rest - b l_sk sin alpha
        top = (rest - coupler) * (rest + coupler)
        yield top, 2.0 * (coupler + rest * sine)
        yield -top, 2.0 * (coupler - rest * sine)
        yield rest, sine
