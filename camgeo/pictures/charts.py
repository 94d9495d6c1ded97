"""Diagrams of a design over the cam angle, and what they say in words and numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np

from camgeo.design.design import Design
from camgeo.design.product import Product
from camgeo.pictures import effects, motion
from camgeo.pictures.model import Figure, Line, Panel, Rule
from camgeo.pictures.motion import DOWNWARDS, INFINITE

TOGETHER: Final = 6
"""Most panels of effects in a diagram: as many as fit on a sheet."""

MOTION: Final = "motion plan and diagrams"
"""Title of the first diagram."""


@dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """A diagram over the cam angle.

    Attributes
    ----------
    title : what it shows.
    figure : the diagram.
    readings : the extremes of its curves.
    """

    title: str
    figure: Figure
    readings: tuple[Reading, ...]

    @property
    def sentence(self) -> str:
        """The first curves in words."""
        told = [
            f"{plain(each.name)} from {shown(each.low)} at {math.degrees(each.low_at):.1f}° to"
            f" {shown(each.high)} at {math.degrees(each.high_at):.1f}°"
            for each in self.readings[:TOLD]
        ]
        more = len(self.readings) - TOLD
        return "; ".join(told) + (f"; {more} more in the table" if more > 0 else "") + "."


def motion_diagram(design: Design) -> Figure:
    """The motion plan, and the motion over the cam angle."""
    scene = design.scene
    return motion.of_drive(design.name, scene.unit, design.drive, scene.lift_unit)


def disc_diagrams(design: Design) -> Iterator[tuple[str, str, partial[Figure]]]:
    """Name, title and maker of each diagram that shows a disc, one after the other."""
    for disc in design.discs:
        name, of = ("", "") if disc is design.disc else ("-return", f" of {disc.name}")
        angle = partial(motion.transmission_angle, disc)
        yield f"transmission{name}", f"transmission angle{of}", angle
        yield f"curvature{name}", f"curvature{of}", partial(motion.curvature, disc)


def of_effects(disc: Product) -> Iterator[tuple[str, partial[Figure]]]:
    """Title and maker of each diagram of the scene's effects, of at most TOGETHER panels."""
    groups = effects.panels(disc.columns())
    parts = [groups[k : k + TOGETHER] for k in range(0, len(groups), TOGETHER)]
    for number, part in enumerate(parts, start=1):
        chosen = tuple(column for group in part for column in group)
        share = f", {number} of {len(parts)}" if len(parts) > 1 else ""
        one = replace(disc, columns=partial(tuple, chosen))
        yield f"forces and effects{share}", partial(effects.figure, one)


# -- readings -------------------------------------------------------------------------------------
# What a diagram over the cam angle says, in numbers: the extremes of each of its curves.


CURVE: Final = 100
"""A line of fewer points is no curve over the turn but a joint, a spike, or part of a plan."""

TOLD: Final = 4
"""Most curves of a diagram in its sentence; the table has all."""


@dataclass(frozen=True, slots=True)
class Reading:
    """The extremes of one curve.

    Attributes
    ----------
    name : of the quantity, with its unit in brackets.
    low, high : smallest and largest value, infinite where the diagram says so.
    low_at, high_at : cam angles of the first of each [rad].
    limits : with which it is compared, and what the diagram calls them.
    """

    name: str
    low: float
    low_at: float
    high: float
    high_at: float
    limits: tuple[tuple[str, float], ...] = ()


def readings(figure: Figure) -> tuple[Reading, ...]:
    """Those of all curves of a figure over the cam angle, from the top."""
    return tuple(each for panel in figure.panels for each in _of_panel(panel))


def shown(value: float) -> str:
    """Five digits, with a minus that is one."""
    if math.isinf(value):
        return "∞" if value > 0.0 else "−∞"
    return f"{value + 0.0:.5g}".replace("-", "−")


def plain(text: str) -> str:
    """A text of a figure without the signs of its subscripts."""
    return text.replace("$_", "").replace("$", "")


def _of_panel(panel: Panel) -> Iterator[Reading]:
    if panel.bare or panel.x.limits != (0.0, 360.0):
        return
    limits = tuple(
        (plain(mark.label), mark.at)
        for mark in panel.marks
        if isinstance(mark, Rule) and mark.axis == "y" and mark.label
    )
    beyond = {}
    for style, value in ((INFINITE, math.inf), (DOWNWARDS, -math.inf)):
        places = [
            float(mark.points[0, 0])
            for mark in panel.marks
            if isinstance(mark, Line) and mark.style == style
        ]
        if places:
            beyond[value] = min(places)
    for mark in panel.marks:
        if isinstance(mark, Line) and len(mark.points) > CURVE:
            x, y = mark.points.T
            low, high = int(np.nanargmin(y)), int(np.nanargmax(y))
            ends = [(float(y[k]), float(x[k])) for k in (low, high)]
            if -math.inf in beyond:
                ends[0] = -math.inf, beyond[-math.inf]
            if math.inf in beyond:
                ends[1] = math.inf, beyond[math.inf]
            name = _named(mark.label, panel.y.label)
            (lowest, low_at), (highest, high_at) = ends
            angles = math.radians(low_at), math.radians(high_at)
            yield Reading(name, lowest, angles[0], highest, angles[1], limits)


def _named(label: str, axis: str) -> str:
    """The name of a curve with the unit of its axis."""
    if not label or label.startswith("pitch curve") or label == "outline":
        return axis
    unit = axis[axis.index("[") :] if "[" in axis else ""
    return f"{label} {unit}".strip()
