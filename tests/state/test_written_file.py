"""The contour of the motion `written` is that of the drawing, read here from its group codes."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

import camgeo
from camgeo.design.design import Design
from camgeo.design.writing import find_writer
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import MM_PER
from tests.long_form import LONG

FIXTURES: Final = Path(__file__).parents[2] / "fixtures"

ENTITIES: Final = ("polyline", "arcs", "lines-and-arcs", "spline")

USUAL: Final = (
    ("scenes/shuttle", "polyline", "", None),
    ("scenes/querhub", "arcs", "", 0.016),
    ("scenes/tappet", "arcs", "", 0.002),
    ("scenes/inch", "lines-and-arcs", "", None),
    ("scenes/groove", "arcs", "outer", 0.01),
    ("scenes/conjugate_lever", "spline", "return", None),
)
"""In the usual form of the tests: a scene, the entity of its drawing, the side if it has two, and
the tolerance [mm], None for its own. Contours within 0.98 of the given ones have more pieces.
"""

CORNERED: Final = ("scenes/knife_edge", "scenes/straight_moves")
"""Trimmed discs, on whose splines a roller is not replayed."""

Entity = list[tuple[int, str]]


def entities_of(data: bytes) -> Iterator[tuple[str, Entity]]:
    """The kind and the groups of each entity of a drawing."""
    lines = data.decode().splitlines()
    groups = [(int(code), value) for code, value in zip(lines[::2], lines[1::2], strict=True)]
    start = groups.index((2, "ENTITIES"))
    found: Entity = []
    for code, value in groups[start + 1 :]:
        if code == 0:
            if found:
                yield found[0][1], found
            found = []
            if value == "ENDSEC":
                return
        found.append((code, value))


def numbers(entity: Entity, code: int) -> FloatArray:
    return np.array([float(value) for group, value in entity if group == code])


def points(entity: Entity, code: int, scale: float) -> ComplexArray:
    return np.asarray(
        scale * (numbers(entity, code) + 1j * numbers(entity, code + 10)), dtype=np.complex128
    )


def loops_of(data: bytes, scale: float) -> list[tuple[ComplexArray, FloatArray]]:
    """Vertices [mm] and bulges of each polyline; a vertex without a bulge begins a line."""
    found = []
    for kind, entity in entities_of(data):
        if kind != "LWPOLYLINE":
            continue
        bulges: list[float] = []
        for code, value in entity:
            if code == 10:
                bulges.append(0.0)
            elif code == 42:
                bulges[-1] = float(value)
        found.append((points(entity, 10, scale), np.array(bulges)))
    return found


def strand_of(kind: str, entity: Entity, scale: float) -> ComplexArray:
    """Ends [mm] of a line or a counter-clockwise arc, or the control points of a spline."""
    if kind == "LINE":
        return np.concatenate((points(entity, 10, scale), points(entity, 11, scale)))
    if kind == "SPLINE":
        return points(entity, 10, scale)
    angles = np.radians(np.concatenate((numbers(entity, 50), numbers(entity, 51))))
    found: ComplexArray = points(entity, 10, scale) + scale * numbers(entity, 40) * np.exp(
        1j * angles
    )
    return found


@cache
def written(name: str, entity: str, flank: str, tolerance: float | None = None) -> Design:
    """The fixture scene drawn with that entity, with the motion on that side of its contours."""
    scene = camgeo.load(FIXTURES / f"{name}.toml").scene
    edits: dict[str, Any] = {"state.motion": "written", "output.dxf.entity": entity}
    if flank:
        edits["state.flank"] = flank
    if tolerance is not None:
        edits["output.tolerance"] = tolerance
    return Design(scene.with_values(edits))


@cache
def drawings_of(made: Design) -> tuple[bytes, ...]:
    """Of all discs."""
    writer, tolerance = find_writer("dxf"), made.scene.output.tolerance
    return tuple(writer.write(disc, tolerance).data for disc in made.discs)


def all_cases() -> list[tuple[str, str, str, float | None]]:
    """All scenes in all forms, on all sides."""
    found: list[tuple[str, str, str, float | None]] = []
    for folder in ("scenes", "effects", "pairs"):
        for path in sorted((FIXTURES / folder).glob("*.toml")):
            made = camgeo.load(path)
            if made.scene.follower is None:
                continue
            sides: tuple[str, ...] = ("",)
            if len(made.discs) > 1:
                sides = ("main", "return")
            elif made.scene.yoke is not None:
                sides = ("main", "opposite")
            elif made.cam.contact.closed_by_form:
                sides = ("inner", "outer")
            name = f"{folder}/{path.stem}"
            found += [(name, entity, side, None) for entity in ENTITIES for side in sides]
    return found


@pytest.mark.parametrize(
    ("name", "entity", "flank", "tolerance"), [*USUAL, *(all_cases() if LONG else ())]
)
def test_the_contour_of_the_state_is_that_of_the_file(
    name: str, entity: str, flank: str, tolerance: float | None
) -> None:
    """Vertex for vertex; a spline by its knots and control points."""
    made = written(name, entity, flank, tolerance)
    scale = MM_PER[made.scene.unit]
    drawings = drawings_of(made)
    subject = made.effects.subject
    if LONG and entity == "spline" and (name in CORNERED or not made.cam.follower.has_pitch_curve):
        with pytest.raises(camgeo.GeometryError, match=r"not computed|the spline"):
            subject.state  # noqa: B018 - it is computed when it is asked for
        return
    state: Any = subject.state
    contour = state.contour
    if entity in ("arcs", "polyline"):
        same = [
            vertices
            for data in drawings
            for vertices, bulges in loops_of(data, scale)
            if len(vertices) == len(contour)
            and np.allclose(vertices, contour.vertices, rtol=0.0, atol=1e-12)
            and np.allclose(bulges, np.tan(contour.sweeps / 4.0), rtol=0.0, atol=1e-13)
        ]
        assert same
        return
    found = [
        (strand_of(kind, each, scale), numbers(each, 40) if kind == "SPLINE" else None)
        for data in drawings
        for kind, each in entities_of(data)
        if kind in ("LINE", "ARC", "SPLINE")
    ]
    for controls, knots, backwards in strands_of(contour):
        wanted = controls[::-1] if backwards else controls
        same_strands = [
            own
            for own, own_knots in found
            if own.shape == wanted.shape
            and np.allclose(own, wanted, rtol=0.0, atol=1e-9)
            and (knots is None or (own_knots is not None and np.array_equal(own_knots, knots)))
        ]
        assert same_strands


def strands_of(contour: Any) -> list[tuple[ComplexArray, FloatArray | None, bool]]:
    """Points and knots of each strand of the state's contour, and whether it is an arc that turns
    clockwise.
    """
    if hasattr(contour, "sweeps"):
        ends = zip(contour.vertices, contour.ends, contour.sweeps, strict=True)
        return [(np.array([start, end]), None, sweep < 0.0) for start, end, sweep in ends]
    return [
        (each.controls, each.knots, False)
        if hasattr(each, "knots")
        else (np.array([each.start, each.end]), None, each.sweep < 0.0)
        for each in contour.strands
    ]
