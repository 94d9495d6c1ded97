"""Contours of lines and arcs, compared with figures computed by hand and with dense polygons: their
measures, places on their pieces, parts of them, chords, and distances."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.geometry.contour.contour import (
    Contour,
    Pieces,
    distances,
    least_distance,
    winding_number,
)
from camgeo.geometry.contour.spline import Arc, SplineContour
from camgeo.milling.track import Track, chain_tracks
from camgeo.numeric.arrays import ComplexArray, taken
from tests.contour.cams import outline, polyline
from tests.measuring import polygon
from tests.toolpath.plane.tracks import any_track, scattered, through
from tests.toolpath.plane.tracks import dense as places_on


@st.composite
def stars(draw: st.DrawFn) -> Contour:
    """Counter-clockwise about 0: vertices in order of angle, lines and shallow arcs between."""
    count = draw(st.integers(3, 12))
    radii = np.array([draw(st.floats(5.0, 20.0)) for _ in range(count)])
    sweeps = np.array([draw(st.sampled_from([0.0, 0.4, -0.4, 1.0])) for _ in range(count)])
    vertices = radii * np.exp(2j * np.pi * np.arange(count) / count)
    ends = np.roll(vertices, -1)
    turned = np.where(sweeps == 0.0, 1.0, np.exp(1j * sweeps))
    safe = np.where(sweeps == 0.0, 2.0, turned)
    centres = np.where(sweeps == 0.0, 0.0, (ends - vertices * turned) / (1.0 - safe))
    return Contour(vertices, sweeps, centres)


@pytest.mark.parametrize("sign", [1, -1])
def test_full_circle_as_one_piece(sign: int) -> None:
    contour = Contour(np.array([7.0 + 0j]), np.array([sign * 2.0 * np.pi]), np.array([3.0 + 0j]))
    assert contour.area == pytest.approx(sign * 16.0 * np.pi, rel=1e-15)
    assert contour.length == pytest.approx(8.0 * np.pi, rel=1e-15)
    assert winding_number(contour, 3.0 + 0j) == sign
    halves = contour.split(np.pi)
    assert halves.vertices == pytest.approx([7.0, -1.0])
    assert halves.area == pytest.approx(contour.area, rel=1e-15)


@settings(max_examples=40, deadline=None)
@given(stars())
def test_area_length_and_points_agree_with_dense_polygons(contour: Contour) -> None:
    shape = polygon(outline(contour).dense(60_000))
    # 5,000 chords an arc of at most 24 mm: relative error (1/5000)^2/24 a piece.
    assert contour.area == pytest.approx(shape.area, rel=1e-8)
    assert contour.length == pytest.approx(shape.length, rel=1e-8)
    sagitta = 0.01
    points = contour.points(sagitta)
    assert np.max(outline(contour).distances(points)) < 1e-12
    chords = outline(polyline(points))
    assert np.max(chords.distances(outline(contour).dense(2_000))) <= sagitta * (1.0 + 1e-9)


@settings(max_examples=40, deadline=None)
@given(stars(), st.floats(0.05, 3.0))
def test_reversed_and_split_are_the_same_outline(contour: Contour, largest: float) -> None:
    back = contour.reversed()
    assert back.area == pytest.approx(-contour.area, rel=1e-14)
    assert back.length == pytest.approx(contour.length, rel=1e-14)
    assert np.array_equal(back.reversed().vertices, contour.vertices)
    assert np.array_equal(back.reversed().sweeps, contour.sweeps)
    assert back.counter_clockwise().area > 0.0
    # An arc's end is turned from its start about a centre at most 50 mm off: some 10 ulp of that.
    arcs = back.sweeps != 0.0
    turned = back.centres + (back.vertices - back.centres) * np.exp(1j * back.sweeps)
    assert np.max(np.abs(turned - back.ends)[arcs], initial=0.0) < 1e-13
    parts = contour.split(largest)
    assert np.max(np.abs(parts.sweeps)) <= largest * (1.0 + 1e-9)
    assert parts.area == pytest.approx(contour.area, rel=1e-13)
    assert np.isin(contour.vertices, parts.vertices).all()


@settings(max_examples=40, deadline=None)
@given(stars(), st.floats(0.0, 3.0), st.floats(0.0, 6.3))
def test_winding_number(contour: Contour, share: float, angle: float) -> None:
    point = 10.0 * share * complex(np.cos(angle), np.sin(angle))
    ring = outline(contour).dense(20_000)
    if np.min(np.abs(ring - point)) < 0.01:
        return  # too near to decide
    turns = round(float(np.sum(np.angle((np.roll(ring, -1) - point) / (ring - point)))) / 6.2832)
    assert winding_number(contour, point) == turns
    assert winding_number(contour.reversed(), point) == -turns


@pytest.mark.parametrize("bulge", [1e-15, 1e-12, 1e-9, 1e-6, 1e-3])
def test_the_area_beside_flat_arcs(bulge: float) -> None:
    """Each arc adds two thirds of chord times sagitta, however large its circle is."""
    square: ComplexArray = np.array([5.0, 5j, -5.0, -5j], dtype=np.complex128)
    flat = Contour.through(square, np.full(4, 4.0 * math.atan(bulge)))
    beside = 4.0 * 50.0 * bulge / 3.0
    assert flat.area - 50.0 == pytest.approx(beside, rel=1e-6, abs=1e-13)
    arcs = zip(flat.vertices, flat.ends, flat.sweeps, flat.centres, strict=True)
    spline = SplineContour(tuple(Arc(*(each.item() for each in arc)) for arc in arcs))
    assert spline.area == pytest.approx(flat.area, rel=1e-15)


SEEDS = range(10)


def any_pieces(seed: int) -> Pieces:
    """Lines, arcs up to half a turn, and one of nearly a whole turn."""
    track = any_track(np.random.default_rng(seed), 8)
    return chain_tracks((track, Track.arc(track.end, track.end + 2.0, -6.0))).pieces


@pytest.mark.parametrize("seed", SEEDS)
def test_places_follow_the_length(seed: int) -> None:
    """Equal shares of the length are equally far apart, and the ends are those stated."""
    pieces = any_pieces(seed)
    count = 2001
    places = np.array(
        [pieces.points_by_share(np.full(len(pieces), share)) for share in np.linspace(0, 1, count)]
    )
    assert np.all(places[0] == pieces.starts)
    assert np.all(places[-1] == pieces.ends)
    steps = np.abs(np.diff(places, axis=0))
    # A chord of the angle t is shorter than its arc by the share t^2 / 24.
    assert np.max(np.abs(steps * (count - 1) / pieces.lengths - 1.0)) < 1e-6
    ways = np.diff(places, axis=0) / steps
    for k in (0, 700, 1999):
        middle = pieces.points_by_share(np.full(len(pieces), (k + 0.5) / (count - 1)))
        assert np.abs(pieces.tangents(middle) - ways[k]) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_part_is_the_same_curve(seed: int) -> None:
    pieces, rng = any_pieces(seed), np.random.default_rng(seed)
    first, last = np.sort(rng.uniform(0.0, 1.0, (2, len(pieces))), axis=0)
    part = pieces.subpieces(first, last)
    assert part.lengths == pytest.approx((last - first) * pieces.lengths)
    inner = rng.uniform(0.0, 1.0, len(pieces))
    same = pieces.points_by_share(first + inner * (last - first))
    assert np.abs(part.points_by_share(inner) - same) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("seed", SEEDS)
def test_halves_turn_by_half_a_turn_at_most(seed: int) -> None:
    pieces = any_pieces(seed)
    index, first, last = pieces.halves()
    assert np.bincount(index).tolist() == [1] * (len(pieces) - 1) + [2]
    parts = taken(pieces, index).subpieces(first, last)
    assert np.max(np.abs(parts.sweeps)) <= np.pi
    joined = index[1:] == index[:-1]
    assert np.all(parts.starts[1:][joined] == parts.ends[:-1][joined])


@pytest.mark.parametrize("sagitta", [1.0, 1e-3, 1e-7])
@pytest.mark.parametrize("seed", SEEDS)
def test_chords_keep_the_sagitta(seed: int, sagitta: float) -> None:
    pieces = any_pieces(seed)
    index, ends = pieces.chords(sagitta)
    first = np.diff(index, prepend=-1) > 0
    starts = np.where(first, pieces.starts[index], np.roll(ends, 1))
    assert np.all(ends[np.append(first[1:], True)] == pieces.ends)
    radii, half = pieces.radii[index], 0.5 * np.abs(ends - starts)
    off = radii - np.sqrt(np.maximum(radii**2 - half**2, 0.0))
    assert np.max(off) <= sagitta * (1.0 + 1e-9) + 1e-14
    assert np.all(np.bincount(index)[pieces.sweeps == 0.0] == 1)


def test_a_huge_arc_has_finitely_many_chords() -> None:
    huge = Track.arc(1e9 + 0j, 0j, 0.5 * np.pi).pieces
    assert len(huge.chords(1e-12)[0]) <= 500_000


def test_contours_are_cut_into_half_turns() -> None:
    slotted = Contour(np.array([3.0 + 0j, 5.0, 3.0j]), np.array([0.0, 0.0, 1.5 * np.pi]),
                      np.array([0j, 0j, 0j]))  # fmt: skip
    pieces = Pieces.around([slotted, Contour.circle(9.0)])
    assert len(pieces) == 6
    assert np.max(pieces.sweeps) <= np.pi
    assert np.sum(pieces.lengths) == pytest.approx(slotted.length + 18.0 * np.pi)
    assert len(Pieces.around([])) == 0


EACH = 400
"""Points on a piece of at most 60 mm: none is farther than 0.075 mm from one of them."""


APART = 0.08


@pytest.mark.parametrize("seed", range(20))
def test_points(seed: int) -> None:
    rng = np.random.default_rng(seed)
    track = any_track(rng)
    points = scattered(rng, 30, 15.0)
    found = distances(points, track)
    near = np.min(np.abs(points[:, None] - places_on(track, EACH)), axis=1)
    assert np.all(found <= near + 1e-12)
    assert np.all(near - found <= APART)
    assert np.max(distances(places_on(track, 20), track)) < 1e-12


@pytest.mark.parametrize("seed", range(40))
def test_chains(seed: int) -> None:
    rng = np.random.default_rng(seed)
    one, other = any_track(rng, 3, 4.0), any_track(rng, 2, 4.0)
    moved = Track(other.vertices + 9.0, other.sweeps, other.centres + 9.0)
    for each in (other, moved):
        found = least_distance(one, each)
        near = np.min(np.abs(places_on(one, EACH)[:, None] - places_on(each, EACH)))
        assert found <= near + 1e-12
        assert near - found <= APART
        assert least_distance(each, one) == pytest.approx(found, abs=1e-12)


def test_crossing_pieces_have_no_distance() -> None:
    line = Track.line(-5 - 0.1j, 5 + 0.2j)
    arc = through(np.array([-1 + 0j, 1 + 0j]), np.array([-3.0]))
    flat = Track.line(-4 + 0.5j, 4 + 0.5j)
    for one, other in ((line, Track.line(1 - 3j, 1 + 3j)), (line, arc), (arc, flat)):
        assert least_distance(one, other) == 0.0
    assert least_distance(arc, Track.arc(0.5 + 0j, 0.5 + 5j, 3.0)) == 0.0


def test_nested_circles() -> None:
    """The common normal of two arcs, on the same side of both centres."""
    outer, inner = Track.arc(-10 + 0j, 0j, 3.0), Track.arc(-5 - 2j, -2 - 2j, -2.9)
    gap = 10.0 - abs(-2 - 2j) - 3.0
    turned = Track(outer.vertices * 1j, outer.sweeps, outer.centres * 1j)
    assert least_distance(turned, inner) == pytest.approx(least_distance(inner, turned))
    assert least_distance(outer, inner) >= gap - 1e-12
