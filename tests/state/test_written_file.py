"""The contour of the motion `written` is that of the file, and the motion is that of the file.

The drawing is read here, from the group codes of DXF alone, and the roller is laid on what was read
by intersecting circles and lines.
"""

from __future__ import annotations

import math
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
from tests.state.test_contours import places_of

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


def lifts_on(vertices: ComplexArray, bulges: FloatArray, cam: Any, phi: float, near: float) -> Any:
    """The lift [mm or rad] of a roller on the outline of a file, and number of what it touches.

    The largest at which the roller touches a piece, or a vertex of straight ones, within 0.05 of
    `near`.
    """
    follower, radius = cam.follower, cam.follower.roller_radius
    ends = np.roll(vertices, -1)
    chord = ends - vertices
    # Of an arc: tan(sweep/4) is the bulge, and the centre is on the left of the chord by the
    # half of it over tan(sweep/2).
    sweep = 4.0 * np.arctan(bulges)
    straight = bulges == 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        centre = vertices + 0.5 * chord * (1.0 + 1j / np.tan(0.5 * sweep))
    centre = np.where(straight, vertices, centre)
    reach = radius + np.where(straight, 0.0, np.sign(sweep) * np.abs(vertices - centre))
    turn = np.exp(1j * cam.rotation * phi)
    if follower.lift_unit == "mm":
        height = math.sqrt(follower.base_radius**2 - follower.offset**2)
        way = complex(follower.way)
        start = way * (height - 1j * follower.offset)
        seen = (centre * turn - start) / way
        q = seen.real + np.sqrt(np.maximum(reach**2 - seen.imag**2, 0.0)) * np.array([[1], [-1]])
        line = (vertices * turn - start) / way
        along = chord * turn / (way * np.abs(chord))
        # Im(conj(along) (q - line)) = -radius on the right of the chord.
        q_line = (radius - (np.conj(along) * line).imag) / along.imag
    else:
        pivot, arm = complex(follower.pivot), complex(follower.start_arm)
        seen = (centre * turn - pivot) / arm
        away = np.abs(seen)
        cosine = (1.0 + away**2 - (reach / abs(arm)) ** 2) / (2.0 * away)
        half = np.arccos(np.clip(cosine, -1.0, 1.0)) * np.array([[1], [-1]])
        q = follower.swing_sense * np.angle(seen * np.exp(1j * half))
        line = (vertices * turn - pivot) / arm
        along = chord * turn / arm
        along /= np.abs(along)
        away_line = (np.conj(along) * line).imag - radius / abs(arm)
        # Im(conj(along) e^(i t)) = away_line.
        bent = np.arcsin(np.clip(away_line, -1.0, 1.0))
        q_line = follower.swing_sense * np.angle(
            along * np.exp(1j * np.array([bent, math.pi - bent]))
        )
    found = []
    for options, on_line in ((q, False), (np.atleast_2d(q_line), True)):
        place = places_of(cam, options, np.full(options.shape, phi))
        if on_line:
            share = (np.conj(chord) * (place - vertices)).real / np.abs(chord) ** 2
            valid = straight & (share >= -1e-12) & (share <= 1.0 + 1e-12)
        else:
            foot = (place - centre) * np.sign(reach)
            bent_by = np.where(straight, 1.0, sweep)
            from_start = np.where(straight, 1.0, (vertices - centre) * np.sign(bent_by))
            turned = np.angle(foot / from_start) / bent_by
            valid = straight | ((turned >= -1e-9) & (turned <= 1.0 + 1e-9))
        valid = valid & (np.abs(options - near) < 0.05)
        number = np.broadcast_to(np.arange(len(vertices)) + on_line * len(vertices), options.shape)
        found += list(zip(options[valid].tolist(), number[valid].tolist(), strict=True))
    return max(found)


@pytest.mark.parametrize(
    ("name", "entity", "tolerance"),
    [
        ("plate_translating", "arcs", 5.7e-3),
        ("querhub", "arcs", 1.6e-2),
        ("querhub", "polyline", 1e-2),
    ],
)
def test_the_motion_is_that_of_a_roller_on_the_outline_in_the_file(
    name: str, entity: str, tolerance: float
) -> None:
    """Lift, and acceleration by differences, which is that of no other contour of the tolerance:
    one that is 2 per cent wider has other pieces, and is off by many per cent of the peak.
    """
    made = written(f"scenes/{name}", entity, "", tolerance)
    state, step = made.effects.subject.state, 2e-4
    (data,) = drawings_of(made)
    vertices, bulges = loops_of(data, 1.0)[0]  # the outline is the first boundary
    phi = np.linspace(0.05, 6.2, 40)
    own = state.motion.jet(phi)
    peak = float(np.max(np.abs(state.motion.jet(np.linspace(0.0, 2.0 * math.pi, 3000))[2])))
    compared = 0
    for angle, jet in zip(phi.tolist(), own.T, strict=True):
        three = [
            lifts_on(vertices, bulges, made.cam, angle + k * step, float(jet[0]))
            for k in (-1, 0, 1)
        ]
        (before, first), (here, middle), (after, last) = three
        assert here == pytest.approx(jet[0], abs=1e-9)
        if first == middle == last:
            compared += 1
            assert (after - 2.0 * here + before) / step**2 == pytest.approx(jet[2], abs=1e-4 * peak)
    assert compared > 20
