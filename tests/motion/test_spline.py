"""Splines through points and near them.

The nodal values of all kinds are compared with the same energy minimised in eighty digits.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise, product

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from camgeo.errors import GeometryError
from camgeo.kinematics.motion import Boundary
from camgeo.kinematics.splines import (
    DEGREE,
    MOST_UNEQUAL,
    NEAR_ENOUGH,
    FitReport,
    Smoothing,
    Spline,
    from_stress,
)
from camgeo.numeric.arrays import BoolArray, FloatArray
from camgeo.units import TURN
from tests.long_form import examples
from tests.strategies import attack

EPS = 2.0**-52

ORDERS = range(DEGREE + 1)

CONDITION = 1e5
"""What rounding is multiplied with for distances of 0.2 to 1: the solve by less than 1e3 (its
balanced matrix), the third to fifth differences of its nodal values by less than 100."""


@dataclass(frozen=True)
class Points:
    """x ascending with distances 0.2 to 1, y in [-10, 10], and a last distance to the period."""

    x: FloatArray
    y: FloatArray
    last: float

    @property
    def period(self) -> float:
        return float(self.x[-1] - self.x[0]) + self.last


@st.composite
def points(draw: st.DrawFn, least: int = 4, most: int = 24) -> Points:
    count = draw(st.integers(least, most))
    steps = draw(st.lists(st.floats(0.2, 1.0), min_size=count, max_size=count))
    start = draw(st.floats(-5.0, 5.0))
    heights = draw(st.lists(st.floats(-10.0, 10.0), min_size=count, max_size=count))
    x = start + np.concatenate(([0.0], np.cumsum(steps[:-1])))
    return Points(x, np.array(heights), steps[-1])


def boundaries() -> st.SearchStrategy[Boundary]:
    value = st.one_of(st.none(), st.floats(-20.0, 20.0))
    return st.tuples(value, value)


def sizes(spline: Spline) -> FloatArray:
    """(6,) the largest sum of the terms of each derivative at the end of a piece."""
    found = []
    step = np.diff(spline.knots)
    for order in ORDERS:
        factors = np.array([np.prod(np.arange(k - order + 1, k + 1)) for k in range(6)])
        factors[:order] = 0.0
        found.append(float(np.max(np.abs(spline.taylor) @ factors / step**order)))
    return np.array(found)


def reach(spline: Spline) -> FloatArray:
    """(6,) `sizes`, and what values of that size could have over the shortest piece."""
    shortest = float(np.min(np.diff(spline.knots)))
    return np.asarray(sizes(spline) + sizes(spline)[0] / shortest ** np.arange(6.0))


def jumps(spline: Spline) -> FloatArray:
    """(6, m - 1) jumps of each derivative at the inner knots, as a share of `reach`."""
    inner = spline.knots[1:-1]
    difference = spline.values(inner, 5, "right") - spline.values(inner, 5, "left")
    return np.asarray(np.abs(difference) / np.maximum(reach(spline), 1e-300)[:, np.newaxis])


SEEN = 1e-3
"""A jump of this share is one."""


# Evaluation -----------------------------------------------------------------------------------


@attack
@given(points(), st.lists(st.floats(0.0, 1.0), min_size=1, max_size=20))
def test_all_derivatives_are_those_of_the_pieces(data: Points, shares: list[float]) -> None:
    spline = Spline.clamped(data.x, data.y)
    x = data.x[0] + np.array(shares) * (data.x[-1] - data.x[0])
    found = spline.values(x, DEGREE)
    for number, place in enumerate(x):
        piece = min(int(np.searchsorted(data.x, place, "right")) - 1, len(data.x) - 2)
        h = data.x[piece + 1] - data.x[piece]
        local = Polynomial(spline.taylor[piece])
        for order in ORDERS:
            expected = local.deriv(order)((place - data.x[piece]) / h) / h**order
            # Twelve roundings of each scheme, and that of the place, with the next derivative.
            allowed = 32.0 * EPS * sizes(spline)[order:].max()
            assert found[order, number] == pytest.approx(expected, abs=allowed)


@attack
@given(points(), st.integers(-3, 3), st.floats(-2.0, 2.0), st.floats(0.0, 1.0))
def test_periods_and_rise(data: Points, turns: int, rise: float, share: float) -> None:
    spline = Spline.closed(data.x, data.y, data.period, rise)
    x = np.array([data.x[0] + share * data.period])
    here, there = spline.values(x, 4), spline.values(x + turns * data.period, 4)
    here[0] += turns * rise
    # x + turns * period is rounded at up to 100; each derivative changes by the next one.
    slope = sizes(spline)[1:]
    assert np.all(np.abs(here - there)[:, 0] <= 512.0 * EPS * (slope + sizes(spline)[:5]) + 1e-14)


def even(count: int) -> FloatArray:
    """`count` angles over a turn."""
    return np.asarray(2.0 * np.pi * np.arange(count) / count, dtype=np.float64)


def test_a_side_of_a_knot_can_be_chosen() -> None:
    spline = Spline(np.array([0.0, 1.0, 3.0]), np.array([[0.0, 1, 0, 0, 0, 0], [1, 4, 0, 0, 0, 0]]))
    knot = np.array([1.0])
    assert spline.values(knot, 1).ravel().tolist() == [1.0, 2.0]
    assert spline.values(knot, 1, "left").ravel().tolist() == [1.0, 1.0]
    assert spline.values(np.array([0.0]), 1, "left").ravel().tolist() == [0.0, 1.0]
    assert spline.values(np.array([3.0]), 1, "right").ravel().tolist() == [5.0, 2.0]
    ring = Spline(spline.knots, spline.taylor, periodic=True, rise=5.0)
    assert ring.values(np.array([3.0]), 1).ravel().tolist() == [5.0, 1.0]
    assert ring.values(np.array([0.0]), 1, "left").ravel().tolist() == [0.0, 2.0]


def test_outside_and_no_numbers_are_refused() -> None:
    spline = Spline.clamped(np.arange(4.0), np.arange(4.0) ** 2)
    for wrong in (-0.001, 3.001, np.nan, np.inf):
        with pytest.raises(GeometryError):
            spline.values(np.array([1.0, wrong]))


@attack
@given(points(), boundaries(), boundaries())
def test_extremes_are_taken_and_not_passed(data: Points, start: Boundary, end: Boundary) -> None:
    spline = Spline.clamped(data.x, data.y, start, end)
    values = spline.values(np.linspace(data.x[0], data.x[-1], 4001), DEGREE)
    for order in ORDERS:
        found = spline.extremes(order)
        allowed = 64.0 * EPS * sizes(spline)[order:].max()
        assert found.lowest.value <= np.min(values[order]) + allowed
        assert found.highest.value >= np.max(values[order]) - allowed
        for extreme in (found.lowest, found.highest):
            place = np.array([extreme.place])
            both = [spline.values(place, order, side)[order, 0] for side in ("right", "left")]
            assert np.min(np.abs(np.array(both) - extreme.value)) <= allowed


@attack
@given(points(), boundaries())
def test_how_far_it_goes_beyond_neighbouring_points(data: Points, start: Boundary) -> None:
    """Against dense samples of each piece, above both its ends or below them."""
    spline = Spline.clamped(data.x, data.y, start)
    found = spline.beyond_knots()
    most = 0.0
    for low, high in pairwise(spline.knots):
        values = spline.values(np.linspace(low, high, 401), 0)[0]
        ends = sorted((values[0], values[-1]))
        most = max(float(np.max(values) - ends[1]), float(ends[0] - np.min(values)), most)
    bend = sizes(spline)[2] * float(np.max(np.diff(spline.knots)) / 400) ** 2
    assert abs(found.value) == pytest.approx(most, abs=bend + 1e-12)
    if most > 2.0 * bend + 1e-6:
        there = float(spline.values(np.array([found.place]), 0)[0, 0])
        piece = int(np.clip(np.searchsorted(spline.knots, found.place) - 1, 0, len(data.x) - 2))
        ends = sorted(data.y[piece : piece + 2])
        beyond = there - ends[1] if found.value > 0.0 else there - ends[0]
        assert beyond == pytest.approx(found.value, abs=1e-9 * sizes(spline)[0])


def test_what_stays_between_its_points_goes_beyond_none() -> None:
    spline = Spline.clamped(np.array([1.0, 2.0]), np.array([0.0, 1.0]), (0.0, 0.0), (0.0, 0.0))
    assert spline.beyond_knots().value == 0.0


@attack
@given(points())
def test_bounds_hold_and_are_exact_for_the_last_orders(data: Points) -> None:
    spline = Spline.closed(data.x, data.y, data.period)
    share = np.linspace(0.0, 1.0, 41)
    grid = spline.knots[:-1, np.newaxis] + np.diff(spline.knots)[:, np.newaxis] * share[1:-1]
    values = np.abs(spline.values(grid.ravel(), DEGREE)).reshape(6, *grid.shape)
    for order in ORDERS:
        allowed = 64.0 * EPS * sizes(spline)[order]
        assert np.all(spline.bounds(order)[:, np.newaxis] >= values[order] - allowed)
    ends = np.maximum(
        np.abs(spline.values(spline.knots[:-1], 4)[4]),
        np.abs(spline.values(spline.knots[1:], 4, "left")[4]),
    )
    np.testing.assert_allclose(spline.bounds(4), ends, atol=64.0 * EPS * sizes(spline)[4])


@attack
@given(points(), st.floats(0.0, 0.5), st.floats(0.5, 1.0))
def test_cell_bounds_hold(data: Points, low: float, high: float) -> None:
    spline = Spline.closed(data.x, data.y, data.period)
    left, step = spline.knots[:-1], np.diff(spline.knots)
    bounds = spline.cell_bounds(left + low * step, left + high * step)
    for share in np.linspace(low, high, 17)[1:-1]:
        values = spline.values(left + share * step)
        values[0] -= spline.values(left + 0.5 * (low + high) * step)[0]
        allowed = 64.0 * EPS * sizes(spline)[:4, np.newaxis]
        assert np.all(np.abs(values) <= bounds + allowed)


@attack
@given(points(), st.floats(-20.0, 20.0))
def test_the_inverse_of_an_ascending_spline(data: Points, y: float) -> None:
    # Heights within 1/40 of a straight line keep the spline's slope above 0.
    x = data.x
    heights = x - x[0] + data.y / 2000.0
    spline = Spline.closed(x, heights, data.period, rise=data.period)
    assert spline.extremes(1).lowest.value > 0.0
    back = spline.values(spline.inverse(np.array([y])), 0)[0, 0]
    assert back == pytest.approx(y, abs=256.0 * EPS * 30.0)


def test_evaluation_needs_no_scipy() -> None:
    program = (
        "import sys, numpy as np\n"
        "from camgeo.kinematics.splines import Spline\n"
        "s = Spline(np.array([0.0, 1.0]), np.ones((1, 6)))\n"
        "s.values(np.array([0.5])), s.extremes(0), s.bounds(2), s.inverse(np.array([1.5]))\n"
        "sys.exit('scipy' in sys.modules)\n"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


# Interpolation --------------------------------------------------------------------------------


@attack
@given(points())
def test_a_periodic_spline_keeps_its_points_and_four_derivatives(data: Points) -> None:
    spline = Spline.closed(data.x, data.y, data.period)
    assert spline.values(data.x, 0)[0].tolist() == data.y.tolist()
    assert np.max(jumps(spline)[:5]) <= CONDITION * EPS
    seam = np.array([data.x[0]])
    difference = spline.values(seam, 4) - spline.values(seam, 4, "left")
    assert np.all(np.abs(difference[:, 0]) <= CONDITION * EPS * reach(spline)[:5])


@attack
@given(points(), boundaries(), boundaries())
def test_a_clamped_spline_has_its_end_values_and_four_derivatives(
    data: Points, start: Boundary, end: Boundary
) -> None:
    spline = Spline.clamped(data.x, data.y, start, end)
    assert spline.values(data.x[:-1], 0)[0].tolist() == data.y[:-1].tolist()
    assert np.max(jumps(spline)[:5]) <= CONDITION * EPS
    at_start = spline.values(data.x[:1], 4)[:, 0]
    at_end = spline.values(data.x[-1:], 4)[:, 0]
    size = CONDITION * EPS * reach(spline)
    assert at_end[0] == pytest.approx(data.y[-1], abs=size[0])
    for values, (velocity, acceleration) in ((at_start, start), (at_end, end)):
        if velocity is None:
            assert abs(values[4]) <= size[4]
        else:
            assert values[1] == pytest.approx(velocity, abs=size[1])
        if acceleration is None:
            assert abs(values[3]) <= size[3]
        else:
            assert values[2] == pytest.approx(acceleration, abs=size[2])


@pytest.mark.parametrize(
    ("prescribed", "smooth", "jumping"),
    [
        ((None, None), (0, 1, 2, 3, 4), ()),
        ((1.0, None), (0, 1, 2, 3), (4,)),
        ((None, 1.0), (0, 1, 2, 4), (3,)),
        ((1.0, 1.0), (0, 1, 2), (3, 4)),
    ],
)
def test_what_gives_way_at_a_prescribed_inner_point(
    prescribed: Boundary, smooth: tuple[int, ...], jumping: tuple[int, ...]
) -> None:
    x = np.array([0.0, 0.7, 1.5, 2.0, 2.9, 3.6])
    y = np.array([0.0, 1.0, 3.0, 2.0, 2.5, 0.0])
    spline = Spline.clamped(x, y, (0.0, 0.0), (0.0, 0.0), {2: prescribed})
    found = jumps(spline)
    place = 1  # of the inner knots
    for order in smooth:
        assert found[order, place] <= CONDITION * EPS
    for order in jumping:
        assert found[order, place] > SEEN
    assert np.max(np.delete(found[:5], place, axis=1)) <= CONDITION * EPS
    values = spline.values(x[2:3])[:, 0]
    for order, value in zip((1, 2), prescribed, strict=True):
        if value is not None:
            assert values[order] == pytest.approx(value, abs=CONDITION * EPS * sizes(spline)[order])


@attack
@given(points(), st.integers(-20, 20), st.integers(-20, 20))
def test_scaling_by_powers_of_two_changes_no_digit(data: Points, along: int, up: int) -> None:
    a, b = 2.0**along, 2.0**up
    plain = Spline.closed(data.x, data.y, data.period)
    scaled = Spline.closed(a * data.x, b * data.y, a * data.period)
    assert scaled.taylor.tolist() == (b * plain.taylor).tolist()
    assert scaled.knots.tolist() == (a * plain.knots).tolist()


@pytest.mark.parametrize("span", [1e-29, 1e29])
def test_the_largest_values_that_are_allowed(span: float) -> None:
    x, y = span * np.arange(9.0) / 8.0, 1e100 * np.cos(np.arange(9.0))
    assert np.all(np.isfinite(Spline.clamped(x, y).values(x, DEGREE)))
    smooth, fit = Spline.smooth_clamped(x, y, largest_deviation=1e98)
    assert np.all(np.isfinite(smooth.values(x, DEGREE)))
    assert 0.0 < fit.largest_deviation <= 1e98


def test_two_points_and_one_condition_are_enough() -> None:
    # The smoothest through (0, 0) and (2, 1) with s'(0) = 2: the parabola, s''' = 0.
    spline = Spline.clamped(np.array([0.0, 2.0]), np.array([0.0, 1.0]), (2.0, None))
    expected = Polynomial([0.0, 2.0, -0.75])
    x = np.linspace(0.0, 2.0, 9)
    np.testing.assert_allclose(spline.values(x, 0)[0], expected(x), atol=64 * EPS)


def test_a_hundred_thousand_points() -> None:
    x = even(100_000)
    spline = Spline.closed(x, np.sin(x), 2.0 * np.pi)
    places = np.linspace(0.0, 6.0, 1000)
    found = spline.values(places, 2)
    # Rounding of sin, divided by h, and by h twice, and a factor of 8 for the sums.
    h = x[1]
    assert np.max(np.abs(found[0] - np.sin(places))) <= 16 * EPS
    assert np.max(np.abs(found[1] - np.cos(places))) <= 16 * EPS / h
    assert np.max(np.abs(found[2] + np.sin(places))) <= 64 * EPS / h**2


# The same energy in eighty digits -------------------------------------------------------------


def exact_nodes(x: FloatArray, nodes: FloatArray, fixed: BoolArray, weight: object) -> FloatArray:
    """(n, 3) y, s', s'' of least sum (s - y)^2 + weight * integral of s'''^2.

    The energy of a quintic in its powers, its matrix of integrals of products, all dense.
    """
    count = len(x)
    matrix, right = mpmath.matrix(3 * count, 3 * count), mpmath.matrix(3 * count, 1)
    half = mpmath.mpf(1) / 2
    powers = mpmath.matrix(
        [
            [-10, -6, -3 * half, 10, -4, half],
            [15, 8, 3 * half, -15, 7, -1],
            [-6, -3, -half, 6, -3, half],
        ]
    )
    gram = mpmath.matrix([[36, 72, 120], [72, 192, 360], [120, 360, 720]])
    for piece in range(count - 1):
        h = mpmath.mpf(x[piece + 1]) - mpmath.mpf(x[piece])
        unit = mpmath.diag([1, h, h * h, 1, h, h * h])
        energy = unit * powers.T * gram * powers * unit * (weight / h**5)
        for i in range(6):
            for j in range(6):
                matrix[3 * piece + i, 3 * piece + j] += energy[i, j]
    for node in range(count):
        matrix[3 * node, 3 * node] += 1
        right[3 * node] += mpmath.mpf(nodes[node, 0])
    for row in np.flatnonzero(fixed):
        for column in range(3 * count):
            matrix[int(row), column] = int(row) == column
        right[int(row)] = mpmath.mpf(nodes.ravel()[row])
    solution = mpmath.lu_solve(matrix, right)
    return np.array([float(value) for value in solution]).reshape(count, 3)


def spaced(kind: str, ratio: float) -> FloatArray:
    """Nine points on [0, 1] whose distances have this ratio."""
    steps = {
        "alternating": np.where(np.arange(8) % 2, 1.0, 1.0 / ratio),
        "growing": np.geomspace(1.0 / ratio, 1.0, 8),
        "one pair": np.where(np.arange(8) == 4, 1.0 / ratio, 1.0),
    }[kind]
    x = np.concatenate(([0.0], np.cumsum(steps)))
    return np.asarray(x / x[-1])


SLACK = 1.0 - 1e-5
"""The ratio of rounded sums stays below the allowed one."""


def smoothed(
    knots: FloatArray, nodes: FloatArray, fixed: BoolArray, length: float, *, ring: bool = False
) -> Spline:
    """The smoothing spline of a cut-off length."""
    step = np.diff(knots)
    found, stress = Smoothing(step, nodes, fixed, ring).solve(length)
    return Spline(knots, from_stress(step, found[: len(step)], stress), ring)


def smoothed_ring(x: FloatArray, y: FloatArray, length: float) -> Spline:
    """The same over a turn, with nothing prescribed."""
    nodes = np.stack((y, np.zeros_like(y), np.zeros_like(y)), axis=1)
    return smoothed(np.append(x, TURN), nodes, np.zeros(nodes.shape, np.bool_), length, ring=True)


@pytest.mark.parametrize("kind", ["alternating", "growing", "one pair"])
@pytest.mark.parametrize(
    ("ratio", "share"),
    [
        *product((1.0, MOST_UNEQUAL * SLACK), (None, 0.001, 5.0)),
        (1e3, None),
        # Between the ends of both ranges nothing else happens.
        *(
            pytest.param(ratio, share, marks=pytest.mark.long)
            for ratio, share in product((1.0, 1e3, MOST_UNEQUAL * SLACK), (0.001, 0.1, 1.0, 5.0))
            if ratio == 1e3 or share in (0.1, 1.0)
        ),
    ],
)
def test_nodes_against_eighty_digits(kind: str, ratio: float, share: float | None) -> None:
    """Of the interpolant, and of what is smoothed over a `share` of the mean distance."""
    x = spaced(kind, ratio)
    nodes = np.zeros((9, 3))
    nodes[:, 0] = np.sin(3.0 * x) + 0.1 * np.cos(5.0 * np.arange(9))
    fixed = np.zeros((9, 3), dtype=np.bool_)
    fixed[[0, -1]] = True
    fixed[:, 0] |= share is None
    mean = 1.0 / 8.0
    with mpmath.workdps(80):
        weight = mpmath.mpf((share or 1.0) * mean) ** 6 / mpmath.mpf(mean)
        expected = exact_nodes(x, nodes, fixed, weight)
    if share is None:
        found = Spline.clamped(x, nodes[:, 0], (0.0, 0.0), (0.0, 0.0)).values(x, 2).T
    else:
        found = smoothed(x, nodes, fixed, share * mean).values(x, 2).T
    for order in range(3):
        size = np.max(np.abs(expected[:, order]))
        # Distances are differences of rounded x: of 1e-7 to nine digits, in both calculations
        # alike. Smoothed, even points: rounding times the condition of a least squares problem,
        # 5^3 for a length of five distances, and a few. Else what the constant of the ratio
        # promises, eight digits.
        allowed = 1e-12 if share is None else 400.0 * EPS if ratio == 1.0 else 1e-8
        np.testing.assert_allclose(
            found[:-1, order], expected[:-1, order], rtol=0.0, atol=allowed * size
        )


# Smoothing ------------------------------------------------------------------------------------


@attack
@given(points(least=5), st.floats(-6.0, 1.0), st.booleans())
def test_the_allowed_deviation_is_kept(data: Points, exponent: float, ring: bool) -> None:
    allowed = 10.0**exponent
    if ring:
        spline, fit = Spline.smooth_closed(data.x, data.y, data.period, largest_deviation=allowed)
    else:
        spline, fit = Spline.smooth_clamped(
            data.x, data.y, (0.0, 0.0), (0.0, 0.0), largest_deviation=allowed
        )
    deviation = np.abs(spline.values(data.x, 0)[0] - data.y)
    rounding = CONDITION * EPS * sizes(spline)[0]
    assert np.max(deviation) <= allowed + rounding
    assert fit.largest_deviation <= allowed
    assert fit.largest_deviation == pytest.approx(np.max(deviation), abs=rounding)
    assert fit.rms == pytest.approx(np.sqrt(np.mean(deviation**2)), abs=rounding)
    assert fit.place in data.x
    assert np.max(jumps(spline)[:5]) <= CONDITION * EPS


def test_the_allowed_deviation_is_used() -> None:
    x = np.linspace(0.0, 1.0, 101)
    y = np.sin(9.0 * x) + 0.01 * np.cos(500.0 * x)
    for allowed in (1e-4, 1e-2, 1e-1):
        _, fit = Spline.smooth_clamped(x, y, largest_deviation=allowed)
        assert NEAR_ENOUGH * allowed <= fit.largest_deviation <= allowed


@pytest.mark.parametrize("waves", [1, 2, 3])
@pytest.mark.parametrize("length", [0.1, 1.0 / 3.0, 1.0])
def test_a_wave_keeps_the_share_that_follows_from_its_length(waves: int, length: float) -> None:
    x = even(1000)
    spline = smoothed_ring(x, np.cos(waves * x), length)
    share = 1.0 / (1.0 + (length * waves) ** 6)
    found = spline.values(x)
    # Sums instead of integrals: (angle of a step)^6, 5e-11 at most; rounding times 160^3.
    for order in range(4):
        expected = share * waves**order * np.cos(waves * x + order * np.pi / 2.0)
        # The third derivative of a quintic's pieces is off by the third power of the step.
        allowed = 1e-8 if order < 3 else 1e-4
        np.testing.assert_allclose(found[order], expected, rtol=0.0, atol=allowed * waves**order)


def test_smoothing_keeps_the_ends() -> None:
    x = np.linspace(0.0, 1.0, 30)
    y = x + 0.1 * np.sin(50.0 * x)
    spline, fit = Spline.smooth_clamped(x, y, (0.0, 0.0), (1.0, 2.0), largest_deviation=0.1)
    start, end = spline.values(x[:1])[:, 0], spline.values(x[-1:])[:, 0]
    assert start[:3].tolist() == [y[0], 0.0, 0.0]
    np.testing.assert_allclose(end[:3], [y[-1], 1.0, 2.0], atol=1e-10)
    assert fit.largest_deviation > 0.05


def test_the_weight_of_many_noisy_points_is_found() -> None:
    """By tens of splines."""
    x = even(examples(4_000, long=100_000))
    y = 10.0 * np.sin(x) + np.random.default_rng(1).uniform(-0.01, 0.01, len(x))
    spline = smoothed_ring(x, y, 0.1)
    again, fit = Spline.smooth_closed(
        x, y, 2.0 * np.pi, FitReport.from_points(spline, x, y).largest_deviation
    )
    assert FitReport.from_points(again, x, y).largest_deviation == pytest.approx(
        fit.largest_deviation, abs=1e-12
    )


# Refusals -------------------------------------------------------------------------------------

GOOD = np.array([0.0, 1.0, 2.0, 3.0])

SEAM = np.array([0.0, 1.0, 2.0, 0.0])


@pytest.mark.parametrize(
    ("x", "y", "message"),
    [
        ([0.0], [1.0], "1 point is too few; allowed: at least 2"),
        ([0.0, 1.0], [1.0, 2.0], "too few; allowed: at least 3"),
        ([0.0, 1.0, 1.0], [1.0, 2.0, 3.0], r"points 2 and 3 are equal \(1.0, 1.0\)"),
        ([0.0, 2.0, 1.0], [1.0, 2.0, 3.0], "points 2 and 3 are descending"),
        ([0.0, 1.0, np.inf], [1.0, 2.0, 3.0], "finite numbers, .* number 3 of them is not"),
        ([0.0, 1.0, 2.0], [1.0, np.nan, 3.0], "finite numbers, .* number 2 of them is not"),
        ([0.0, 1.0, 2.0], [1.0, 2.0], "has 2 numbers, x has 3"),
        ([0.0, 1e-31, 2e-31], [1.0, 2.0, 3.0], "at least 1e-30"),
        ([0.0, 1.0, 2.0], [1.0, 2.0, 1e101], r"at most 1e\+100 in magnitude; number 3"),
        ([0.0, 1e-7, 1.0], [1.0, 2.0, 3.0], r"too unequally.*allowed: up to 1e\+06"),
    ],
)
def test_poor_points_are_refused(x: list[float], y: list[float], message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        Spline.clamped(np.array(x), np.array(y))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Spline.closed(GOOD, SEAM + 5.0 * (GOOD == 3.0), 3.0), "lies 5 away .*: up to 0"),
        (lambda: Spline.closed(GOOD, SEAM, 2.9), "span 3.0; allowed: up to the period 2.9"),
        (lambda: Spline.closed(GOOD, SEAM, 0.0), "must be a number above 0"),
        (lambda: Spline.closed(GOOD, SEAM, np.nan), "must be a number above 0"),
        (lambda: Spline.closed(GOOD, SEAM, 3.0 + 1e-7), "too unequally"),
        *(
            (
                partial(Spline.smooth_clamped, GOOD, GOOD**3, largest_deviation=each),
                "must be (a number above 0|at most)",
            )
            for each in (0.0, -1.0, np.nan, np.inf, 1e101)
        ),
        *(
            (partial(Spline.clamped, GOOD, GOOD, inner={each: (0.0, None)}), "number from 1 to 2")
            for each in (0, 3, -1, 7)
        ),
        (lambda: Spline.clamped(GOOD, GOOD, inner={1: (np.nan, None)}), "must be a finite number"),
        (lambda: Spline.clamped(GOOD, SEAM).inverse(np.array([0.5])), "ascend"),
    ],
)
def test_what_makes_no_spline_is_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        call()


def test_a_gap_at_the_seam_is_allowed_up_to_the_stated_limit() -> None:
    y = np.array([0.0, 1.0, 2.0, 0.01])
    assert Spline.closed(GOOD, y, 3.0, gap=0.01).values(np.array([3.0]), 0)[0, 0] == 0.0
    with pytest.raises(GeometryError, match=r"0\.01 away"):
        Spline.closed(GOOD, y, 3.0, gap=0.0099)


@pytest.mark.parametrize(
    ("knots", "taylor"),
    [
        ([0.0], np.zeros((0, 6))),
        ([0.0, 1.0], np.zeros((1, 4))),
        ([0.0, 0.0], np.zeros((1, 6))),
        ([0.0, np.nan], np.zeros((1, 6))),
        ([0.0, 1.0], np.full((1, 6), np.inf)),
    ],
)
def test_a_spline_of_nonsense_is_refused(knots: list[float], taylor: FloatArray) -> None:
    with pytest.raises(GeometryError):
        Spline(np.array(knots), taylor)
