"""What a nozzle cannot make: compared with widths and radii that are known."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import shapely

import camgeo
from camgeo.cam.cam import Contact
from camgeo.check.finding import Finding
from camgeo.geometry.contour.contour import Contour
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.nozzle import RADIUS, STROKE, WALL, findings_of, sunk
from camgeo.part.part import Layer, Part
from camgeo.part.spec import Engraving, Holes, Mark
from tests.contour.cams import SCENES
from tests.part.parts import DISC, made


def _found(part: Part, nozzle: float) -> dict[str, Finding]:
    return {each.name: each for each in findings_of(part, nozzle)}


@pytest.mark.parametrize(
    ("nozzle", "severity", "limit"),
    [(0.24, "ok", 0.48), (0.26, "warning", 0.52), (0.51, "broken", 0.51)],
)
def test_walls(nozzle: float, severity: str, limit: float) -> None:
    """0.5 mm between bore and hole, on the x axis."""
    part = made(Contact.INNER, replace(DISC, bolt_circle=Holes(1, 30.0, 9.0)))
    wall = _found(part, nozzle)[WALL]
    assert (wall.severity, wall.limit) == (severity, limit)
    assert wall.value == pytest.approx(0.5, abs=1e-9)
    assert "between bore and bolt hole 1, at (10.5, " in wall.sentence


@cache
def _scene(name: str) -> Part:
    return camgeo.load(SCENES / f"{name}.toml").disc.drawn.part


@pytest.mark.parametrize("scene", ["plate_translating", "tappet", "ring", "groove", "setzhub"])
def test_the_smallest_radius_of_flanks(scene: str) -> None:
    """As of circles through three neighbouring points of the flanks."""
    part = _scene(scene)
    radii = []
    for boundary in part.boundaries:
        if isinstance(boundary, CurveBoundary):
            (stretch,) = boundary.path.stretches
            for low, high in zip(stretch.marks[:-1], stretch.marks[1:], strict=True):
                phi = np.linspace(low, high, 2001)[1:-1]
                a, b, c = (stretch.curve.point(phi + k * 1e-4 * (high - low)) for k in (-1, 0, 1))
                turned = (np.conj(b - a) * (c - b)).imag
                sides = np.abs(b - a) * np.abs(c - b) * np.abs(c - a)
                with np.errstate(divide="ignore"):
                    radii.append(np.min(sides / (2.0 * np.abs(turned))))
    found = _found(part, 0.4)[RADIUS]
    assert found.severity == "ok"
    assert found.value == pytest.approx(min(radii), rel=1e-3)


def test_radii_below_half_the_nozzle() -> None:
    radius = _found(_scene("plate_translating"), 0.4)[RADIUS].value
    assert radius is not None
    assert _found(_scene("plate_translating"), 1.99 * radius)[RADIUS].severity == "ok"
    poor = _found(_scene("plate_translating"), 2.01 * radius)[RADIUS]
    assert poor.severity == "warning"
    assert "rounded off" in poor.sentence or "filled in" in poor.sentence


def test_corners_have_no_radius() -> None:
    corner = _found(_scene("trimmed_ring"), 0.4)[RADIUS]
    assert (corner.severity, corner.value, corner.limit) == ("warning", 0.0, 0.2)
    assert "the outline has a corner at cam angle" in corner.sentence
    assert corner.cam_angle is not None


@pytest.mark.parametrize("length", [None, 4.0])
@pytest.mark.parametrize("width", [0.3, 0.397, 0.4, 0.6])
def test_marks(length: float | None, width: float) -> None:
    part = made(Contact.INNER, replace(DISC, mark=Mark(25.0, width, 0.5, length)))
    found = _found(part, 0.4)
    assert (STROKE in found) == (width < 0.399)
    if STROKE in found:
        stroke = found[STROKE]
        assert stroke.severity == "warning"
        assert stroke.value == pytest.approx(width, abs=2e-3)
        assert "a stroke of the mark" in stroke.sentence


def _engraved(*boundaries: ExactBoundary) -> Part:
    plate = ExactBoundary("outline", False, Contour.circle(50.0))
    low, high = Layer(-10.0, -0.5, (plate,)), Layer(-0.5, 0.0, (plate, *boundaries), "text")
    return Part((low, high))


def _outline(*points: complex, name: str = "text", hole: bool = True) -> ExactBoundary:
    return ExactBoundary(name, hole, Contour.polygon(np.array(points)))


T = _outline(1.85, 2.15, 2.15 + 4j, 4 + 4j, 4 + 5j, 0 + 5j, 0 + 4j, 1.85 + 4j)
"""The bar 1 mm wide, the stem 0.3 mm."""

H = _outline(0, 1, 1 + 2.3j, 3 + 2.3j, 3, 4, 4 + 5j, 3 + 5j, 3 + 2.7j, 1 + 2.7j, 1 + 5j, 5j)
"""The stems 1 mm wide, the bar between them 0.4 mm."""

A = _outline(0, 1, 3 + 6j, 5, 6, 3.6 + 7j, 2.4 + 7j)
"""Strokes above 0.8 mm, with sharp corners."""

RING = (
    ExactBoundary("ring", True, Contour.circle(4.0)),
    ExactBoundary("island", False, Contour.circle(3.0, 0.75)),
)
"""0.25 mm wide at its narrowest."""


@pytest.mark.parametrize(
    ("boundaries", "width"),
    [((T,), 0.3), ((H,), 0.4), (RING, 0.25), ((A,), None), ((A, *(
        ExactBoundary(each.name + "s", each.hole, each.exact) for each in (
            _outline(20, 20.2, 20.2 + 5j, 20 + 5j),)),), 0.2)],
    ids=["stem", "bar", "ring", "corners", "the narrowest"],
)  # fmt: skip
def test_strokes(boundaries: tuple[ExactBoundary, ...], width: float | None) -> None:
    found = _found(_engraved(*boundaries), 0.5)
    assert (found[STROKE].value if STROKE in found else None) == (
        width if width is None else pytest.approx(width, abs=3e-3)
    )
    if width is not None:
        assert STROKE not in _found(_engraved(*boundaries), 0.9 * width)


@pytest.mark.parametrize(("height", "narrow"), [(2.9, True), (3.0, False)])
def test_strokes_of_a_text(height: float, narrow: bool) -> None:
    """A stem of the font is 202 of its units wide, where a capital letter is 1493 high."""
    text = Engraving("I", height, 0.5, 20.0)
    found = _found(made(Contact.INNER, replace(DISC, engraving=(text,))), 0.4)
    assert (STROKE in found) == narrow
    if narrow:
        assert found[STROKE].value == pytest.approx(202.0 / 1493.0 * height, abs=2e-3)
        assert "a stroke of the engraving 1 letter" in found[STROKE].sentence


def test_the_place_of_a_stroke_lies_in_it() -> None:
    place = _found(_engraved(T), 0.5)[STROKE].sentence.split("(")[1].split(")")[0]
    x, y = map(float, place.split(","))
    assert 1.85 <= x <= 2.15
    assert 0.0 <= y <= 4.0


def test_what_is_sunk() -> None:
    """Holes that go through, hubs and flanks are no strokes; islands belong to what is around."""
    part = made(Contact.GROOVE, replace(DISC, mark=Mark(68.0, 1.0, 0.5)))
    assert [name for name, _ in sunk(part)] == ["mark"]
    ((name, region),) = sunk(_engraved(*RING))
    assert name == "ring"
    assert len(region.interiors) == 1
    assert region.area == pytest.approx(math.pi * 7.0, rel=1e-3)
    assert isinstance(region, shapely.Polygon)
