"""Diagram of a crank-slide: phi, omega_2 and eps_2 over one turn of the crank, extremes marked.

A panel a quantity, one under the other: in one panel, as the SAM exercise has them, each would need
a scale of its own.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from camgeo.mechanism.crank_slide_drive import DrivenSlide, Quantity, SlideExtreme
from camgeo.numeric.arrays import FloatArray
from camgeo.units import RPM, TURN
from camgeo_export.plots.file import figure_file
from camgeo_export.plots.style import AUXILIARY, LINE, SAMPLES

WIDTH, HEIGHT = 7.4, 8.0
LEFT, RIGHT, TOP, BOTTOM = 0.85, 0.3, 0.85, 0.55
"""Sizes [inch]."""

DEGREE_STEPS: Final = (1.0, 1.5, 3.0, 4.5, 6.0, 9.0, 10.0)
"""Between ticks of an angle, times a power of ten: 15, 30, 45, 60, 90 degrees."""

POWERS: Final = (-3, 4)
"""Of ten: numbers at the ticks beyond these have the power in common, so that they fit."""

HEADROOM: Final = 0.18
"""Above and below a curve, as a share of its range: room for the values."""

PANELS: Final[tuple[tuple[Quantity, str, str], ...]] = (
    ("angle", "slide angle φ", "°"),
    ("velocity", "angular velocity ω$_2$", "rad/s"),
    ("acceleration", "angular acceleration ε$_2$", "rad/s²"),
)
"""Quantity, its name and its unit, in the order of `DrivenSlide.output`."""

CURVE: Any = {"color": LINE, "linewidth": 1.4}
EXTREME: Any = {"marker": "o", "markersize": 4.2, "color": "black", "linestyle": "none"}
OPEN: Any = {**EXTREME, "markerfacecolor": "white", "clip_on": False}
STROKE: Any = {"color": AUXILIARY, "linewidth": 0.8, "linestyle": (0, (5, 2))}


def render(driven: DrivenSlide, suffix: str) -> bytes:
    """The diagram as a file of kind `suffix`: ".svg", ".png" or ".pdf".

    Raises
    ------
    ValueError
        If there is no such kind of figure.
    """
    return figure_file(lambda: draw(driven), suffix)


def draw(driven: DrivenSlide) -> Figure:
    """The diagram, a panel a quantity, with the extremes as dots and their values beside them."""
    figure = Figure(figsize=(WIDTH, HEIGHT))
    FigureCanvasAgg(figure)
    panels = figure.subplots(
        len(PANELS),
        sharex=True,
        gridspec_kw={
            "left": LEFT / WIDTH,
            "right": 1.0 - RIGHT / WIDTH,
            "top": 1.0 - TOP / HEIGHT,
            "bottom": BOTTOM / HEIGHT,
            "hspace": 0.1,
        },
    )
    theta = crank_angles(driven)
    output = driven.output(theta)
    for axes, curve, (quantity, name, unit) in zip(panels, output, PANELS, strict=True):
        scale = np.degrees(1.0) if quantity == "angle" else 1.0
        axes.axhline(0.0, color="black", linewidth=0.5)
        axes.plot(np.degrees(theta), scale * curve, **CURVE)
        axes.set_ylabel(f"{name} [{unit}]")
        axes.margins(y=HEADROOM)
        axes.ticklabel_format(axis="y", style="sci", scilimits=POWERS)
        for stroke in driven.strokes or ():
            axes.axvline(np.degrees(stroke.start), zorder=1.5, **STROKE)
        for extreme in driven.extremes:
            if extreme.quantity == quantity:
                _mark(axes, extreme, scale, unit)
    if not driven.extremes:  # R = a: phi has no value at 0 and 360 degrees, only limits
        panels[0].plot([0.0, 360.0], [-90.0, 90.0], **OPEN)
    panels[0].yaxis.set_major_locator(MaxNLocator(7, steps=DEGREE_STEPS))
    figure.align_ylabels(panels)
    foot = panels[-1]
    foot.set_xlim(0.0, 360.0)
    foot.set_xticks(np.arange(0.0, 361.0, 30.0))
    foot.set_xlabel("crank angle θ [°]")
    _time_axis(panels[0], driven)
    figure.suptitle(_title(driven), y=1.0 - 0.18 / HEIGHT, fontsize=11.0, va="top")
    return figure


def crank_angles(driven: DrivenSlide) -> FloatArray:
    """Crank angles of the curves within one turn [rad], ascending.

    Dense where the pin passes near the slide's axis: there all happens within about the angle at
    which the acceleration is largest, which may be far less than the step elsewhere. For R = a
    without the ends, where phi is undefined.
    """
    even = np.linspace(0.0, TURN, SAMPLES)
    if not driven.extremes:
        return even[1:-1]
    peak = driven.slide.largest_acceleration.place
    near = peak * np.geomspace(1e-2, 1e3, 401)
    near = near[near < np.pi]
    places = [extreme.crank for extreme in driven.extremes]
    return np.unique(np.concatenate((even, near, TURN - near, places)))


def _mark(axes: Axes, extreme: SlideExtreme, scale: float, unit: str) -> None:
    """A dot at the extreme, its value and its crank angle outside the curve."""
    place, value = float(np.degrees(extreme.crank)), scale * extreme.value
    places = [place, 360.0] if place == 0.0 else [place]  # one turn on the same extreme again
    axes.plot(places, [value] * len(places), zorder=3, clip_on=False, **EXTREME)
    told = f"{value + 0.0:.5g}".replace("-", "−")
    space = "" if unit == "°" else " "
    text = f"{told}{space}{unit} at {place:.4g}°"
    left = place <= 180.0
    inside = 60.0 < place < 300.0
    axes.annotate(
        text,
        (place, value),
        xytext=(0 if inside else 7 if left else -7, 6 if extreme.largest else -6),
        textcoords="offset points",
        ha="center" if inside else "left" if left else "right",
        va="bottom" if extreme.largest else "top",
        fontsize=8.0,
        zorder=4,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 0.8},
    )


def _time_axis(axes: Axes, driven: DrivenSlide) -> None:
    """The time over the upper edge of `axes`."""
    above = axes.twiny()
    above.set_xlim(0.0, driven.turn_time)
    above.grid(visible=False)
    above.set_xlabel("time t [s]")


def _title(driven: DrivenSlide) -> str:
    slide = driven.slide
    kind = "swinging" if slide.swings else "R = a" if slide.crank == slide.distance else "turning"
    lengths = f"a = {slide.distance:.6g} mm, R = {slide.crank:.6g} mm"
    speed = f"{driven.speed / RPM:.6g} rev/min"
    ratio = f", time ratio {slide.time_ratio:.4g}" if slide.swings else ""
    return f"Crank-slide, {kind}: {lengths}, {speed}{ratio}"
