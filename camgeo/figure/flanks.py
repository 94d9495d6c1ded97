"""The flanks if there is no disc: the full curves, with undercut marked."""

from __future__ import annotations

import numpy as np

from camgeo.errors import GeometryError
from camgeo.figure import cut_off
from camgeo.figure.marks import Line, Mark, Style, Text, plane
from camgeo.figure.model import Entry
from camgeo.figure.style import LIMIT, LINE, SAMPLES
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.outline.path import Flank
from camgeo.product.pictured import CutOff
from camgeo.product.product import Product
from camgeo.units import TURN

FLANK = Style(LINE, 1.0)
UNDERCUT = Style(LIMIT, 2.2, (1.5, 0.8))
CUSP = Style(LIMIT, 0.0, marker="D", size=4.2, edge="white", edge_width=0.6)

OF_UNDERCUT, OF_CUSP = "undercut-", "cusp-"
"""Prefixes of the names of findings on undercut; the name of the flank follows."""

RANGE = 721
"""Points per range of cam angle."""

BESIDE = 4.0
"""How far a window shows a flank on either side of the cut-off part, relative to its cam angle."""


def whole(
    product: Product, found: tuple[CutOff, ...], scale: float
) -> tuple[list[Mark], list[ComplexArray]]:
    """The flanks in use with their cusps and loops, the reason that there is no disc."""
    lines = []
    for flank in product.cam.contact.flanks:
        for start, end in _left(found, flank):
            try:
                lines.append(_points(product, flank, np.linspace(start, end, SAMPLES)) * scale)
            except GeometryError:  # the roller centre stands still in the cam
                continue
    marks: list[Mark] = [Line(plane(points), FLANK) for points in lines]
    for what, start, end in _undercut(product) if not found else ():
        points = _points(product, what, np.linspace(start, end, RANGE)) * scale
        marks.append(Line(plane(points), UNDERCUT))
    for what, place in _cusps(product):
        cusp = _points(product, what, np.array([place])) * scale
        marks.append(Line(plane(cusp), CUSP, layer=2.6))
    marks.append(Text("no outline: undercut", (0.02, 0.98), 9.0, "panel", up="top"))
    return marks, lines


def near(product: Product, found: tuple[CutOff, ...], middle: complex, width: float) -> list[Mark]:
    """What lies in and near the square of side `width` [mm] around `middle`, in mm."""
    shares = np.linspace(0.0, 1.0, RANGE)
    reach = BESIDE * max(each.end - each.start for each in found)
    marks: list[Mark] = []
    for flank in {each.flank: None for each in found}:
        for start, end in _left(found, flank):
            length = min(reach, end - start)
            for phi in (start + length * shares, end - length * shares):
                line = cut_off.near(_points(product, flank, phi), middle, width)
                marks.append(Line(plane(line), FLANK))
    return marks


def names(product: Product, found: tuple[CutOff, ...]) -> list[Entry]:
    """Names for the legend: what is marked."""
    marked = cut_off.names("would be cut off") if found else []
    if not found and _undercut(product):
        marked.append(Entry("undercut", UNDERCUT))
    if _cusps(product):
        marked.append(Entry("cusp", CUSP))
    return marked


def note(x: cut_off.Limits, y: cut_off.Limits) -> list[ComplexArray]:
    """Lines around the text in the corner of a picture with these limits."""
    (left, right), (_, high) = x, y
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


def _points(product: Product, flank: str, phi: FloatArray) -> ComplexArray:
    return product.cam.disc.curve(Flank(flank)).point(phi)
