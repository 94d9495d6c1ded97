"""The thinnest wall of a part: closed forms, and random parts against polygons."""

from __future__ import annotations

import math
from itertools import combinations

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.cam.cam import Contact
from camgeo.geometry.contour.contour import Fit
from camgeo.part.boundaries import CurveBoundary
from camgeo.part.mass import SHARE, TOLERANCES, surely_thick, thinnest, thinnest_of_each
from camgeo.part.part import Part
from camgeo.part.spec import Holes, Hub, Keyway, PartSpec
from tests.draws.walls import misses
from tests.part.parts import FLANKS, made, made_or_refused, polygon_of, specs
from tests.strategies import attack

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
        found = thinnest(made(Contact.INNER, spec), limit)
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
    found = thinnest(made(Contact.INNER, PartSpec(bore=60.0)))
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
    assert thinnest(part, 1.0) == least
    assert least.other == "lightening hole 1"
    assert least.thickness == pytest.approx(1.8, abs=0.01)


def test_beside_a_flank_alone_nothing_is_usual() -> None:
    found = thinnest(made(Contact.OUTER, PartSpec(rim=140.0)))
    assert found is not None
    assert (found.one, found.other, found.usual) == ("rim", "outline", 0.0)
    assert found.thickness == pytest.approx(7.0, abs=0.01)
    assert thinnest_of_each(made(Contact.OUTER, PartSpec(rim=140.0)))[1] is None
    assert thinnest(made(Contact.INNER, PartSpec())) is None


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
    found, beside = thinnest(part, limit), thinnest_of_each(part)[1]
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
