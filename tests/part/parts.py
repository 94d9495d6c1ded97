"""Parts of three contacts with the same pitch curve, and random specifications of them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields, replace
from typing import Final

import pytest
import shapely
from hypothesis import strategies as st

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.path import whole
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.kinematics.plan import MotionPlan
from camgeo.part.assembly import build_part
from camgeo.part.boundaries import ExactBoundary
from camgeo.part.part import Boundary, Part
from camgeo.part.spec import (
    SIDES,
    Chamfer,
    Chamfers,
    Counterbore,
    DShaft,
    Holes,
    Hub,
    Keyway,
    Mark,
    PartSpec,
)
from tests.contour.cams import dwell, move
from tests.measuring import polygon

ROLLER: Final = 8.0

PITCH: Final = PitchCurve(
    MotionPlan((dwell(60), move(120, 15.0), dwell(60), move(120, 0.0))),
    TranslatingRoller(40.0, ROLLER),
    1,
)
"""From 40 to 55 mm: inner flank from 32 to 47, outer one from 48 to 63 mm."""

FLANKS: Final = {
    Contact.INNER: "outline", Contact.OUTER: "outline", Contact.GROOVE: "inner flank",
}  # fmt: skip

INNER, OUTER = whole(WorkingCurve(PITCH, -ROLLER)), whole(WorkingCurve(PITCH, ROLLER))

DISC: Final = PartSpec(thickness=10.0, bore=20.0, rim=140.0, groove_depth=4.0)


@contextmanager
def refused(key: str, message: str = ".") -> Iterator[None]:
    """What is done within raises a GeometryError of this key, with this message."""
    with pytest.raises(GeometryError, match=message) as caught:
        yield
    assert caught.value.key == key


def circle(name: str, radius: float, centre: complex = 0j, *, hole: bool = False) -> ExactBoundary:
    """A round boundary."""
    return ExactBoundary(name, hole, Contour.circle(radius, centre))


def walls_of(part: Part) -> list[tuple[str, float, float]]:
    """Names of the walls, from where they reach and to where."""
    return [(wall.boundary.name, wall.z0, wall.z1) for wall in part.walls]


def polygon_of(boundary: Boundary, tolerance: float = 1e-3) -> shapely.Polygon:
    """What a boundary encloses, within twice the tolerance [mm]."""
    return polygon(boundary.arcs(tolerance, "fast").contour.points(tolerance))


def made(contact: Contact, spec: PartSpec) -> Part:
    """The part with these flanks."""
    return build_part(contact, INNER, OUTER, spec, 0.01)


def made_or_refused(contact: Contact, spec: PartSpec) -> Part | None:
    """The part; None if it is refused with a key of the scene."""
    try:
        return made(contact, spec)
    except GeometryError as error:
        if (error.key or "").startswith("part."):
            return None
        raise


_angles = st.floats(-2.0 * math.pi, 2.0 * math.pi)


def _holes() -> st.SearchStrategy[Holes]:
    return st.builds(Holes, st.integers(1, 8), st.floats(20.0, 130.0), st.floats(1.0, 9.0), _angles)


@st.composite
def _bolts(draw: st.DrawFn) -> Holes:
    holes = draw(_holes())
    if not draw(st.booleans()):
        return holes
    wide = holes.hole * draw(st.floats(1.05, 2.5))
    return replace(holes, counterbore=Counterbore(wide, draw(st.floats(0.2, 8.0))))


@st.composite
def chamfers(draw: st.DrawFn) -> Chamfers:
    """Of edges that a part may have or not."""
    some = st.none() | st.builds(Chamfer, st.floats(0.2, 6.0), st.sampled_from(SIDES))
    return Chamfers(**{field.name: draw(some) for field in fields(Chamfers)})


@st.composite
def specs(draw: st.DrawFn) -> PartSpec:
    """Specifications of parts, most of them possible."""
    bore = draw(st.none() | st.floats(5.0, 40.0))
    keyway = None
    if bore is not None and draw(st.booleans()):
        keyway = Keyway(draw(st.floats(0.1, 0.6)) * bore, draw(st.floats(0.5, 4.0)), draw(_angles))
    flat = None
    if bore is not None and keyway is None and draw(st.booleans()):
        flat = DShaft(draw(st.floats(0.51, 0.99)) * bore, draw(_angles))
    bolts, light = draw(st.none() | _bolts()), draw(st.none() | _holes())
    hub = None
    if draw(st.booleans()):
        diameter = (bore or 10.0) + draw(st.floats(1.0, 30.0))
        hub = Hub(diameter, draw(st.floats(0.5, 20.0)), draw(st.sampled_from(SIDES)))
    mark = None
    if draw(st.booleans()):
        width = draw(st.floats(0.5, 3.0))
        length = draw(st.none() | st.floats(1.1 * width, 8.0))
        radius, depth = draw(st.floats(10.0, 68.0)), draw(st.floats(0.2, 4.9))
        mark = Mark(radius, width, depth, length, draw(_angles))
    return PartSpec(
        thickness=draw(st.floats(5.0, 20.0)),
        bore=bore,
        keyway=keyway,
        rim=draw(st.floats(127.0, 150.0)),
        groove_depth=draw(st.floats(0.5, 4.9)),
        hub=hub,
        mark=mark,
        d_shaft=flat,
        bolt_circle=bolts,
        lightening_holes=light,
    )


GAPS: Final = (0.0, 1e-12, 1e-9, 1e-6, 1e-5, 1e-4, 1e-3, 2e-3, 0.01, 0.03, 0.1, 0.3)
"""Between walls [mm]."""


@st.composite
def tight_specs(draw: st.DrawFn) -> PartSpec:
    """Specifications of parts whose features nearly touch each other or a flank, or do."""
    gap = st.sampled_from(GAPS).map(lambda each: 2.0 * each)
    bore = draw(st.sampled_from([12.0, 20.0]))
    hub = bore + draw(gap | st.floats(0.01, 20.0))
    hole = draw(st.sampled_from([0.05, 1.0, 4.0]))
    count = draw(st.sampled_from([1, 2, 7, 30]))
    neighbours = (hole + draw(gap)) / math.sin(math.pi / max(count, 2))
    circle = draw(
        st.sampled_from([bore + hole, hub - hole, hub + hole, 64.0 - hole, neighbours])
    ) + draw(st.sampled_from([-1.0, 1.0])) * draw(gap)
    light = Holes(count, circle, hole, draw(_angles)) if circle > 0.0 else None
    bolts = draw(st.none() | _holes())
    if bolts is not None:
        bolts = replace(bolts, counterbore=Counterbore(bolts.hole + draw(gap) + 1e-9, 3.0))
    keyway = None
    if draw(st.booleans()):
        width = bore * draw(st.sampled_from([1e-4, 0.3, 0.999]))
        keyway = Keyway(width, draw(st.sampled_from([1e-6, 0.01, 3.0])), draw(_angles))
    mark = None
    if draw(st.booleans()):
        wide = draw(st.sampled_from([0.1, 2.0]))
        radius = draw(st.sampled_from([hub, bore, 64.0, 94.0])) / 2.0 + wide / 2.0 + draw(gap)
        mark = Mark(radius, wide, 0.5, None, draw(_angles))
    return PartSpec(
        thickness=10.0,
        bore=bore,
        keyway=keyway,
        rim=126.1,
        groove_depth=5.0,
        hub=Hub(hub, 4.0, draw(st.sampled_from(SIDES))) if hub > bore else None,
        mark=mark,
        bolt_circle=bolts,
        lightening_holes=light,
    )
