"""Sheets of fixture scenes, made once, and the rooms of their texts."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from camgeo.design import Design
from camgeo.product.product import Product
from camgeo.scene.load import load_scene
from camgeo.sheet.lettering import squeeze, width_of
from camgeo.sheet.marks import Distance, Label, Sheet
from camgeo.sheet.placing import Box, box_of
from camgeo.sheet.sheet import sheet_of

FIXTURES = Path(__file__).parents[2] / "fixtures"

SCENES = sorted(path.stem for path in (FIXTURES / "scenes").glob("*.toml"))

TOLERANCE = 0.01

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
    return tuple(sheet_of(each, TOLERANCE) for each in products(name, sheet, language))


def label_box(mark: Label) -> Box:
    """The room of a text on the sheet [mm of paper]."""
    wide = width_of(mark.text, mark.height) * squeeze(mark.text, mark.height, mark.width)
    shift = {"left": 0.5, "centre": 0.0, "right": -0.5}[mark.across] * wide
    return Box(mark.at + shift + 0.5j * mark.height, 1.0, 0.5 * wide, 0.5 * mark.height)


def text_boxes(sheet: Sheet) -> list[tuple[str, Box]]:
    """All texts of a sheet with their rooms [mm of paper]."""
    found = [(m.text, label_box(m)) for m in sheet.marks if isinstance(m, Label)]
    for view in sheet.views:
        for mark in view.marks:
            if isinstance(mark, Label):
                box = label_box(mark)
                at = view.at + mark.at * sheet.scale + (box.middle - mark.at)
                found.append((mark.text, Box(at, 1.0, box.half_width, box.half_height)))
            elif isinstance(mark, Distance):
                box = box_of(mark, sheet.scale, sheet.unit)
                size = box.half_width * sheet.scale, box.half_height * sheet.scale
                at = view.at + box.middle * sheet.scale
                found.append((f"{mark.measure:g}", Box(at, box.along, *size)))
    return found


def overlap(one: Box, other: Box) -> bool:
    """Whether two rooms overlap: no line along or across either separates them."""
    for box in (one, other):
        for axis in (box.along, 1j * box.along):
            apart = abs(((one.middle - other.middle) * axis.conjugate()).real)
            reach = sum(
                each.half_width * abs((each.along * axis.conjugate()).real)
                + each.half_height * abs((1j * each.along * axis.conjugate()).real)
                for each in (one, other)
            )
            if apart >= reach - 1e-9:
                return False
    return True


def corners(box: Box) -> list[complex]:
    """The corners of a room."""
    sides = (complex(i * box.half_width, j * box.half_height) for i in (-1, 1) for j in (-1, 1))
    return [box.middle + box.along * side for side in sides]


def overlaps(texts: list[tuple[str, Box]]) -> list[tuple[str, str]]:
    """The pairs of texts that are drawn across each other."""
    places = np.array([[(c.real, c.imag) for c in corners(box)] for _, box in texts])
    low, high = places.min(axis=1), places.max(axis=1)
    near = np.all((low[:, None] < high[None]) & (low[None] < high[:, None]), axis=2)
    return [
        (texts[one][0], texts[other][0])
        for one, other in np.argwhere(np.triu(near, 1)).tolist()
        if overlap(texts[one][1], texts[other][1])
    ]
