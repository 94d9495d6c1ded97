"""What all our figures share: sizes, line widths, and a way to say cam angles.

Colours differ in lightness too, and kinds of line differ in their dashes, so that a print in grey
can be read.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN

RC: Any = {
    "font.family": "DejaVu Sans",  # comes with matplotlib: the same bytes on each machine
    "font.size": 9.0,
    "axes.linewidth": 0.7,
    "axes.titlesize": 11.0,
    "axes.labelsize": 9.0,
    "axes.grid": True,
    "grid.color": "#d4d4d4",
    "grid.linewidth": 0.5,
    "axes.axisbelow": True,
    "lines.linewidth": 1.4,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "legend.fontsize": 8.0,
    "legend.frameon": True,
    "legend.framealpha": 1.0,
    "legend.edgecolor": "#a0a0a0",
    "legend.fancybox": False,
    "axes.unicode_minus": True,
    "svg.fonttype": "path",
}

LINE = "#12365c"
"""Colour of what a figure is about."""

LIMIT = "#b3261e"
"""Colour of limits; always dashed."""

AUXILIARY = "#4d4d4d"
"""Colour of construction lines."""

RETURN_STYLE: Any = {"color": "#b3541e", "linewidth": 1.4, "dashes": (6, 2)}
"""How the return disc of a conjugate pair is drawn over the main disc."""

SAMPLES = 1441
"""Points of a diagram over the cam angle: a quarter of a degree, finer than a printed line."""


LEFT, RIGHT, TOP, BOTTOM = 0.8, 0.25, 0.4, 0.55
"""Margins around the axes [inch]. Fixed: matplotlib's layout engines differ in the last digits from
run to run, and with them the bytes of the file."""


def frame(figure: Figure | SubFigure, bottom: float = BOTTOM) -> dict[str, float]:
    """Edges of the axes as shares of `figure`, for its `subplots`."""
    width, height = figure.bbox.width / figure.dpi, figure.bbox.height / figure.dpi
    return {
        "left": LEFT / width,
        "right": 1.0 - RIGHT / width,
        "top": 1.0 - TOP / height,
        "bottom": bottom / height,
    }


def cam_angles() -> FloatArray:
    """(SAMPLES,) cam angles over one turn [rad], both ends included."""
    return np.linspace(0.0, TURN, SAMPLES)


def diagram_angles(joints: tuple[float, ...]) -> FloatArray:
    """Cam angles over one turn [rad] with both sides of each joint, where a value may jump."""
    step = 1e-9
    sides = [angle + side for angle in joints for side in (-step, step)]
    angles = np.concatenate((cam_angles(), np.array(sides)))
    return np.unique(np.clip(angles, 0.0, TURN - step))


def over_cam_angle(axes: Axes, joints: tuple[float, ...], label: bool = True) -> None:
    """Scale the axis of `axes` for one turn in degrees, and mark the `joints` [rad]."""
    axes.set_xlim(0.0, 360.0)
    axes.set_xticks(np.arange(0.0, 361.0, 30.0))
    for joint in joints:
        axes.axvline(np.degrees(joint), color=AUXILIARY, linewidth=0.7, linestyle=(0, (1, 2)))
    if label:
        axes.set_xlabel("cam angle φ [°]")
    else:
        axes.tick_params(labelbottom=False)
