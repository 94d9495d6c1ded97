"""Parts of bodies: triangles of faces, how near polygons come, and which contour is which."""

from __future__ import annotations

import cmath
import math
from fractions import Fraction

import manifold3d
import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from camgeo.geometry.contour.contour import Contour
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray
from camgeo_export.solid import prism
from camgeo_export.solid.prism import PIECE, of_polygons, triangulated
from camgeo_export.verify.plane import paired

SIZE = 10.0
"""Largest radius of the rings that are drawn [mm]."""

OFF = 16.0 * 2.0**-53 * (2.0 * SIZE) ** 2
"""Of an area [mm^2] where each corner is off by some units of its last place."""


def star(centre: complex, radii: list[float]) -> ComplexArray:
    """A counter-clockwise ring with its vertices evenly around a centre."""
    turn = np.exp(2j * math.pi * np.arange(len(radii)) / len(radii))
    return np.asarray(centre + np.array(radii) * turn, dtype=np.complex128)


def radii(low: float, high: float, least: int, most: int) -> st.SearchStrategy[list[float]]:
    return st.lists(st.floats(low, high), min_size=least, max_size=most)


@st.composite
def faces(draw: st.DrawFn) -> list[ComplexArray]:
    """An outline, perhaps a bore with an island in it, and some holes between both."""
    # The chords of a ring of 8 stay outside of 0.9 of its least radius.
    rings = [star(0.0, draw(radii(7.8, SIZE, 8, 80)))]
    if draw(st.booleans()):
        rings.append(star(0.0, draw(radii(2.0, 3.5, 8, 60)))[::-1])
        if draw(st.booleans()):
            rings.append(star(0.1, draw(radii(0.8, 1.5, 3, 40))))
    # Of 8 places at a radius of 5 mm neighbours are 3.8 mm apart.
    for k in sorted(draw(st.sets(st.integers(0, 7), max_size=8))):
        place = 5.0 * np.exp(0.25j * math.pi * k)
        rings.append(star(place, draw(radii(0.3, 1.4, 3, 24)))[::-1])
    return rings


def sides_of(rings: list[ComplexArray]) -> set[tuple[int, int]]:
    """The sides of the rings, by the positions of their ends in the row of all points."""
    starts = np.cumsum([0, *map(len, rings)])
    return {
        (int(start) + k, int(start) + (k + 1) % len(ring))
        for start, ring in zip(starts[:-1], rings, strict=True)
        for k in range(len(ring))
    }


def area(ring: ComplexArray) -> Fraction:
    """The exact area of a polygon."""
    x, y = ([Fraction(value) for value in part] for part in (ring.real, ring.imag))
    twice = sum(x[k - 1] * y[k] - x[k] * y[k - 1] for k in range(len(x)))
    return Fraction(twice) / 2


def require_face(rings: list[ComplexArray], found: IntArray) -> None:
    """The triangles cover the face once, with the sides of its rings."""
    points = np.concatenate(rings)
    outers = sum(area(ring) > 0 for ring in rings)
    assert len(found) == len(points) - 2 * outers + 2 * (len(rings) - outers)
    edges = {(int(row[k]), int(row[(k + 1) % 3])) for row in found for k in range(3)}
    assert len(edges) == 3 * len(found)
    assert {edge for edge in edges if edge[::-1] not in edges} == sides_of(rings)
    assert set(np.unique(found)) == set(range(len(points)))
    # None is turned over and the areas sum up: no two of them overlap.
    areas = [area(points[row]) for row in found]
    assert min(areas) > -OFF
    assert sum(areas) == sum(map(area, rings))


@given(faces(), st.integers(3, 40))
def test_triangles_cover_the_face_once(rings: list[ComplexArray], most: int) -> None:
    require_face(rings, triangulated(rings, most))


@given(faces())
def test_a_small_face_is_left_to_the_ears(rings: list[ComplexArray]) -> None:
    seen = prism._tilted(rings)
    ears = manifold3d.triangulate([np.column_stack((each.real, each.imag)) for each in seen])
    np.testing.assert_array_equal(triangulated(rings), ears)


def toothed(count: int, radius: float, teeth: int) -> ComplexArray:
    turn = np.arange(count) / count
    return np.asarray((radius + np.cos(2.0 * math.pi * teeth * turn)) * np.exp(2j * math.pi * turn))


@pytest.mark.parametrize(
    "rings",
    [
        [toothed(2400, 40.0, 0), toothed(1200, 8.0, 0)[::-1]],
        [toothed(3600, 40.0, 12)],
        [toothed(2400, 40.0, 20), toothed(600, 8.0, 12)[::-1]]
        + [(toothed(100, 3.0, 5) + 22.0 * np.exp(0.5j * k))[::-1] for k in range(12)],
    ],
    ids=["disc", "cogs", "holes"],
)
def test_ears_are_cut_from_few_points(
    rings: list[ComplexArray], monkeypatch: pytest.MonkeyPatch
) -> None:
    """So that the time grows as the number of points, not as its square."""
    cut = manifold3d.triangulate
    sizes = []

    def counted(polygons: list[FloatArray]) -> IntArray:
        sizes.append(sum(map(len, polygons)))
        found: IntArray = cut(polygons)
        return found

    monkeypatch.setattr(manifold3d, "triangulate", counted)
    found = triangulated(rings)
    assert max(sizes) <= PIECE
    require_face(rings, found)


def test_a_spiral_is_divided_across_its_arm() -> None:
    turn = np.linspace(0.1, 30.0, 300)
    wound = turn * np.exp(1j * turn)
    rings = [np.concatenate((wound + 0.4 * np.exp(1j * turn), wound[::-1]))]
    require_face(rings, triangulated(rings, 20))


def test_a_face_without_a_proved_diagonal_stays_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    rings = [toothed(60, 40.0, 3), toothed(30, 8.0, 0)[::-1]]
    monkeypatch.setattr(prism, "_clear", lambda *_: False)
    np.testing.assert_array_equal(triangulated(rings, 20), triangulated(rings))


# How near polygons come: the verdict of shapely ---------------------------------------------------


def circle(radius: float, count: int) -> ComplexArray:
    return np.asarray(radius * np.exp(2j * math.pi * np.arange(count) / count))


def line(ring: ComplexArray) -> shapely.LinearRing:
    return shapely.LinearRing(np.column_stack((ring.real, ring.imag)))


@given(st.floats(4.5, 5.5), st.integers(3, 40), st.integers(3, 40), st.floats(1e-3, 2.0))
def test_nearest_is_the_distance_if_within_the_tolerance(
    radius: float, one: int, other: int, tolerance: float
) -> None:
    rings = {"one": circle(5.0, one), "other": 0.3 + circle(radius, other)}
    found = of_polygons(rings, tolerance)("one", "other")
    distance = shapely.distance(line(rings["one"]), line(rings["other"]))
    if distance > tolerance:
        assert found is None
    else:
        assert found is not None
        assert found[0] == distance
        # The place is on the one of both, within the rounding of 5 mm.
        assert line(rings["one"]).distance(shapely.Point(found[1].real, found[1].imag)) < 1e-14


# Which contour of a file is which boundary: by size, and by place where sizes are equal -----------


HOLES = [Contour.circle(3.0, 30.0 * cmath.exp(2j * math.pi * k / 6.0)) for k in range(6)]

NESTED = [Contour.circle(radius) for radius in (60.0, 49.0, 48.0, 12.0)]


def polygon(contour: Contour) -> Contour:
    points = contour.points(0.03)
    return Contour(points, np.zeros(len(points)), np.zeros_like(points))


@pytest.mark.parametrize("seed", range(5))
def test_each_contour_is_found_in_any_order(seed: int) -> None:
    wanted = [*NESTED, *HOLES]
    order = np.random.default_rng(seed).permutation(len(wanted)).tolist()
    contours = [wanted[k] if k % 2 else wanted[k].reversed() for k in order]
    found = paired(contours, [polygon(each) for each in wanted])
    assert [order.index(k) for k in range(len(wanted))] == [
        next(i for i, each in enumerate(contours) if each is match) for match in found
    ]


def test_a_hole_that_was_moved_stays_that_hole() -> None:
    """The others keep theirs, so that one deviation is reported and not two."""
    moved = [Contour.circle(3.0, 31.0 + 0j), *HOLES[1:]]
    assert paired(moved, [polygon(each) for each in HOLES]) == moved


def test_small_contours_are_told_apart_by_their_places() -> None:
    """Their areas are no better known than a tolerance for the whole drawing allows, so their order
    is another one in the file.
    """
    sizes = [0.30 + 0.004 * k for k in range(12)]
    wanted = [Contour.circle(size, 20.0 * cmath.exp(0.3j * k)) for k, size in enumerate(sizes)]
    off = [0.009 if k % 2 else -0.009 for k in range(12)]
    contours = [
        Contour.circle(size + more, 20.0 * cmath.exp(0.3j * k))
        for k, (size, more) in enumerate(zip(sizes, off, strict=True))
    ]
    big = Contour.circle(50.0)
    assert paired([big, *contours[::-1]], [*wanted, big]) == [*contours, big]
