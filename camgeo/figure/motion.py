"""Motion plan and motion diagram (VDI 2143-1, section 3) over the cam angle.

The plan (Bewegungsplan) shows the requirements: joints, numbered, with their motion tasks, and the
law of each segment. The diagram (Bewegungsdiagramm) below shows what the follower does: lift and
three derivatives. With a linkage the plan is that of its far end, and both ends have a diagram.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from camgeo.cam.drive import Drive
from camgeo.figure import motion_diagram as diagram
from camgeo.figure import motion_plan as plan
from camgeo.figure.layout import Size, Strips
from camgeo.figure.marks import Text
from camgeo.figure.model import Entry, Figure, Legend
from camgeo.figure.motion_diagram import Unit
from camgeo.figure.style import LEFT, RIGHT
from camgeo.motion.motion import Motion
from camgeo.product.product import Product
from camgeo.units import MM_PER, RPM, LengthUnit, LiftUnit

SIZE = (7.0, 10.0)
"""Of plan and one diagram; a second one adds its height."""

TOP, BOTTOM, HEADING = 0.32, 0.75, 0.34
"""Heights [inch] of the title, of what is below the diagrams, and of a diagram's title."""

NUMBERED = 0.42
"""Height [inch] of the numbers and name of the cam angle between two diagrams."""

SECOND_SCALE: Final = 0.75
"""Right margin [inch] with a second scale."""

ANGLES: Final = {"lever": "χ", "crank": "θ"}
"""Symbols of prescribed angles that are not the follower's own."""

WHAT: Final = {("s", "follower"): "lift", ("s", "slider"): "stroke", ("ψ", "follower"): "swing"}
"""What a position is called, by its symbol and whose it is."""

NAMES: Final = (
    (plan.REST, "dwell"),
    (plan.MOVE, "move, made by its law"),
    (plan.DATA, "motion by data"),
)


def figure(product: Product, size: Size | None = None) -> Figure:
    """The motion plan above s, s', s'', s''' of what is prescribed, and of the follower."""
    return of_drive(product.name, product.unit, product.cam.drive, product.cam.lift_unit, size)


def of_drive(
    name: str, length: LengthUnit, drive: Drive, lift_unit: LiftUnit, size: Size | None = None
) -> Figure:
    """The same for the design `name` without any cam.

    Parameters
    ----------
    length : unit of the scene.
    lift_unit : of the follower's own motion.
    """
    speed = drive.speed if drive.speed_curve is None else None
    sketch = plan.plan_sketch(drive.plan)
    unit = _unit(drive.unit, length)
    if drive.demanded_of in ANGLES:
        unit = replace(unit, symbol=ANGLES[drive.demanded_of])
    ends: list[tuple[str, Motion, Unit]] = [(drive.demanded_of, drive.plan, unit)]
    if drive.linkage is not None:
        ends.append(("follower", drive.motion, _unit(lift_unit, length)))
    size = size or (SIZE[0], SIZE[1] + (len(ends) - 1) * (HEADING + NUMBERED + diagram.HEIGHT))
    strips = Strips(size, LEFT, RIGHT if speed is None else SECOND_SCALE)
    strips.skip(TOP)
    below = len(ends) * (HEADING + diagram.HEIGHT) + (len(ends) - 1) * NUMBERED + BOTTOM
    panels = plan.panels(strips, sketch, unit, below)
    titles = [_title(strips, f"{name}: motion plan of the {drive.demanded_of}", 0.14)]
    right = "" if speed is None else f" (right: at {speed / RPM:.4g} rev/min)"
    for number, (whose, motion, own) in enumerate(ends):
        strips.skip(NUMBERED if number else 0.0)
        behind = " behind the linkage" if number else ""
        what = WHAT.get((own.symbol, whose), "angle")
        heading = f"motion diagram: {what} {own.symbol} of the {whose}{behind}{right}"
        titles.append(_title(strips, heading, size[1] - strips.left_over + 0.2))
        strips.skip(HEADING)
        panels += diagram.panels(strips, drive.plan, motion, own, speed)
    drawn = {segment.style for segment in sketch.segments}
    entries = [Entry(name, style) for style, name in NAMES if style in drawn]
    entries.append(Entry("joint", plan.JOINT))
    shocks, jerks = (diagram.infinite_at(drive.plan, drive.plan, order) for order in (2, 3))
    if jerks:
        text = f"infinite: {'shock or ' if shocks else ''}jerk"
        entries.append(Entry(text, diagram.INFINITE))
    anchor = _middle(strips), 0.05 / strips.height
    legend = Legend(tuple(entries), "lower center", anchor, len(entries))
    return Figure(size, tuple(panels), tuple(titles), legend)


def _title(strips: Strips, text: str, below_top: float) -> Text:
    """A title, its middle `below_top` [inch] below the figure's upper edge."""
    at = _middle(strips), 1.0 - below_top / strips.height
    return Text(text, at, 10.0, "figure", across="center", up="center")


def _middle(strips: Strips) -> float:
    return (strips.left + 0.5 * strips.across) / strips.width


def _unit(unit: LiftUnit, length: LengthUnit) -> Unit:
    if unit == "mm":
        return Unit(length, "s", 1.0 / MM_PER[length])
    return Unit("°", "ψ", math.degrees(1.0))
