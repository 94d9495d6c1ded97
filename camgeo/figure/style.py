"""What all our figures share: colours, margins, and axes of cam angle.

Colours also differ in lightness, and kinds of line differ in their dashes, so that a print in grey
can be read.
"""

from __future__ import annotations

import numpy as np

from camgeo.figure.layout import Margins, Size, grid
from camgeo.figure.marks import Mark, Rule, Style
from camgeo.figure.model import Axis, Figure, Legend, Panel, entries
from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN

LINE = "#12365c"
"""Colour of a figure's subject."""

LIMIT = "#b3261e"
"""Colour of limits; always dashed."""

AUXILIARY = "#4d4d4d"
"""Colour of construction lines."""

CURVE = Style(LINE)

LIMIT_STYLE = Style(LIMIT, 1.0, (3.7, 1.6))

RETURN_STYLE = Style("#b3541e", 1.4, (6.0, 2.0))
"""Style of the return disc of a conjugate pair over the main disc."""

ZERO = Rule("y", 0.0, Style("black", 0.5))
"""The line at zero."""

SAMPLES = 1441
"""Points of a diagram over the cam angle: a quarter of a degree, finer than a printed line."""

LEFT, RIGHT, TOP, BOTTOM = 0.8, 0.25, 0.4, 0.55
"""Margins around the axes [inch]."""

MARGINS: Margins = (LEFT, RIGHT, TOP, BOTTOM)

EVERY_30 = tuple(float(angle) for angle in range(0, 361, 30))


def cam_angles() -> FloatArray:
    """(SAMPLES,) cam angles over one turn [rad], both ends included."""
    return np.linspace(0.0, TURN, SAMPLES)


def diagram_angles(joints: tuple[float, ...]) -> FloatArray:
    """Cam angles over one turn [rad] with both sides of each joint, where a value may jump."""
    step = 1e-9
    sides = [angle + side for angle in joints for side in (-step, step)]
    angles = np.concatenate((cam_angles(), np.array(sides)))
    return np.unique(np.clip(angles, 0.0, TURN - step))


def turn_axis(*, label: str = "cam angle φ [°]", numbered: bool = True) -> Axis:
    """The axis of one turn in degrees, with its label if it has numbers."""
    return Axis((0.0, 360.0), label if numbered else "", ticks=EVERY_30, numbered=numbered)


def diagram(
    size: Size, title: str, y: Axis, marks: list[Mark], joints: tuple[float, ...]
) -> Figure:
    """A figure of one panel over the cam angle, with a legend and its `joints` [rad]."""
    legend = Legend(entries(marks))
    everything = (*marks, *joint_marks(joints))
    panel = Panel(grid(size, MARGINS)[0], turn_axis(), y, everything, title, legend=legend)
    return Figure(size, (panel,))


def joint_marks(joints: tuple[float, ...]) -> list[Mark]:
    """A dotted line at each of the `joints` [rad]."""
    dotted = Style(AUXILIARY, 0.7, (1.0, 2.0))
    return [Rule("x", float(np.degrees(joint)), dotted) for joint in joints]
