"""Motion plan and motion diagram (VDI 2143-1, section 3) over the cam angle.

The plan (Bewegungsplan) shows what is asked: joints, numbered, with their motion tasks, and the law
of each segment. The diagram (Bewegungsdiagramm) below shows what the follower does: lift and three
derivatives. With a linkage the plan is the slider's, the diagram the follower's.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from camgeo.figure import motion_diagram as diagram
from camgeo.figure import motion_plan as plan
from camgeo.figure.layout import Size
from camgeo.figure.marks import Text
from camgeo.figure.model import Entry, Figure, Legend
from camgeo.figure.motion_diagram import Unit
from camgeo.figure.strips import Strips
from camgeo.figure.style import LEFT, RIGHT
from camgeo.files.moving import Moving
from camgeo.files.product import Product
from camgeo.files.sketch import PlanSketch
from camgeo.units import MM_PER, RPM

SIZE = (7.0, 10.0)

TOP, BOTTOM, HEADING = 0.32, 0.75, 0.34
"""Heights [inch] of the title, of what is below the diagram, and of the diagram's title."""

SECOND_SCALE: Final = 0.75
"""Right margin [inch] with a second scale."""

ANGLES: Final = {"lever": "χ", "crank": "θ"}
"""Symbols of demanded angles that are not the follower's own."""


def figure(product: Product | Moving, size: Size = SIZE) -> Figure:
    """The motion plan above s, s', s'', s''' of the follower."""
    sketch = product.pictured.plan_sketch
    strips = Strips(size, LEFT, RIGHT if sketch.speed is None else SECOND_SCALE)
    unit = _unit(product, sketch.unit)
    if sketch.of in ANGLES:
        unit = replace(unit, symbol=ANGLES[sketch.of])
    strips.skip(TOP)
    panels = plan.panels(strips, sketch, unit, HEADING + diagram.HEIGHT + BOTTOM)
    titles = (
        _title(strips, f"{product.name}: motion plan of the {sketch.of}", 0.14),
        _title(strips, _diagram_title(product, sketch), size[1] - strips.left_over + 0.2),
    )
    strips.skip(HEADING)
    panels += diagram.panels(strips, product, sketch, _unit(product, product.pictured.lift_unit))
    return Figure(size, tuple(panels), titles, _legend(strips, sketch))


def _title(strips: Strips, text: str, below_top: float) -> Text:
    """A title, its middle `below_top` [inch] below the figure's upper edge."""
    at = _middle(strips), 1.0 - below_top / strips.height
    return Text(text, at, 10.0, "figure", across="center", up="center")


def _middle(strips: Strips) -> float:
    return (strips.left + 0.5 * strips.across) / strips.width


def _unit(product: Product | Moving, unit: str) -> Unit:
    if unit == "mm":
        return Unit(product.unit, "s", 1.0 / MM_PER[product.unit])
    return Unit("°", "ψ", math.degrees(1.0))


def _diagram_title(product: Product | Moving, sketch: PlanSketch) -> str:
    what = "lift s" if product.pictured.lift_unit == "mm" else "swing ψ"
    behind = "" if sketch.of == "follower" else " behind the linkage"
    speed = "" if sketch.speed is None else f" (right: at {sketch.speed / RPM:.4g} rev/min)"
    return f"motion diagram: {what} of the follower{behind}{speed}"


def _legend(strips: Strips, sketch: PlanSketch) -> Legend:
    segments = sketch.segments
    found = []
    if any(segment.is_dwell for segment in segments):
        found.append(Entry("dwell", plan.REST))
    if any(segment.course is None and not segment.is_dwell for segment in segments):
        found.append(Entry("move, made by its law", plan.MOVE))
    if any(segment.course is not None for segment in segments):
        found.append(Entry("motion by data", plan.DATA))
    found.append(Entry("joint", plan.JOINT))
    if diagram.infinite_at(sketch, 3):
        text = f"infinite: {'shock or ' if diagram.infinite_at(sketch, 2) else ''}jerk"
        found.append(Entry(text, diagram.INFINITE))
    anchor = _middle(strips), 0.05 / strips.height
    return Legend(tuple(found), "lower center", anchor, len(found))
