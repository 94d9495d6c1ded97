"""Mass properties and thinnest walls: closed forms, invariants, polygons, and bodies of writers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour, Fit
from camgeo.geometry.outline.path import Path, Pivot, SecondMoments, radii
from camgeo.numeric.arrays import FloatArray
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.mass import (
    SHARE,
    TOLERANCES,
    disc_moments,
    largest_diameter,
    section_area,
    solid,
    surely_thick,
    thinnest_of_each,
)
from camgeo.part.part import Layer, Part
from camgeo.part.spec import Holes, Hub, Keyway, PartSpec
from tests.contour.cams import polyline
from tests.draws.walls import misses
from tests.effects.scenes import design
from tests.outline.test_path import eccentric
from tests.part.parts import FLANKS, circle, made, made_or_refused, polygon_of, specs
from tests.strategies import attack

SCENES = ("plate_translating", "groove", "ring", "cut_lobe", "conjugate_lever", "flat_rocker")


@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize("eccentricity", [0.0, 5.0, 30.0])
def test_an_eccentric_disc_is_a_cylinder(eccentricity: float, rotation: int) -> None:
    """J = m r^2/2 about its own axis, m (3 r^2 + h^2)/12 across it; Steiner about the cam axis."""
    path = eccentric(eccentricity, 40.0, rotation, guide=0.7)
    found = solid(Part((Layer(-9.0, 0.0, (CurveBoundary("outline", hole=False, path=path),)),)))
    volume = math.pi * 40.0**2 * 9.0
    across = volume * (3.0 * 40.0**2 + 9.0**2) / 12.0
    assert found.volume == pytest.approx(volume, rel=1e-12)
    centre = [eccentricity * math.cos(0.7), eccentricity * math.sin(0.7), -4.5]
    assert np.allclose(found.centre, centre, rtol=0.0, atol=1e-11)
    expected = np.diag([across, across, 0.5 * volume * 40.0**2])
    assert np.allclose(found.inertia, expected, rtol=0.0, atol=1e-11 * volume * 70.0**2)
    assert found.axial == pytest.approx(volume * (0.5 * 40.0**2 + eccentricity**2), rel=1e-12)
    assert found.share < 1e-9
    assert found.centre_error < 1e-7
    assert radii(path).highest.value == pytest.approx(40.0 + eccentricity, rel=1e-15)


def test_a_stepped_ring_with_a_pocket_off_the_axis() -> None:
    """Hub, flange and a blind hole: cylinders, added up with Steiner's terms by hand."""
    bore = circle("bore", 6.0, hole=True)
    flange, hub = circle("outline", 40.0), circle("hub", 15.0)
    pocket = circle("pocket", 4.0, 25.0 + 10.0j, hole=True)
    part = Part(
        (
            Layer(-10.0, -3.0, (flange, bore)),
            Layer(-3.0, 0.0, (flange, pocket, bore)),
            Layer(0.0, 12.0, (hub, bore), "hub"),
        )
    )
    cylinders = [
        (1.0, 40.0, 0j, -10.0, 0.0), (1.0, 15.0, 0j, 0.0, 12.0),
        (-1.0, 6.0, 0j, -10.0, 12.0), (-1.0, 4.0, 25.0 + 10.0j, -3.0, 0.0),
    ]  # fmt: skip
    volume, first, about = 0.0, np.zeros(3), np.zeros((3, 3))
    for sign, radius, at, low, high in cylinders:
        own = sign * math.pi * radius**2 * (high - low)
        place = np.array([at.real, at.imag, 0.5 * (low + high)])
        across = own * (3.0 * radius**2 + (high - low) ** 2) / 12.0
        volume, first = volume + own, first + own * place
        about += np.diag([across, across, 0.5 * own * radius**2]) + shifted(own, place)
    found = solid(part)
    assert found.volume == pytest.approx(volume, rel=1e-14)
    assert np.allclose(found.centre, first / volume, rtol=0.0, atol=1e-13)
    about -= shifted(volume, first / volume)
    assert np.allclose(found.inertia, about, rtol=0.0, atol=1e-13 * volume * 40.0**2)
    assert largest_diameter(part) == (80.0, None)
    areas = [math.pi * each for each in (40.0**2 - 36.0, 40.0**2 - 52.0, 15.0**2 - 36.0)]
    assert [section_area(each) for each in part.layers] == pytest.approx(areas, rel=1e-14)


def shifted(volume: float, place: FloatArray) -> FloatArray:
    """Steiner's term of a volume at `place` (3,): (3, 3)."""
    found: FloatArray = volume * (place @ place * np.eye(3) - np.outer(place, place))
    return found


def seconds(contour: Contour) -> SecondMoments:
    return ExactBoundary("outline", hole=False, exact=contour).second_moments(1e-12)


places = st.complex_numbers(max_magnitude=60.0, allow_nan=False, allow_infinity=False)


@settings(max_examples=40, deadline=None)
@given(places, st.floats(0.5, 40.0), st.floats(0.1, 6.2), st.floats(-3.0, 3.0))
def test_second_moments_of_a_segment_are_those_of_its_circle_less_the_rest(
    centre: complex, radius: float, sweep: float, first: float
) -> None:
    """An arc and its chord, and the other arc with the same chord, make up the circle, for which
    the integral of |z|^2 is A (r^2/2 + |c|^2), that of z^2 is A c^2.
    """
    turned = np.exp(1j * np.array([first, first + sweep]))
    ends = np.asarray(centre + radius * turned, dtype=np.complex128)
    centres = np.array([centre, 0j])
    one = seconds(Contour(ends, np.array([sweep, 0.0]), centres))
    rest = np.array([2.0 * math.pi - sweep, 0.0])
    other = seconds(Contour(ends[::-1], rest, centres))
    area = math.pi * radius * radius
    room = 1e-13 * area * (radius + abs(centre)) ** 2 + 1e-13 * radius * (radius + abs(centre)) ** 3
    expected = area * (0.5 * radius * radius + abs(centre) ** 2)
    assert abs(one.polar + other.polar - expected) <= room
    assert abs(one.square + other.square - area * centre**2) <= room


def test_second_moments_of_a_rectangle() -> None:
    found = seconds(polyline(np.array([1.0 + 2.0j, 4.0 + 2.0j, 4.0 + 7.0j, 1.0 + 7.0j])))
    xx, yy = (64.0 - 1.0) / 3.0 * 5.0, (343.0 - 8.0) / 3.0 * 3.0
    assert found.polar == pytest.approx(xx + yy, rel=1e-14)
    xy = 0.25 * (16.0 - 1.0) * (49.0 - 4.0)
    assert found.square == pytest.approx(complex(xx - yy, 2.0 * xy), rel=1e-14)
    assert found.scaled(-1.0).counter_clockwise() == found


def discs(name: str) -> Iterator[Part]:
    return (disc.drawn.part for disc in design(name, "").discs)


@pytest.mark.parametrize("scene", SCENES)
def test_the_body_of_the_writers_has_the_same_mass_properties(scene: str) -> None:
    """Its vertices are within t of the boundaries: volumes differ by t times the walls, moments of
    inertia by that times the square of the largest radius."""
    import trimesh

    from camgeo_export.solid.prism import body

    tolerance = 2e-3
    for part in discs(scene):
        found = solid(part)
        made = body(part, tolerance, lambda x: x)
        mesh = trimesh.Trimesh(made.vertices, made.triangles, process=False)
        walls = part.thickness * sum(each.polyline(0.1).contour.length for each in part.boundaries)
        room = 1.1 * tolerance * walls
        largest = 0.5 * largest_diameter(part)[0]
        volume, span = found.volume, largest + part.thickness
        assert abs(mesh.volume - volume) <= room
        centre = found.centre - [0.0, 0.0, part.layers[0].z0]  # bodies stand on the plane z = 0
        assert np.all(abs(mesh.center_mass - centre) <= 2.0 * room * span / volume)
        assert np.all(abs(mesh.moment_inertia - found.inertia) <= 8.0 * room * span**2)
        reach = float(np.max(np.hypot(*made.vertices.T[:2])))
        assert abs(reach - largest) <= tolerance
        moments = disc_moments(part, 1.0, 1e-12)
        assert moments.area == pytest.approx(volume, rel=1e-9)
        off = moments.first / moments.area - complex(*found.centre[:2])
        assert abs(off) <= 1e-8 * largest


@pytest.mark.parametrize(("distance", "sweep", "expected"), [
    (8.0, 2.0, 38.0), (8.0, 0.5, None), (-8.0, -2.0, 38.0), (0.0, 1.0, 30.0),
])  # fmt: skip
def test_the_farthest_point_of_an_arc(
    distance: float, sweep: float, expected: float | None
) -> None:
    """About a centre 30 mm away, once over the point behind it and once short of that."""
    normal = np.exp(-1j) if distance >= 0.0 else -np.exp(1j)
    pivot = Pivot(30.0 + 0j, distance, complex(normal), sweep, 0.0, 0.25)
    found = radii(Path((pivot,))).highest
    ends = max(abs(pivot.start), abs(pivot.end))
    assert found.value == pytest.approx(ends if expected is None else expected, rel=1e-15)
    assert found.place == 0.25


def test_a_part_without_heights_has_no_body() -> None:
    part = Part((Layer(0.0, 0.0, (circle("outline", 40.0),)),))
    with pytest.raises(GeometryError, match="thickness"):
        solid(part)


CIRCLE = math.pi / 2.0
"""A direction in which the inner flank dwells at 32 mm."""


@pytest.mark.parametrize(
    ("spec", "names", "thickness", "usual"),
    [
        (PartSpec(bore=60.0), ("outline", "bore"), 2.0, 6.0),
        (PartSpec(bore=20.0, hub=Hub(26.0, 5.0)), ("hub", "bore"), 3.0, 2.0),
        (PartSpec(bolt_circle=Holes(2, 12.0, 8.0)), ("bolt hole 1", "bolt hole 2"), 4.0, 0.8),
        (PartSpec(lightening_holes=Holes(1, 50.0, 8.0, CIRCLE)), None, 3.0, 0.8),
        (PartSpec(rim=140.0, groove_depth=4.0, bore=50.0), ("inner flank", "bore"), 7.0, 5.0),
    ],
)
def test_walls_of_circles(
    spec: PartSpec, names: tuple[str, str] | None, thickness: float, usual: float
) -> None:
    part = made(Contact.INNER if spec.rim is None else Contact.GROOVE, spec)
    least, found = thinnest_of_each(part)
    assert found is not None
    assert least is not None
    assert least.thickness == found.thickness
    # A groove's outer flank is a hole around the bore, so circles about both meet.
    assert surely_thick(part) == (thickness > usual and spec.rim is None)
    assert names in (None, (found.one, found.other))
    assert found.thickness == pytest.approx(thickness, abs=0.01)
    assert found.usual == pytest.approx(usual)


def test_a_keyway_towards_the_dwell() -> None:
    """From the corners of the slot to a circle of 32 mm; near the limit it is that exact."""
    spec = PartSpec(bore=50.0, keyway=Keyway(8.0, 3.0, CIRCLE))
    wall = 32.0 - math.hypot(28.0, 4.0)
    for limit in (wall - 1e-5, wall + 1e-5):
        found = thinnest_of_each(made(Contact.INNER, spec), limit)[0]
        assert found is not None
        assert (found.thickness < limit) == (wall < limit)
        assert found.thickness == pytest.approx(wall, abs=1e-6)
        assert min(abs(found.place - corner) for corner in (4.0 + 28.0j, -4.0 + 28.0j)) < 1e-9


def test_an_exact_wall_takes_no_fine_contours(monkeypatch: pytest.MonkeyPatch) -> None:
    """A steep flank has 180,000 chords within 1e-4 mm, which would show a place for the eye."""
    asked = []
    beside = CurveBoundary.beside

    def counted(self: CurveBoundary, tolerance: float) -> Fit:
        asked.append(tolerance)
        return beside(self, tolerance)

    monkeypatch.setattr(CurveBoundary, "beside", counted)
    found = thinnest_of_each(made(Contact.INNER, PartSpec(bore=60.0)))[0]
    assert found is not None
    assert found.thickness == pytest.approx(2.0, abs=1e-12)
    assert abs(found.place) == pytest.approx(30.0)
    assert min(asked) == TOLERANCES[0]


def test_the_thinnest_wall_is_not_always_thin_beside_its_hole() -> None:
    """A wall of 3 mm beside a bore of 20 mm is more than usual, one of 2 mm beside 8 mm too."""
    spec = PartSpec(bore=20.0, hub=Hub(25.0, 5.0), lightening_holes=Holes(1, 52.4, 8.0, CIRCLE))
    part = made(Contact.INNER, spec)
    least, relative = thinnest_of_each(part)
    assert relative is not None
    assert least is not None
    assert (relative.one, relative.thickness) == ("hub", 2.5)
    assert thinnest_of_each(part, 1.0)[0] == least
    assert least.other == "lightening hole 1"
    assert least.thickness == pytest.approx(1.8, abs=0.01)


def test_beside_a_flank_alone_nothing_is_usual() -> None:
    found = thinnest_of_each(made(Contact.OUTER, PartSpec(rim=140.0)))[0]
    assert found is not None
    assert (found.one, found.other, found.usual) == ("rim", "outline", 0.0)
    assert found.thickness == pytest.approx(7.0, abs=0.01)
    assert thinnest_of_each(made(Contact.OUTER, PartSpec(rim=140.0)))[1] is None
    assert thinnest_of_each(made(Contact.INNER, PartSpec()))[0] is None


@given(st.sampled_from(list(FLANKS)), specs(), st.booleans())
@attack
def test_no_wall_of_a_random_part_is_thinner(
    contact: Contact, spec: PartSpec, limited: bool
) -> None:
    """Of all pairs of boundaries between which there is material in a layer."""
    part = made_or_refused(contact, spec)
    assume(part is not None)
    assert part is not None
    limit = 1.0 if limited else None
    found, beside = thinnest_of_each(part, limit)[0], thinnest_of_each(part)[1]
    walls = list(_walls(part))
    assert (found is None) == (not walls)
    if found is None:
        return
    assert not surely_thick(part, 1.0) or found.thickness >= 1.0
    assert found.thickness == pytest.approx(min(wall for wall, _ in walls), abs=0.05)
    assert (beside is None) == (not any(usual for _, usual in walls))
    if beside is None:
        return
    assert not surely_thick(part) or beside.thickness >= beside.usual
    off = 0.05  # of the polygons
    relative = beside.thickness / beside.usual
    assert relative <= min((wall + off) / usual for wall, usual in walls if usual)
    assert relative >= min((wall - off) / usual for wall, usual in walls if usual)


def test_walls_of_random_scenes_are_those_of_shapely() -> None:
    assert [missed for _, missed in misses(3, 2026)] == [[]] * 3


def _walls(part: Part) -> list[tuple[float, float]]:
    """Distances of polygons [mm], and the usual ones."""
    found = []
    areas = {each.name: polygon_of(each, 1e-2) for each in part.boundaries}
    for layer in part.layers:
        for one, other in combinations(layer.boundaries, 2):
            a, b = areas[one.name], areas[other.name]
            nested = a.contains(b) if not one.hole else b.contains(a) if not other.hole else False
            apart = one.hole and other.hole and a.disjoint(b)
            solid, hole = (one, other) if not one.hole else (other, one)
            if not (apart or (nested and not solid.hole and hole.hole)):
                continue
            sizes = [
                2.0 * math.sqrt(each.arcs(1e-2, "fast").contour.area / math.pi)
                for each in (one, other)
                if each.hole and each.name not in ("outline", "outer flank")
            ]
            found.append((a.exterior.distance(b.exterior), SHARE * max(sizes, default=0.0)))
    return found
