"""A few designs over each other: their flanks, and motion, acceleration and transmission angle."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from camgeo.design.design import Design
from camgeo.design.value_table import Columns, bare, quantities
from camgeo.errors import GeometryError, SceneError
from camgeo.numeric.arrays import FloatArray
from camgeo.pictures.model import (
    SAMPLES,
    ZERO,
    Axis,
    Figure,
    Legend,
    Line,
    Mark,
    Panel,
    Style,
    box,
    diagram_angles,
    entries,
    grid,
    limits,
    over,
    plane,
    turn_axis,
)
from camgeo.units import MM_PER, TURN

WIDTH, HEIGHT = 11.0, 6.4
MIDDLE: Final = 5.6
"""Left edge of the diagrams [inch]."""

LEFT, RIGHT, TOP, BOTTOM = 0.8, 0.2, 0.4, 0.55
"""Margins [inch]."""

COLOURS: Final = (
    "#12365c", "#c05a00", "#2e7d32", "#8e24aa", "#6d4c41", "#0097a7", "#9e9d24", "#b3261e",
)  # fmt: skip
"""One for each design; their number is the most that can be told apart."""

SPELLED: Final = {"mu [": "transmission angle μ [", "psi": "ψ", "chi": "χ", "theta": "θ",
                  "alpha_": "α ", "^2": "²", "deg": "°"}  # fmt: skip

DASHES: Final = ((), (5.0, 2.0), (1.5, 1.5), (6.0, 1.5, 1.5, 1.5))
"""Kinds of line, in turn, for prints in grey."""


def figure(designs: Sequence[tuple[str, Design]]) -> Figure:
    """The designs by their names; what one of them does not have is left out."""
    size = WIDTH, HEIGHT
    flanks: list[Mark] = []
    rows: list[list[tuple[str, Line]]] = [[], [], []]
    for number, (name, design) in enumerate(designs):
        style = _style(number)
        flanks += _flanks(design, name, style)
        for row, found in zip(rows, _curves(design, style), strict=True):
            row += found
    panels = [_disc(flanks, designs[0][1].scene.unit)] if flanks else []
    left = MIDDLE if flanks else LEFT
    frames = grid(size, (left, RIGHT, TOP, BOTTOM), len(rows), 1, (0.12, 0.0))
    for number, (row, frame) in enumerate(zip(rows, frames, strict=True)):
        lines = [line for _, line in row]
        label = " or ".join(dict.fromkeys(_spelled(heading) for heading, _ in row))
        extent = limits([line.points[:, 1] for line in lines], [0.0])
        y = Axis(extent, label, powers=(-3, 5), label_place=0.62)
        turn = turn_axis(numbered=number == len(rows) - 1)
        panels.append(Panel(frame, turn, y, (*lines, ZERO)))
    names = [Line(over([], []), _style(number), name) for number, (name, _) in enumerate(designs)]
    legend = Legend(entries(names), "upper left", (LEFT / WIDTH, 1.0), len(names), pad=0.2)
    return Figure(size, tuple(panels), legend=legend)


def _spelled(heading: str) -> str:
    """The heading of a column as the label of an axis."""
    for words, letters in SPELLED.items():
        heading = heading.replace(words, letters)
    return heading


def _style(number: int) -> Style:
    return Style(COLOURS[number % len(COLOURS)], 1.3, DASHES[number % len(DASHES)])


def _disc(flanks: list[Mark], unit: str) -> Panel:
    points = np.concatenate([line.points for line in flanks if isinstance(line, Line)])
    frame = box(
        LEFT / WIDTH,
        BOTTOM / HEIGHT,
        (MIDDLE - LEFT - 0.9) / WIDTH,
        1.0 - (TOP + BOTTOM) / HEIGHT,
    )
    x, y = (Axis(limits([points[:, k]], [0.0]), f"{'xy'[k]} [{unit}]") for k in (0, 1))
    axis = Line(over([0.0], [0.0]), Style("black", 0.0, marker="+", size=8.0))
    return Panel(frame, x, y, (*flanks, axis), equal=True)


def _flanks(design: Design, name: str, style: Style) -> Iterator[Line]:
    """The working curves of the main disc; an undercut one with its loops."""
    if design.scene.follower is None:
        return
    disc, phi = design.cam.disc, np.linspace(0.0, TURN, SAMPLES)
    for flank, curve in disc.flanks:
        try:
            points = curve.point(phi) / MM_PER[design.scene.unit]
        except GeometryError:  # the roller centre stands still in the cam
            continue
        yield Line(plane(points), style, f"{name}, {flank}")


def _curves(design: Design, style: Style) -> list[list[tuple[str, Line]]]:
    """Position, acceleration and transmission angle, each with its heading, if there is one."""
    scene = design.scene
    cam = None if scene.follower is None else design.cam
    found = quantities(design.drive, scene.lift_unit, cam, scene.unit)
    timed = [each for each in found if bare(each[0]) == "a" or each[0].startswith("alpha_")]
    chosen: list[Columns] = [
        found[:1],
        timed[:1] or found[2:3],
        [each for each in found if bare(each[0]) == "mu"],
    ]
    phi = diagram_angles(design.drive.joints)
    return [[*_drawn(columns, phi, style)] for columns in chosen]


def _drawn(columns: Columns, phi: FloatArray, style: Style) -> Iterator[tuple[str, Line]]:
    for heading, quantity in columns:
        try:
            yield heading, Line(over(np.degrees(phi), quantity(phi, "right")), style)
        except (GeometryError, SceneError):  # there is no such curve
            continue
