"""Sheets of fixture scenes, made once, and the rooms of their texts."""

from __future__ import annotations

import cmath
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from camgeo.design.design import Design
from camgeo.design.product import Product
from camgeo.pictures.sheet.marks import Chain, Diameter, Distance, Label, Sheet, text_width
from camgeo.pictures.sheet.sheet import build_sheets
from camgeo.scene.scene import load_scene, parse_scene
from camgeo.units import MM_PER

FIXTURES = Path(__file__).parents[2] / "fixtures"

SCENES = sorted(path.stem for path in (FIXTURES / "scenes").glob("*.toml"))

TOLERANCE = 0.01

ROUNDING = 1e-9

FULL = {
    "owner": "Works Ltd",
    "number": "4711-0815",
    "revision": "B",
    "date": "2026-03-01",
    "title": "Cam disc",
    "creator": "A. Maker",
    "approver": "B. Checker",
    "document_type": "Component drawing",
    "material": "16MnCr5",
    "hardness": "58+4 HRC",
    "general_tolerances": "ISO 2768-m",
    "edges": "-0.3",
    "surface": "Ra 3.2",
    "flank_surface": "Ra 0.8",
    "bore_fit": "H7",
    "keyway_fit": "JS9",
    "flank_tolerance": 0.02,
}
"""A scene's table [drawing] with all that it can state."""

EDGES = ("OUTLINE", "HIDDEN", "SECTION", "EDGES", "SYMBOL", "DIMENSION")
"""Layers of the lines that no text is written across."""

HUBBED = """\
camgeo = 1
name = "hubbed"
[cam]
rotation = "ccw"
[follower]
kind = "translating-roller"
base_radius = 40
roller_radius = 8
[[motion]]
law = "inclined-sine"
span = 180
to = 12
[[motion]]
law = "modified-sine"
span = 180
to = 0
[part]
thickness = 10
bore = 16
keyway = { width = 5, depth = 2.3, angle = 90 }
hub = { diameter = 30, height = 12, side = "both" }
mark = { radius = 25, width = 3, depth = 1, length = 8, angle = 30 }
"""


def edited(keys: dict[str, Any]) -> dict[str, Any]:
    """Edits of a scene for a drawing with these keys, made without effort."""
    return {**{f"drawing.{name}": value for name, value in keys.items()}, "output.fit": "fast"}


@cache
def products(name: str, sheet: str = "A3", language: str = "en") -> tuple[Product, ...]:
    """The discs of a fixture scene, with all that a drawing can state."""
    scene = load_scene(FIXTURES / "scenes" / f"{name}.toml")
    keys = {**FULL, "sheet": sheet, "language": language}
    return Design(scene.with_values(edited(keys))).discs


@cache
def sheets(name: str, sheet: str = "A3", language: str = "en") -> tuple[Sheet, ...]:
    """Their sheets."""
    return tuple(build_sheets(each, TOLERANCE)[0] for each in products(name, sheet, language))


@dataclass(frozen=True, slots=True)
class Room:
    """A text: its middle, a unit vector along it, and half its sizes [mm of paper]."""

    text: str
    middle: complex
    along: complex
    half_width: float
    half_height: float

    @property
    def corners(self) -> list[complex]:
        """Its corners, in order."""
        signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
        sides = (complex(i * self.half_width, j * self.half_height) for i, j in signs)
        return [self.middle + self.along * side for side in sides]


def text_of(mark: Distance | Diameter, sheet: Sheet) -> str:
    """What a dimension says, from what it measures."""
    number = f"{mark.measure / MM_PER[sheet.unit]:.{mark.decimals}f}".rstrip("0").rstrip(".")
    return f"{mark.prefix}{number}{mark.suffix}"


def room(mark: Label | Distance | Diameter, sheet: Sheet, at: complex, scale: float) -> Room:
    """Where the text of a mark stands whose origin is `at` [mm of paper]."""
    if isinstance(mark, Label):
        wide = text_width(mark.text, mark.height) * mark.squeeze
        shift = {"left": 0.5, "centre": 0.0, "right": -0.5}[mark.across] * wide
        middle = at + scale * mark.place + (shift + 0.5j * mark.height)
        return Room(mark.text, middle, 1.0, 0.5 * wide, 0.5 * mark.height)
    text = text_of(mark, sheet)
    wide = text_width(text, 3.5)
    if isinstance(mark, Distance):
        along = cmath.rect(1.0, mark.angle)
        middle = 0.5 * (mark.first + mark.second)
        off = ((mark.line - middle) * (1j * along).conjugate()).real
        foot = at + scale * (middle + off * 1j * along) + mark.aside * along
        return Room(text, foot + 2.55j * along, along, 0.5 * wide, 1.75)
    tip = at + scale * (mark.centre + cmath.rect(mark.radius, mark.angle))
    knee = tip + cmath.rect(mark.reach, mark.angle)
    shelf = 2.8 * len(text.replace("%%c", "O"))
    half = 0.5 * shelf if knee.real > tip.real else -0.5 * shelf
    return Room(text, knee + half + 2.55j, 1.0, 0.5 * wide, 1.75)


def text_boxes(sheet: Sheet) -> list[Room]:
    """All texts of a sheet with their rooms."""
    kinds = (Label, Distance, Diameter)
    found = [room(mark, sheet, 0j, 1.0) for mark in sheet.marks if isinstance(mark, kinds)]
    for view in sheet.views:
        found += [room(mark, sheet, view.origin, sheet.scale) for mark in view.marks
                  if isinstance(mark, kinds)]  # fmt: skip
    return found


def polygons(texts: list[Room]) -> list[shapely.Polygon]:
    """The rooms of texts, a little smaller: what only touches one is not in it."""
    corners = [[(each.real, each.imag) for each in own.corners] for own in texts]
    return [shapely.Polygon(each).buffer(-ROUNDING) for each in corners]


def overlaps(texts: list[Room]) -> list[tuple[str, str]]:
    """The pairs of texts that are drawn across each other."""
    rooms = polygons(texts)
    pairs = shapely.STRtree(rooms).query(rooms, predicate="intersects").T.tolist()
    return [(texts[one].text, texts[other].text) for one, other in pairs if one < other]


def crossed(texts: list[Room], sheet: Sheet, layers: tuple[str, ...]) -> list[tuple[str, str]]:
    """The texts that lines or arcs of a sheet's views are drawn across, with their layers."""
    drawn = [
        (mark.layer, line_of(mark, view.origin, sheet.scale))
        for view in sheet.views
        for mark in view.marks
        if isinstance(mark, Chain) and mark.layer in layers
    ]
    lines = [line for _, line in drawn]
    pairs = shapely.STRtree(polygons(texts)).query(lines, predicate="intersects").T.tolist()
    return [(texts[text].text, drawn[line][0]) for line, text in pairs]


STEP = 3e-3
"""Angle of the chords of arcs [rad]: 1e-4 mm from one of 100 mm."""


def line_of(mark: Chain, at: complex = 0j, scale: float = 1.0) -> shapely.LineString:
    """A chain whose origin is `at`, by chords."""
    starts = at + scale * mark.vertices
    found = []
    for start, end, sweep in zip(starts, np.roll(starts, -1), mark.sweeps, strict=True):
        turned = sweep * np.linspace(0.0, 1.0, 2 + int(abs(sweep) / STEP))
        share = np.expm1(1j * turned) / np.expm1(1j * sweep) if sweep else np.array([0.0, 1.0])
        found.append(start + (end - start) * share)
    points = np.concatenate(found if mark.closed else found[:-1])
    return shapely.LineString(np.column_stack((points.real, points.imag)))


PARTS = {
    "plain": "bore = 16\nKEYWAY",
    "hub": 'bore = 16\nKEYWAY\nhub = { diameter = 30, height = 12, side = "upper" }',
    "bolts": "bore = 16\nKEYWAY\nbolt_circle = { count = 6, circle = 44, hole = 5, angle = 10 }",
    "hub and bolts": 'bore = 16\nKEYWAY\nhub = { diameter = 28, height = 12, side = "both" }\n'
    "bolt_circle = { count = 4, circle = 50, hole = 6 }\n"
    "mark = { radius = 25, width = 2, depth = 1, angle = 30 }",
    "lightened": "bore = 16\nKEYWAY\n"
    "lightening_holes = { count = 3, circle = 44, hole = 14, angle = 20 }",
    "flat": "bore = 16\nd_shaft = { across = 14, angle = ANGLE }\n"
    "bolt_circle = { count = 6, circle = 44, hole = 4 }",
    "small": "bore = 8\nkeyway = { width = 2, depth = 1, angle = ANGLE }",
    "thick": "bore = 22\nkeyway = { width = 6.6, depth = 3.3, angle = ANGLE }\n"
    "bolt_circle = { count = 3, circle = 50, hole = 8 }",
}
"""Features of parts, with a keyway or a flat that may point anywhere."""


def part(name: str, angle: float, **keys: Any) -> Product:
    """A disc with some of these features; a key that is None is not stated."""
    features = PARTS[name].replace("KEYWAY", "keyway = { width = 5, depth = 2.3, angle = ANGLE }")
    text = HUBBED.partition("bore =")[0] + features.replace("ANGLE", f"{angle}")
    stated = {name: value for name, value in {**FULL, **keys}.items() if value is not None}
    return Design(parse_scene(text).with_values(edited(stated))).disc
