"""Extremes over smooth pieces and isolated roots, against closed forms."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from camgeo.dynamics.effects.lift_off.elastic_speed import ceiling
from camgeo.numeric.arrays import SIDES, FloatArray, IntArray, Side
from camgeo.numeric.extremes import (
    FEWEST_SAMPLES,
    INSET,
    INSIDE,
    MOST_POINTS,
    NEGLIGIBLE_CHANGE,
    SAMPLES,
    WIDEST,
    OfRows,
    dips,
    isolated_roots,
    isolation_cells,
    isolation_places,
    piecewise_extremes,
    piecewise_extremes_of_many,
    piecewise_highest,
    piecewise_lowest,
    sample_grid,
    stretch_around,
    stretch_below,
)
from camgeo.units import TURN
from tests.strategies import attack

EPS = float(np.finfo(np.float64).eps)

some = settings(deadline=None)


def cubic(a: float, b: float, x: FloatArray) -> FloatArray:
    """Integral of (x - a)(x - b)."""
    return ((x / 3.0 - 0.5 * (a + b)) * x + a * b) * x


@given(a=st.floats(-1.2, 1.2), b=st.floats(-1.2, 1.2), inner=st.lists(st.floats(-0.9, 0.9)))
@some
def test_a_cubic(a: float, b: float, inner: list[float]) -> None:
    """Turning points two steps of the coarsest grid apart are both found, wherever the cuts are."""
    assume(abs(a - b) > 2.0 * 2.0 / (SAMPLES - 1))
    edges = np.unique(np.array([-1.0, *inner, 1.0]))
    found = piecewise_extremes(lambda x, side: cubic(a, b, x), edges)
    places = np.array([-1.0, 1.0, *(each for each in (a, b) if -1.0 < each < 1.0)])
    values = cubic(a, b, places)
    # |x|, |a|, |b| up to 1.2: terms add up to 3, each with three roundings; in the flat top of a
    # search the values compared differ by no more.
    rounding = 4.0 * 3.0 * EPS
    assert found.highest.value == pytest.approx(np.max(values), rel=0.0, abs=rounding)
    assert found.lowest.value == pytest.approx(np.min(values), rel=0.0, abs=rounding)
    # f differs by `rounding` from a top with f'' = |a - b| within sqrt(2 rounding/|a - b|).
    flat = math.sqrt(4.0 * rounding / abs(a - b)) + 1e-8
    for extreme, best in ((found.highest, np.max(values)), (found.lowest, np.min(values))):
        near = places[np.abs(values - best) <= 2.0 * rounding]
        slope = np.abs((near - a) * (near - b))
        reach = np.where(slope > flat, 1e-15, 2.0 * flat)
        assert np.any(np.abs(near - extreme.place) <= reach)


@pytest.mark.parametrize("waves", [40.0, 150.0])
def test_ripples_finer_than_the_grid_are_found(waves: float) -> None:
    """On a wave whose top has no ripple's top on the grid: six and a fifth of its points a wave."""
    edges = np.array([0.0, 6.28])

    def rippled(x: FloatArray, side: Side) -> FloatArray:
        return np.cos(x) + 0.1 * np.sin(waves * x)

    found = piecewise_extremes(rippled, edges)
    dense = rippled(np.linspace(edges[0], edges[1], 1_000_001), "right")
    # Between two of these the ripple rises by at most 0.1 (waves 3.14e-6)^2 / 2.
    rise = 0.05 * (3.14e-6 * waves) ** 2
    assert np.max(dense) <= found.highest.value <= np.max(dense) + rise + 8.0 * EPS
    assert np.min(dense) >= found.lowest.value >= np.min(dense) - rise - 8.0 * EPS


def saw(x: FloatArray, side: Side) -> FloatArray:
    """Rises from 0 to 1 between integers, and falls there at once."""
    out = x - np.floor(x)
    if side == "left":
        out[x == np.floor(x)] = 1.0
    return out


def test_both_sides_of_a_jump_count() -> None:
    found = piecewise_extremes(saw, np.arange(5.0))
    assert (found.lowest.value, found.lowest.place) == (0.0, 0.0)
    assert (found.highest.value, found.highest.place) == (1.0, 1.0)
    turned = piecewise_extremes(lambda x, side: -saw(x, side), np.arange(5.0))
    assert (turned.highest.value, turned.highest.place) == (0.0, 0.0)
    assert (turned.lowest.value, turned.lowest.place) == (-1.0, 1.0)


def test_what_the_ends_have_on_their_outer_sides_does_not_count() -> None:
    def beyond(x: FloatArray, side: Side) -> FloatArray:
        out = np.cos(x)
        out[(x == 0.0) & (side == "left")] = 9.0
        out[(x == 1.0) & (side == "right")] = -9.0
        return out

    found = piecewise_extremes(beyond, np.array([0.0, 1.0]))
    assert (found.highest.value, found.highest.place) == (1.0, 0.0)
    assert (found.lowest.value, found.lowest.place) == (np.cos(1.0), 1.0)


def test_a_crest_at_the_very_end_of_a_piece() -> None:
    """Nearer than the grid keeps off: what is lost there is the square of that."""
    top = 1.0 - 0.5 * INSET
    found = piecewise_extremes(lambda x, side: -((x - top) ** 2), np.array([0.0, 1.0]))
    assert -(INSET**2) <= found.highest.value <= 0.0


@pytest.mark.parametrize("pieces", [1, 7, MOST_POINTS // SAMPLES + 100, MOST_POINTS // 4])
def test_the_grid(pieces: int) -> None:
    edges = np.linspace(0.0, 6.0, pieces + 1)
    grid = sample_grid(edges)
    assert len(grid) == pieces
    assert FEWEST_SAMPLES <= grid.shape[1] <= SAMPLES
    assert grid.size <= max(MOST_POINTS, FEWEST_SAMPLES * pieces)
    assert np.all(grid[:, 0] > edges[:-1])
    assert np.all(grid[:, -1] < edges[1:])
    assert np.all(np.diff(grid, axis=1) > 0.0)


def test_the_function_is_asked_for_arrays() -> None:
    """Few calls, however many pieces."""
    calls: list[int] = []

    def counted(x: FloatArray, side: Side) -> FloatArray:
        calls.append(len(x))
        return np.sin(x)

    piecewise_extremes(counted, np.linspace(0.0, 50.0, 101))
    few = len(calls)
    calls.clear()
    piecewise_extremes(counted, np.linspace(0.0, 50.0, 5))
    assert few == len(calls)


@given(
    sizes=st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=6),
    jump=st.floats(-1.0, 1.0),
    edge=st.floats(0.5, TURN - 0.5),
)
def test_one_of_both_alone(sizes: list[float], jump: float, edge: float) -> None:
    """Waves of several frequencies with a jump: the same value at the same place."""

    def waves(x: FloatArray, side: Side) -> FloatArray:
        later = x >= edge if side == "right" else x > edge
        total = np.where(later, jump, 0.0)
        for k, size in enumerate(sizes):
            total = total + size * np.sin((k + 1.0) * x + k)
        return total

    edges = np.array([0.0, edge, TURN])
    both = piecewise_extremes(waves, edges)
    assert piecewise_highest(waves, edges) == both.highest
    assert piecewise_lowest(waves, edges) == both.lowest


EDGES = np.linspace(0.0, TURN, 9)

NEAR = INSET * TURN / 8.0
"""A root this near an edge is not distinguished from it."""


@given(shift=st.floats(0.0, TURN), level=st.floats(-0.9, 0.9))
def test_a_wave_below_a_level(shift: float, level: float) -> None:
    """cos(phi - shift) < level from shift + acos(level) to shift - acos(level), once round."""
    lowest = (shift + math.pi) % TURN
    found = stretch_below(lambda phi: np.cos(phi - shift) - level, EDGES, lowest)
    assert found is not None
    for angle, expected in zip(
        found, (shift + math.acos(level), shift - math.acos(level)), strict=True
    ):
        assert abs((angle - expected + math.pi) % TURN - math.pi) <= NEAR


@pytest.mark.parametrize(
    ("function", "place", "expected"),
    [
        (lambda phi: np.cos(phi) - 2.0, math.pi, (0.0, TURN)),  # everywhere
        (lambda phi: np.cos(phi) + 2.0, math.pi, None),
        (lambda phi: 1.0 + np.cos(phi), math.pi, None),  # at one place alone
        # 0 over a piece, where the stretch ends
        (lambda phi: np.minimum(-np.sin(phi), 0.0), 0.5 * math.pi,
         pytest.approx((0.0, math.pi), abs=NEAR)),
    ],
)  # fmt: skip
def test_a_stretch_may_be_all_of_the_turn_or_nothing(
    function: Callable[[FloatArray], FloatArray], place: float, expected: object
) -> None:
    assert stretch_below(function, EDGES, place) == expected


@pytest.mark.parametrize(
    ("inside", "place", "expected"),
    [
        ([True, False, False, True], 0.0, (0.75 * TURN, 0.25 * TURN)),
        ([True, False, False, True], TURN, (0.75 * TURN, 0.25 * TURN)),
        ([False, True, True, False], 0.5 * TURN, (0.25 * TURN, 0.75 * TURN)),
        ([False, True, False, False], 0.5 * TURN, (0.25 * TURN, 0.5 * TURN)),
        ([False, False, False, True], 0.75 * TURN, (0.75 * TURN, 0.0)),
        ([False, True, False, False], 0.0, None),
    ],
)
def test_pieces_next_to_each_other(
    inside: list[bool], place: float, expected: tuple[float, float] | None
) -> None:
    assert stretch_around(np.linspace(0.0, TURN, 5), np.array(inside), place) == expected


def test_a_ceiling_counts_both_sides_of_a_jump() -> None:
    def jumping(x: FloatArray, side: Side) -> FloatArray:
        return np.where(x < 1.0 if side == "right" else x <= 1.0, x, 0.0)

    assert ceiling(jumping, np.array([0.0, 1.0, 2.0])) >= 1.0


class Waves:
    """Quantities that jump at the edges: several sines each, another offset on each piece."""

    def __init__(self, seed: int, count: int) -> None:
        source = np.random.default_rng(seed)
        self.count = count
        self.edges = np.concatenate(([0.0], np.sort(source.uniform(0.3, 6.0, 3)), [TURN]))
        self.sizes = source.uniform(-1.0, 1.0, (count, 3))
        self.phases = source.uniform(0.0, TURN, (count, 3))
        self.steps = np.round(source.uniform(-1.0, 1.0, (count, 4)), 1)

    def paired_values(self, _: None, x: FloatArray, side: Side, which: IntArray) -> FloatArray:
        piece = np.searchsorted(self.edges, x, side) - 1
        waves = self.sizes[which].T * np.sin(np.outer([1.0, 2.0, 3.0], x) + self.phases[which].T)
        return np.asarray(np.sum(waves, axis=0) + self.steps[which, np.clip(piece, 0, 3)])

    def everywhere(self, asked: None, x: FloatArray, side: Side) -> FloatArray:
        return np.stack(
            [self.paired_values(asked, x, side, np.full(len(x), k)) for k in range(self.count)]
        )

    def densely(self, number: int, steps: int = 3001) -> tuple[FloatArray, FloatArray]:
        """Places and values all over, each piece with both its ends."""
        x = [np.linspace(*each, steps) for each in zip(self.edges, self.edges[1:], strict=False)]
        own = np.full(steps, number)
        found = []
        for each in x:
            values = self.paired_values(None, each, "right", own)
            values[-1] = self.paired_values(None, each[-1:], "left", own[:1])[0]
            found.append(values)
        return np.concatenate(x), np.concatenate(found)


@given(seed=st.integers(0, 10**6))
@settings(deadline=None, max_examples=20)
def test_extremes_of_many_at_once_are_those_of_dense_samples(seed: int) -> None:
    waves = Waves(seed, 3)
    found = piecewise_extremes_of_many(waves, None, waves.edges)
    for number, each in enumerate(found):
        _, values = waves.densely(number)
        bend = 0.2 * 14.0 * (TURN / 3000) ** 2
        own = np.array([number])
        for extreme, best, sign in (
            (each.highest, np.max(values), 1.0), (each.lowest, np.min(values), -1.0)
        ):  # fmt: skip
            assert -1e-13 <= sign * (extreme.value - best) <= bend
            there = [
                waves.paired_values(None, np.array([extreme.place]), side, own)[0] for side in SIDES
            ]
            assert min(abs(value - extreme.value) for value in there) <= 1e-13
        assert each.magnitude == max(abs(each.lowest.value), abs(each.highest.value))
        assert ceiling(
            lambda phi, side: waves.paired_values(None, phi, side, np.full(len(phi), number)),  # noqa: B023 - called at once
            waves.edges,
        ) >= np.max(values)


@given(depth=st.floats(-1e-2, 1e-2), at=st.floats(0.3, 5.9), other=st.floats(0.5, 3.0))
@settings(deadline=None, max_examples=30)
def test_a_dip_between_points_of_one_sign_is_found(depth: float, at: float, other: float) -> None:
    """A parabola that dips below 0, narrower than the grid, and another quantity's sign."""
    grid = np.linspace(0.0, TURN, 25)[np.newaxis]
    for sign in (1.0, -1.0):
        found = dips(lambda phi: sign * (other * (phi - at) ** 2 - depth), grid)  # noqa: B023 - called at once
        wide = math.sqrt(max(depth, 0.0) / other)
        between = np.any((grid > at - wide) & (grid < at + wide))
        if depth > 0.0 and not between and wide > 1e-6:
            assert found == pytest.approx([at], abs=1e-6)
        elif depth < 0.0:
            assert len(found) == 0


def test_of_several_rows_each_dip_is_found_and_none_across_rows() -> None:
    grid = np.stack((np.linspace(0.0, 2.0, 9), np.linspace(2.0, 5.0, 9)))
    found = dips(lambda phi: 1.0 - np.cos(2.0 * (phi - 0.6)) - 1e-6, grid)
    assert found == pytest.approx([0.6, 0.6 + math.pi], abs=1e-3)
    assert len(dips(lambda phi: np.sin(phi - 2.1), grid)) == 0
    assert len(dips(lambda phi: np.abs(phi - 2.0) + 1e-9, grid)) == 0


@pytest.mark.parametrize("shift", [0.0, 0.1, 2.0, 3.0, 6.0])
@pytest.mark.parametrize("inner", [-0.5, 0.5])
def test_of_several_stretches_the_one_around_the_place_is_meant(shift: float, inner: float) -> None:
    """cos 2 (phi - shift) is below 0 twice a turn, below -0.5 twice too."""
    half = 0.5 * (math.pi - math.acos(inner))
    for bottom in (shift + 0.5 * math.pi, shift + 1.5 * math.pi):
        found = stretch_below(lambda phi: np.cos(2.0 * (phi - shift)) - inner, EDGES, bottom % TURN)
        assert found is not None
        for angle, wanted in zip(found, (bottom - half, bottom + half), strict=True):
            assert abs((angle - wanted + math.pi) % TURN - math.pi) <= NEAR


def test_crests_that_cannot_be_the_highest_cost_nothing() -> None:
    """Forty low crests beside a high one take hardly more values than the high one alone."""
    counts = []
    edges = np.linspace(0.0, TURN, 9)
    for ripple in (0.0, 0.05):
        asked: list[int] = []

        def function(phi: FloatArray, _: Side, ripple: float = ripple) -> FloatArray:
            asked.append(len(phi))  # noqa: B023 - called at once
            return np.asarray(np.cos(phi - 1.0) + ripple * np.cos(40.0 * (phi - 1.0)))

        found = piecewise_highest(function, edges)
        assert found.value == pytest.approx(1.0 + ripple, rel=1e-14)
        assert found.place == pytest.approx(1.0, abs=1e-7)
        counts.append(sum(asked))
    assert counts[1] < 2 * counts[0]


# Isolated roots against polynomials and waves whose roots are known ----------------------------


def roots_of(slopes: OfRows, values: OfRows, edges: FloatArray, rows: int = 1) -> FloatArray:
    """The roots of all rows, ascending."""
    places = isolation_places(edges)
    known = np.stack([slopes(places.ravel(), np.full(places.size, row)) for row in range(rows)])
    known = known.reshape(rows, *places.shape)
    roots, _ = isolated_roots(slopes, values, places, known)
    return np.sort(roots)


def test_cells_end_at_every_edge_and_are_not_wide() -> None:
    edges = np.array([0.0, 1e-7, 1.0, 1.0 + 0.5 * WIDEST, 6.0])
    low, high = isolation_cells(edges)
    assert low[0] == edges[0]
    assert high[-1] == edges[-1]
    assert np.array_equal(low[1:], high[:-1])
    assert set(edges) <= {*low, edges[-1]}
    assert np.max(high - low) <= WIDEST * (1.0 + 4.0 * EPS)


def test_places_stay_off_the_edges() -> None:
    edges = np.array([0.0, 0.05, 3.0])
    places = isolation_places(edges)
    assert places[0, 0] == INSIDE * 0.05
    assert places[-1, -1] == 3.0 - INSIDE * 2.95
    assert np.all(np.diff(places, axis=1) > 0.0)


@attack
@given(
    middle=st.floats(0.01, 0.09),
    apart=st.floats(1e-3, 0.03),
    tilt=st.floats(-3.0, 3.0),
    size=st.floats(1e-6, 1e6),
)
def test_two_near_roots_in_one_cell_are_both_found(
    middle: float, apart: float, tilt: float, size: float
) -> None:
    """Nearer to each other than the places, on a slope that is no polynomial."""
    first, second = middle - 0.5 * apart, middle + 0.5 * apart
    assume(first > 1e-3)
    assume(second < 0.097)

    def slope(x: FloatArray, _: IntArray) -> FloatArray:
        return size * (x - first) * (x - second) * np.exp(tilt * x)

    def value(x: FloatArray, _: IntArray) -> FloatArray:
        return size * (x**3 / 3.0 - middle * x**2)  # of the same order as its integral

    found = roots_of(slope, value, np.array([0.0, WIDEST]))
    assert found == pytest.approx([first, second], rel=1e-13)


@pytest.mark.parametrize("waves", [3.0, 170.0, 500.0])
def test_all_roots_of_a_fast_wave(waves: float) -> None:
    """Of the fastest one a cell has eight waves, and seven places."""
    found = roots_of(
        lambda x, _: np.cos(waves * x), lambda x, _: np.sin(waves * x), np.array([0.0, 2.0])
    )
    count = math.floor(2.0 * waves / math.pi + 0.5)
    expected = (np.arange(count) + 0.5) * math.pi / waves
    assert found == pytest.approx(expected, rel=1e-12)


@attack
@given(place=st.floats(0.3, 0.7), depth=st.floats(-12.0, -2.0))
def test_what_is_missed_changes_no_value_by_what_matters(place: float, depth: float) -> None:
    """A slope that dips below 0 by 10^depth, however little: or the dip is negligible."""
    dip, end = 10.0**depth, 1.0

    def slope(x: FloatArray, _: IntArray) -> FloatArray:
        return np.asarray((x - place) ** 2 - dip)

    def value(x: FloatArray, _: IntArray) -> FloatArray:
        return np.asarray((x - place) ** 3 / 3.0 - dip * (x - place) + end)

    found = roots_of(slope, value, np.array([0.0, 1.0]))
    falls = 4.0 / 3.0 * dip**1.5  # between both roots
    if len(found) == 2:
        half = math.sqrt(dip)
        assert found == pytest.approx([place - half, place + half], abs=4.0 * EPS / half)
    else:
        assert not len(found)
        assert falls <= NEGLIGIBLE_CHANGE * end


def test_rounding_ends_the_halving() -> None:
    """Slopes that are all rounding: cells are halved a few times, not down to points."""
    asked: list[int] = []
    noise = np.random.default_rng(1)

    def slope(x: FloatArray, _: IntArray) -> FloatArray:
        asked.append(len(x))
        return np.asarray(1e-3 * noise.standard_normal(len(x)))

    def value(x: FloatArray, _: IntArray) -> FloatArray:
        return np.asarray(1.0 + 1e-9 * noise.standard_normal(len(x)))

    places = isolation_places(np.array([0.0, 6.0]))
    roots_of(slope, value, np.array([0.0, 6.0]))
    assert max(asked) < 50 * places.size


def test_rows_are_what_they_are_alone_and_zeros_have_no_root() -> None:
    phases = np.array([0.1, 0.7, 0.0])

    def slope(x: FloatArray, row: IntArray) -> FloatArray:
        return np.asarray(np.where(row == 2, 0.0, np.cos(9.0 * x + phases[row])))

    def value(x: FloatArray, row: IntArray) -> FloatArray:
        return np.asarray(np.sin(9.0 * x + phases[row]))

    edges = np.array([0.0, 1.0, 4.0])
    places = isolation_places(edges)
    known = np.stack(
        [slope(places.ravel(), np.full(places.size, k)).reshape(places.shape) for k in range(3)]
    )
    roots, rows = isolated_roots(slope, value, places, known)
    assert not np.any(rows == 2)
    for one in range(2):

        def own(function: OfRows, row: int = one) -> OfRows:
            return lambda x, _: function(x, np.full(len(x), row))

        alone, _ = isolated_roots(own(slope), own(value), places, known[one : one + 1])
        assert np.array_equal(np.sort(roots[rows == one]), np.sort(alone))
