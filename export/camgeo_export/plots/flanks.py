"""The flanks where there is no disc: as they run, with what undercuts marked."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from camgeo.errors import GeometryError
from camgeo.files.product import CutOff, Product
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.units import TURN
from camgeo_export.plots import cut_off
from camgeo_export.plots.style import LIMIT, LINE, SAMPLES

FLANK: Any = {"color": LINE, "linewidth": 1.0}
UNDERCUT: Any = {"color": LIMIT, "linewidth": 2.2, "linestyle": (0, (1.5, 0.8))}
CUSP: Any = {**cut_off.CORNER, "color": LIMIT}

OF_UNDERCUT, OF_CUSP = "undercut-", "cusp-"
"""How the names of findings begin that tell where a flank undercuts; the flank's follows."""

RANGE = 721
"""Points of a range of cam angle."""

BESIDE = 4.0
"""How far a window shows a flank beside what is cut off, in times of its cam angle."""


def draw(
    axes: Axes, product: Product, found: tuple[CutOff, ...], scale: float
) -> list[ComplexArray]:
    """The flanks in use with their cusps and loops: there is no disc, but the reason shows."""
    lines = []
    for what in ("inner", "outer"):
        if product.contact not in (what, "groove"):
            continue
        for start, end in _left(found, what):
            try:
                phi = np.linspace(start, end, SAMPLES)
                points = _points(product, what, phi) * scale
            except GeometryError:  # the roller centre stands still in the cam
                continue
            axes.plot(points.real, points.imag, **FLANK)
            lines.append(points)
    for what, start, end in _undercut(product) if not found else ():
        points = _points(product, what, np.linspace(start, end, RANGE)) * scale
        axes.plot(points.real, points.imag, **UNDERCUT)
    for what, place in _cusps(product):
        (cusp,) = _points(product, what, np.array([place])) * scale
        axes.plot(cusp.real, cusp.imag, zorder=2.6, **CUSP)
    axes.text(0.02, 0.98, "no outline: undercut", transform=axes.transAxes, va="top")
    return lines


def draw_near(
    axes: Axes, product: Product, found: tuple[CutOff, ...], middle: complex, width: float
) -> None:
    """Draw what lies in and about the square of side `width` [mm] round `middle`, in mm."""
    shares = np.linspace(0.0, 1.0, RANGE)
    reach = BESIDE * max(each.end - each.start for each in found)
    for what in {each.flank: None for each in found}:
        for start, end in _left(found, what):
            length = min(reach, end - start)
            for phi in (start + length * shares, end - length * shares):
                line = cut_off.near(_points(product, what, phi), middle, width)
                axes.plot(line.real, line.imag, **FLANK)


def handles(product: Product, found: tuple[CutOff, ...]) -> list[Line2D]:
    """For the legend: what is marked."""
    marks = cut_off.handles("would be cut off") if found else []
    if not found and _undercut(product):
        marks.append(Line2D([], [], label="undercut", **UNDERCUT))
    if _cusps(product):
        marks.append(Line2D([], [], label="cusp", **CUSP))
    return marks


def note(axes: Axes) -> list[ComplexArray]:
    """Lines about the words that `draw` writes, once the limits of `axes` are set."""
    (left, right), (_, high) = axes.get_xlim(), axes.get_ylim()
    height = 0.03 * (right - left)
    return [np.array([left, left + 12.0 * height]) + 1j * (high - down) for down in (0.0, height)]


def _left(found: tuple[CutOff, ...], flank: str) -> list[tuple[float, float]]:
    """Ranges of cam angle [rad] of a flank that would not be cut off."""
    own = sorted((each.start, each.end) for each in found if each.flank == flank)
    if not own:
        return [(0.0, TURN)]
    following = [*(start for start, _ in own[1:]), own[0][0] + TURN]
    pairs = [(end, start) for (_, end), start in zip(own, following, strict=True)]
    return [(start, end) for start, end in pairs if end > start]


def _undercut(product: Product) -> list[tuple[str, float, float]]:
    """Flank and cam angles [rad] of each range that undercuts."""
    return [
        (finding.name.removeprefix(OF_UNDERCUT), start, end if end > start else end + TURN)
        for finding in product.findings
        if finding.name.startswith(OF_UNDERCUT) and finding.cam_range is not None
        for start, end in [finding.cam_range]
    ]


def _cusps(product: Product) -> list[tuple[str, float]]:
    """Flank and cam angle [rad] of each cusp without undercut."""
    return [
        (finding.name.removeprefix(OF_CUSP), finding.cam_angle)
        for finding in product.findings
        if finding.name.startswith(OF_CUSP) and finding.cam_angle is not None
    ]


def _points(product: Product, what: str, phi: FloatArray) -> ComplexArray:
    columns = product.curve(what, phi)
    points: ComplexArray = columns[:, 0] + 1j * columns[:, 1]
    return points
