"""Outlines that are exactly lines and arcs: their chords, their parallels, and the distance of two
contours, which is a sharp bound of Hausdorff's: compared with dense sampling and closed forms.

That parallels are those of shapely is in tests/printing/test_printing.py."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError, ToleranceError
from camgeo.geometry.contour import exact as exact_module
from camgeo.geometry.contour.contour import Contour, Fit
from camgeo.geometry.contour.exact import ROUNDING, SHARPNESS, deviation_bound, distance
from camgeo.geometry.contour.parallel import corners, count_steps, parallel
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.part.assembly import bore_outline, flattened
from camgeo.part.boundaries import chord_fit, corner_radius, fewest_chord_fit, matching_chords
from camgeo.part.spec import DShaft, Keyway
from tests.contour.cams import outline
from tests.long_form import examples
from tests.strategies import attack

some = settings(max_examples=examples(12, long=40), deadline=None)


few = settings(max_examples=examples(7, long=15), deadline=None)
"""For what is measured at every size of tolerance, down to thousands of chords."""


RADIUS = 8.0


PLAIN = Contour.circle(RADIUS)


SLOTTED = bore_outline(2.0 * RADIUS, Keyway(5.0, 2.3, 0.4))


outlines = st.sampled_from([PLAIN, SLOTTED])


NOTHING = 3.0 * ROUNDING * 11.0 + 1e-14
"""No distance [mm]: the allowance for rounding, and rounding itself, 5 ulp of 11 mm."""


def _measured(exact: Contour, contour: Contour, count: int = 3_000) -> float:
    """Largest distance by dense sampling with exact distances: from below, never too large."""
    a, b = outline(exact), outline(contour)
    return max(
        float(np.max(a.distances(b.dense(count)))), float(np.max(b.distances(a.dense(count))))
    )


@few
@given(outlines, st.floats(-6.0, 0.0))
def test_chords_keep_their_tolerance(exact: Contour, size: float) -> None:
    tolerance = 10.0**size
    # With vertices on the arc, points between the samples lie (1/5)^2 of a sagitta further at 5
    # points a chord; those of the fewest are as far off as the chords, and among the samples.
    for fitter, slack in ((chord_fit, 0.04), (fewest_chord_fit, 1e-9)):
        fit = fitter(exact, tolerance)
        chords = fit.contour
        assert chords.arc_count == 0
        found = _measured(exact, chords)
        most = (1.0 + slack) * found + 2.0 * NOTHING
        assert found <= fit.deviation <= most
        assert found <= tolerance * (1.0 + 1e-9) + 1e-14
        assert deviation_bound(exact, chords) <= most
        assert deviation_bound(exact, chords.reversed()) >= found - 1e-14
    assert len(chords) <= len(chord_fit(exact, tolerance).contour)
    if exact is SLOTTED:
        assert all(np.any(chords.vertices == corner) for corner in exact.vertices)


def test_chords_are_few() -> None:
    # Sagitta 0.001 on 8 mm: step 2 arccos(1 - 0.001/8) = 0.031624 rad, 100 to each half.
    assert len(chord_fit(PLAIN, 0.001).contour) == 2 * 100


@pytest.mark.parametrize("exact", [PLAIN, SLOTTED])
def test_itself_is_no_distance(exact: Contour) -> None:
    for same in (exact, exact.reversed(), exact.split(1.0), exact.split(0.01).reversed()):
        assert deviation_bound(exact, same) < NOTHING


STEPS = (1e-12, 1e-9, 1e-6, 1e-3)


@some
@given(outlines, st.integers(0, 10**6), st.sampled_from(STEPS), st.floats(0.0, 6.3),
       st.just(-20.0) | st.floats(-4.0, -0.5))  # fmt: skip
def test_the_distance_is_a_continuous_function(
    exact: Contour, index: int, step: float, angle: float, size: float
) -> None:
    """However far off the contour already is, all of its arcs, of up to half a turn, moved: an arc
    whose end passes a corner is off by no more than that."""
    arcs = exact.split(math.pi)
    rough = np.random.default_rng(index).normal(size=(3, len(arcs))) * 10.0**size
    vertices = arcs.vertices + rough[0] + 1j * rough[1]
    sweeps = np.where(arcs.sweeps == 0.0, 0.1 * rough[2], 0.99 * arcs.sweeps)
    before = deviation_bound(exact, Contour.through(vertices, sweeps))
    vertices[index % len(vertices)] += step * complex(np.cos(angle), np.sin(angle))
    after = deviation_bound(exact, Contour.through(vertices, sweeps))
    assert abs(after - before) <= 1.001 * step + SHARPNESS * after + NOTHING


@pytest.mark.parametrize("bulge", [1e-15, 1e-12, 1e-9, 1e-6, 1e-3])
def test_flat_arcs_are_off_by_their_sagitta(bulge: float) -> None:
    """However large the circles are."""
    straight = int(np.flatnonzero(SLOTTED.sweeps == 0.0)[0])
    sweeps = SLOTTED.sweeps.copy()
    sweeps[straight] = 4.0 * math.atan(bulge)
    sagitta = 0.5 * bulge * SLOTTED.lengths[straight]
    found = deviation_bound(SLOTTED, Contour.through(SLOTTED.vertices, sweeps))
    assert found == pytest.approx(sagitta, rel=2e-9, abs=NOTHING)


def test_a_bore_without_its_keyway_is_off_by_its_corners() -> None:
    """All of the circle lies on the exact bore: only the missing slot shows the fault."""
    corner = float(np.max(np.abs(SLOTTED.vertices))) - RADIUS
    for plain in (PLAIN, PLAIN.split(1.0), PLAIN.split(0.3).reversed()):
        assert deviation_bound(SLOTTED, plain) == pytest.approx(corner, rel=1e-8)
    for plain in (PLAIN, chord_fit(PLAIN, 0.001).contour):
        assert deviation_bound(SLOTTED, plain) > 2.0
        assert deviation_bound(plain, SLOTTED) > 2.0


def test_twice_round_is_refused() -> None:
    twice = Contour(np.tile(PLAIN.vertices, 2), np.tile(PLAIN.sweeps, 2), np.tile(PLAIN.centres, 2))
    with pytest.raises(GeometryError, match="once round"):
        deviation_bound(PLAIN, twice)


@some
@given(outlines, st.floats(-6.0, 0.5), st.floats(0.3, 1.0))
def test_counts_never_grow_with_the_tolerance(exact: Contour, size: float, share: float) -> None:
    tolerance = 10.0**size
    tighter = fewest_chord_fit(exact, share * tolerance).contour
    assert len(fewest_chord_fit(exact, tolerance).contour) <= len(tighter)


def test_fewest_chords_of_a_circle() -> None:
    # (r - u)/(r + u) = cos(pi/n) with u = 0.001, r = 8: pi/n = 0.0223581, n = 140.5.
    chords = fewest_chord_fit(PLAIN, 0.001).contour
    assert len(chords) == 141
    radius = float(np.abs(chords.vertices[0]))
    assert np.abs(chords.vertices) == pytest.approx(radius, rel=1e-15)
    # Halfway along a chord it is as far inside as the vertices are outside.
    inner = np.abs(0.5 * (chords.vertices + chords.ends))
    assert RADIUS - inner == pytest.approx(radius - RADIUS, rel=1e-9)
    one = fewest_chord_fit(
        Contour(np.array([8.0 + 0j]), np.array([-2.0 * np.pi]), np.zeros(1, np.complex128)), 1.0
    ).contour
    assert one.area < 0.0
    assert len(one) == len(fewest_chord_fit(PLAIN, 1.0).contour)


@pytest.mark.parametrize("fitter", [chord_fit, fewest_chord_fit])
@pytest.mark.parametrize("exact", [PLAIN, SLOTTED])
def test_too_many_chords_are_refused(exact: Contour, fitter: Callable[..., Fit]) -> None:
    with pytest.raises(ToleranceError, match="straight pieces would be needed"):
        fitter(exact, 1e-13)


many = settings(max_examples=examples(15, long=60), deadline=None)


DENSE = 2_000
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


@many
@given(contours(), contours())
def test_sampling_finds_no_more_and_hardly_less(one: Contour, other: Contour) -> None:
    found, bound = _measured(one, other, DENSE), distance(one, other)
    longest = max(float(np.max(each.lengths)) for each in (one, other))
    assert found - 1e-7 <= bound <= found + longest / DENSE * len(one) * len(other) + 1e-9


@many
@given(contours(), contours())
def test_the_same_both_ways_and_however_it_is_run(one: Contour, other: Contour) -> None:
    bound = distance(one, other)
    near = pytest.approx(bound, rel=2.0 * SHARPNESS, abs=1e-13)
    assert distance(other, one) == near
    assert distance(one.reversed(), other.rolled(1)) == near


@many
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
        monkeypatch.setattr(exact_module, "ROUNDS", halvings)
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

    def counted(points: ComplexArray, pieces: exact_module._Pieces) -> FloatArray:
        nonlocal most
        most = max(most, len(points))
        return plain(points, pieces)

    plain = exact_module._distances
    monkeypatch.setattr(exact_module, "_distances", counted)
    monkeypatch.setattr(exact_module, "PAIRS", 4000)
    assert distance(one, other) == pytest.approx(bound, rel=SHARPNESS)
    assert most <= 4000
    monkeypatch.setattr(exact_module, "MOST", 1)
    assert bound <= distance(one, other) * (1.0 + SHARPNESS) <= 2.0 * bound


KEYED = bore_outline(20.0, Keyway(6.0, 2.8))


FLAT = flattened(20.0, DShaft(17.0))


def test_corners_are_where_directions_change() -> None:
    assert corners(KEYED).tolist() == [True] * 4
    assert corners(FLAT).tolist() == [True] * 2
    assert not corners(Contour.circle(5.0)).any()
    assert corner_radius(KEYED) == pytest.approx(10.0, rel=1e-15)
    assert corner_radius(Contour.circle(5.0)) is None
    assert corner_radius(Contour.polygon(np.array([0.0, 4.0, 4.0j]))) is None


@given(st.floats(0.0, 20.0))
@attack
def test_a_corner_of_line_and_arc_slides_along_a_parabola(by: float) -> None:
    """u^2 = r^2 - p^2 + 2 d (r - p), see `corner_radius`: here along x, at y = p + d."""
    found = parallel(KEYED, by).vertices[3]
    assert found.imag == pytest.approx(3.0 + by, rel=1e-14)
    assert found.real**2 == pytest.approx(100.0 - 9.0 + 2.0 * by * 7.0, rel=1e-13)


@pytest.mark.parametrize("contour", [KEYED, FLAT], ids=["keyway", "flat"])
@pytest.mark.parametrize("limit", [1e-2, 1e-4])
def test_steps_keep_to_the_chords(contour: Contour, limit: float) -> None:
    def off(steps: int) -> float:
        """Largest distance of corners of parallels from the chords over the first of the steps."""
        step = 4.0 / steps
        shares = np.linspace(0.0, 1.0, 65)
        ways = np.array([parallel(contour, step * share).vertices for share in shares])
        return float(np.max(np.abs(ways - ways[0] - np.outer(shares, ways[-1] - ways[0]))))

    steps = count_steps(contour, 4.0, limit)
    assert off(steps) <= limit
    assert steps == 1 or off(steps - 1) > limit / 1.21


@pytest.mark.parametrize("tolerance", [0.1, 1e-3])
def test_matching_chords_are_as_many_and_within_the_tolerance(tolerance: float) -> None:
    contours = [parallel(KEYED, by) for by in (0.0, 1.0, 4.0)]
    polygons = matching_chords(contours, tolerance)
    assert len({len(each) for each in polygons}) == 1
    for contour, polygon in zip(contours, polygons, strict=True):
        assert set(contour.vertices.tolist()) <= set(polygon.tolist())
        assert deviation_bound(contour, Contour.polygon(polygon)) <= tolerance * 1.001
    assert len(polygons[0]) <= 5 + math.pi / math.sqrt(tolerance / 14.0)
