"""A plate cam, a ring and a groove with round flanks, to be milled."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from camgeo.cam.cam import Contact
from camgeo.geometry.outline.path import whole
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.kinematics.plan import MotionPlan
from camgeo.milling.cut import Cut
from camgeo.milling.milling import Heights, Holding, MillingSpec, OperationSpec, Stock, Tool
from camgeo.milling.planned import CutSequence, plan_sequence
from camgeo.part.assembly import build_part
from camgeo.part.part import Part
from camgeo.part.spec import Holes, Hub, Mark, PartSpec
from tests.contour.cams import dwell, move

ROLLER = 8.0

PITCH = PitchCurve(
    MotionPlan((dwell(50), move(100, 20.0), dwell(70), move(140, 0.0))),
    TranslatingRoller(40.0, ROLLER, 6.0),
    1,
)

THICKNESS, BORE, RIM = 10.0, 25.0, 150.0

SPEC = PartSpec(thickness=THICKNESS, bore=BORE, rim=RIM, groove_depth=6.0)

HEIGHTS = Heights(20.0, 12.0)

Operations = tuple[OperationSpec, ...]

FIXTURE = Holding(kind="fixture", through=0.5)


HOOKED = PitchCurve(
    MotionPlan((dwell(60), move(40, 100.0), dwell(20), move(30, 0.0), dwell(210))),
    TranslatingRoller(35.0, 5.0, -20.0),
    -1,
)
"""Its flanks are so steep that rays from the cam axis meet them more than once."""


def part(contact: Contact, spec: PartSpec = SPEC, pitch: PitchCurve = PITCH) -> Part:
    """As programs see it."""
    roller = pitch.follower.roller_radius
    inner, outer = (whole(WorkingCurve(pitch, distance)) for distance in (-roller, roller))
    return build_part(contact, inner, outer, spec, 0.01).lowered()


def tool(diameter: float, number: int = 1, **own: Any) -> Tool:
    given = {
        "spindle_speed": 3000.0, "feed": 300.0, "plunge_feed": 100.0, "stepdown": 3.0,
        "stepover": 0.2 * diameter, **own,
    }  # fmt: skip
    return Tool(number=number, diameter=diameter, **given)


def sequence(
    contact: Contact,
    *tools: Tool,
    stock: Stock | None = None,
    holding: Holding | None = FIXTURE,
    operations: Operations = (),
    spec: PartSpec = SPEC,
    heights: Heights = HEIGHTS,
    pitch: PitchCurve = PITCH,
) -> CutSequence:
    milling = MillingSpec(
        tools=tools or (tool(12.0),), stock=stock or Stock(), holding=holding, operations=operations
    )
    return plan_sequence(part(contact, spec, pitch), milling, heights)


def operation(kind: str, boundary: str = "", tool: int = 1, **own: Any) -> OperationSpec:
    return OperationSpec(kind=kind, tool=tool, boundary=boundary, **own)


MILL = tool(12.0)
DRILL = tool(20.0, 2, kind="drill", tip_angle=2.0, stepdown=5.0)
POINTED = tool(10.0, 3, kind="chamfer-mill", tip_angle=0.5 * math.pi)
SLOTTER = tool(2.0 * ROLLER, 4)
SHARP = tool(4.0, 5, kind="chamfer-mill", tip_angle=0.52)
BLUNT = tool(40.0, 6, kind="chamfer-mill", tip_angle=2.9)

TOOLS = (MILL, DRILL, POINTED, SLOTTER, SHARP, BLUNT)
"""Of stated operations, by their numbers."""

ENGRAVER = tool(2.0, 3, stepdown=0.3, stepover=None)

HUB_TOOLS = (
    tool(12.0, flute_length=20.0, stick_out=30.0, stepdown=8.0, stepover=5.0),
    tool(4.0, 2, kind="drill", tip_angle=2.0, stepdown=None, stepover=None),
    ENGRAVER,
)
"""Mill, drill and engraver of what is `HUBBED`."""

HUBBED = replace(
    SPEC,
    hub=Hub(40.0, 6.0),
    mark=Mark(26.0, 2.0, 0.5, 5.0, angle=1.0),
    bolt_circle=Holes(3, 52.0, 4.0),
)
"""A disc of 10 mm below a hub of 6 mm, its base circle 32 mm in radius."""


def named(found: CutSequence) -> dict[str, Cut]:
    return {cut.name: cut for cut in found.cuts}
