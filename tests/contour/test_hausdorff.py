"""The Hausdorff distance of contours, compared with dense sampling and closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.geometry.contour import hausdorff
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.hausdorff import SHARPNESS, distance
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.contour.cams import outline
from tests.long_form import examples

some = settings(max_examples=examples(15, long=60), deadline=None)

SAMPLES = 2_000
"""Points of each contour, dense enough that the distance between two is hardly larger."""

SQUARE: ComplexArray = np.array([5.0, 5j, -5.0, -5j], dtype=np.complex128)


@st.composite
def contours(draw: st.DrawFn) -> Contour:
    """Lines, flat arcs and arcs of up to half a turn between points about a circle."""
    chance = np.random.default_rng(draw(st.integers(0, 10**6)))
    count = draw(st.integers(3, 9))
    points = np.exp(2j * math.pi * np.arange(count) / count)
    points = points * chance.uniform(5.0, 10.0, count) + draw(st.floats(-3.0, 3.0))
    sizes = 10.0 ** chance.uniform(-12.0, math.log10(math.pi), count)
    return Contour.through(points, chance.choice([-1.0, 0.0, 1.0], count) * sizes)


@some
@given(contours(), contours())
def test_sampling_finds_no_more_and_hardly_less(one: Contour, other: Contour) -> None:
    a, b = outline(one), outline(other)
    found = max(
        float(np.max(a.distances(b.dense(SAMPLES)))), float(np.max(b.distances(a.dense(SAMPLES))))
    )
    bound = distance(one, other)
    longest = max(float(np.max(each.lengths)) for each in (one, other))
    assert found - 1e-7 <= bound <= found + longest / SAMPLES * len(one) * len(other) + 1e-9


@some
@given(contours(), contours())
def test_the_same_both_ways_and_however_it_is_run(one: Contour, other: Contour) -> None:
    bound = distance(one, other)
    near = pytest.approx(bound, rel=2.0 * SHARPNESS, abs=1e-13)
    assert distance(other, one) == near
    assert distance(one.reversed(), other.rolled(1)) == near


@some
@given(contours(), st.floats(-12.0, 0.0), st.floats(0.0, 6.3))
def test_a_shift_is_no_farther_than_it_goes(contour: Contour, size: float, angle: float) -> None:
    step = 10.0**size * complex(math.cos(angle), math.sin(angle))
    moved = Contour.through(contour.vertices + step, contour.sweeps)
    assert distance(contour, moved) <= abs(step) * (1.0 + SHARPNESS) + 1e-13


def test_closed_forms() -> None:
    """A square in its circumscribed circle; two circles apart; a half disc in its box."""
    circle = Contour.circle(5.0)
    square = Contour.polygon(SQUARE)
    assert distance(circle, square) == pytest.approx(5.0 - 5.0 / math.sqrt(2.0), rel=1e-8)
    assert distance(circle, Contour.circle(4.0, 20.0 + 0j)) == pytest.approx(21.0, rel=1e-8)
    # The corners of the box are farthest from the arc.
    half = Contour.through(np.array([3j, -3j]), np.array([-math.pi, 0.0]))
    box = Contour.polygon(np.array([-3j, 3.0 - 3j, 3.0 + 3j, 3j]))
    assert distance(half, box) == pytest.approx(math.hypot(3.0, 3.0) - 3.0, rel=1e-8)


def test_without_enough_halvings_it_is_still_a_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    circle = Contour.circle(5.0)
    square = Contour.polygon(SQUARE)
    exact = distance(circle, square)
    bounds = []
    for halvings in (1, 2, 4):
        monkeypatch.setattr(hausdorff, "HALVINGS", halvings)
        bounds.append(distance(circle, square))
    assert bounds == sorted(bounds, reverse=True)
    assert bounds[-1] >= exact * (1.0 - 2.0 * SHARPNESS)


def test_blocks_and_a_cap_change_no_more_than_the_sharpness(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Memory is that of a block of pairs; at the cap of cells the bound is wider, and holds."""
    chance = np.random.default_rng(4)
    ways = np.exp(2j * math.pi * np.arange(400) / 400.0)
    one, other = (Contour.polygon(ways * chance.uniform(9.9, 10.1, 400)) for _ in range(2))
    bound = distance(one, other)
    most = 0

    def counted(points: ComplexArray, pieces: hausdorff._Pieces) -> FloatArray:
        nonlocal most
        most = max(most, len(points))
        return plain(points, pieces)

    plain = hausdorff._distances
    monkeypatch.setattr(hausdorff, "_distances", counted)
    monkeypatch.setattr(hausdorff, "PAIRS", 4000)
    assert distance(one, other) == pytest.approx(bound, rel=SHARPNESS)
    assert most <= 4000
    monkeypatch.setattr(hausdorff, "MOST", 1)
    assert bound <= distance(one, other) * (1.0 + SHARPNESS) <= 2.0 * bound
