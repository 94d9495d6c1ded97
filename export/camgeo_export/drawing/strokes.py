"""What is drawn on a page: lines and arcs by their widths, letters and other filled areas.

Lines are taken from the sheet itself, with its arcs; texts and dimensions are taken apart by
ezdxf's drawing add-on. Everything is black.
"""

from __future__ import annotations

import pathlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Final

import matplotlib as mpl
import numpy as np
from ezdxf.addons.drawing.backend import Backend, BkPath2d, BkPoints2d, ImageData
from ezdxf.addons.drawing.config import BackgroundPolicy, ColorPolicy, Configuration
from ezdxf.addons.drawing.frontend import Frontend
from ezdxf.addons.drawing.properties import BackendProperties, RenderContext
from ezdxf.addons.drawing.type_hints import Color
from ezdxf.document import Drawing
from ezdxf.entities.dxfgfx import DXFGraphic
from ezdxf.fonts import fonts
from ezdxf.math import Vec2
from ezdxf.path import Curve3To, Curve4To, LineTo

from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.sheet.front import dashed_stretch
from camgeo.sheet.ink import QUARTERS
from camgeo.sheet.marks import Chain, Filled, Hatched, Mark, Round, Sheet
from camgeo.sheet.section import hatching
from camgeo.units import MM_PER
from camgeo_export.drawing.document import FONT, HATCHING, HIDDEN, LAYERS, corners

GRAIN: Final = 0.005
"""Of coordinates on a page [mm]: they are whole multiples."""

WRITTEN: Final = frozenset(("TEXT", "DIMENSION"))
"""Entities that ezdxf takes apart."""

Outline = tuple[tuple[str, tuple[complex, ...]], ...]
"""A filled outline: commands "M", "L", "Q", "C" and "Z" with their points, in grains."""


@dataclass(frozen=True, slots=True, eq=False)
class Stroke:
    """Lines and arcs end to end [grains].

    Attributes
    ----------
    vertices : (n,) complex.
    sweeps : (n,) angle turned to the next [rad], 0 is a line; the last one counts if it is closed.
    """

    vertices: ComplexArray
    sweeps: FloatArray
    closed: bool = False


@dataclass(slots=True)
class Strokes:
    """What is drawn on a page.

    Attributes
    ----------
    width, height : of the page [mm].
    lines : by the width of the line [1/100 mm].
    shapes : filled outlines, each from its own first point.
    places : number of each filled outline, and where its first point is [grains].
    """

    width: float
    height: float
    lines: dict[int, list[Stroke]] = field(default_factory=dict)
    shapes: dict[Outline, int] = field(default_factory=dict)
    places: list[tuple[int, complex]] = field(default_factory=list)

    def add(self, width: int, stroke: Stroke) -> None:
        """A line of some width [1/100 mm]."""
        self.lines.setdefault(width, []).append(stroke)

    def fill(self, outline: Iterable[tuple[str, tuple[complex, ...]]]) -> int:
        """A filled outline [grains], whose number is returned."""
        made = list(outline)
        origin = made[0][1][0]
        own = tuple((w, tuple(rounded(each - origin) for each in points)) for w, points in made)
        number = self.shapes.setdefault(own, len(self.shapes))
        self.places.append((number, rounded(origin)))
        return number


def rounded(point: complex) -> complex:
    """A point in whole grains."""
    return complex(round(point.real), round(point.imag))


def know_the_font() -> None:
    """Make our font known to ezdxf, which looks only at those of the system."""
    if not fonts.font_manager.has_font(FONT):
        folder = pathlib.Path(mpl.get_data_path()) / "fonts" / "ttf"
        fonts.font_manager.build([str(folder)], support_dirs=False)


def strokes_of(document: Drawing, sheet: Sheet) -> Strokes:
    """What is drawn on a sheet; `document` has it alone."""
    found = Strokes(sheet.width, sheet.height)
    for view in sheet.views:
        for mark in view.marks:
            for layer, stroke in _strokes(mark, view.at, sheet.scale):
                found.add(layer, stroke)
    for mark in sheet.marks:
        for layer, stroke in _strokes(mark, 0j, 1.0):
            found.add(layer, stroke)
    for marks, at, scale in ((sheet.marks, 0j, 1.0),
                             *((v.marks, v.at, sheet.scale) for v in sheet.views)):  # fmt: skip
        for mark in marks:
            if isinstance(mark, Filled):
                found.fill(_polygon([(at + scale * each) / GRAIN for each in mark.corners]))
    low = corners([sheet])[0] / MM_PER[sheet.unit]
    backend = _Taken(found, low, sheet.scale * MM_PER[sheet.unit] / GRAIN)
    config = Configuration(
        color_policy=ColorPolicy.BLACK, background_policy=BackgroundPolicy.OFF,
        min_lineweight=0.0,
    )  # fmt: skip
    Frontend(RenderContext(document), backend, config=config).draw_layout(
        document.modelspace(), finalize=False, filter_func=_is_written
    )
    return found


def _is_written(entity: DXFGraphic) -> bool:
    return entity.dxftype() in WRITTEN


def _strokes(mark: Mark, at: complex, scale: float) -> Iterator[tuple[int, Stroke]]:
    """The lines of a mark, hidden ones in dashes, and their widths [1/100 mm]."""
    if isinstance(mark, Round):
        points = (at + scale * (mark.centre + mark.radius * QUARTERS)) / GRAIN
        yield LAYERS[mark.layer][2], Stroke(points, np.full(4, 0.5 * np.pi), closed=True)
    elif isinstance(mark, Hatched):
        for ends in hatching(mark, HATCHING / scale):
            points = np.array([(at + scale * end) / GRAIN for end in ends], np.complex128)
            yield LAYERS["HATCH"][2], Stroke(points, np.zeros(2))
    elif isinstance(mark, Chain):
        chains: Iterable[Chain] = (mark,)
        if mark.layer == "HIDDEN":
            chains = dashed_stretch(mark, scale, (HIDDEN[1], -HIDDEN[2]))
        for each in chains:
            points = (at + scale * each.vertices) / GRAIN
            yield LAYERS[each.layer][2], Stroke(points, each.sweeps, each.closed)


def _polygon(points: list[complex]) -> Iterator[tuple[str, tuple[complex, ...]]]:
    yield "M", (points[0],)
    for point in points[1:]:
        yield "L", (point,)
    yield "Z", ()


class _Taken(Backend):
    """Takes texts and dimensions as lines and outlines."""

    def __init__(self, found: Strokes, low: complex, factor: float) -> None:
        super().__init__()
        self._found, self._low, self._factor = found, low, factor
        self._letters: dict[tuple[bytes, bytes], int] = {}

    def _at(self, point: Vec2) -> complex:
        return (complex(point.x, point.y) - self._low) * self._factor

    def draw_line(self, start: Vec2, end: Vec2, properties: BackendProperties) -> None:
        """A line of a dimension."""
        ends = np.array([self._at(start), self._at(end)], np.complex128)
        self._found.add(round(100.0 * properties.lineweight), Stroke(ends, np.zeros(2)))

    def draw_filled_paths(self, paths: Iterable[BkPath2d], properties: BackendProperties) -> None:
        """Letters, each by itself."""
        for path in paths:
            if not len(path):
                continue
            corners = path.np_vertices()
            points = (corners[:, 0] + 1j * corners[:, 1] - self._low) * self._factor
            shape = np.rint(points - points[0]) + 0.0
            key = bytes(path.command_codes()), shape.tobytes()
            if key in self._letters:
                self._found.places.append((self._letters[key], rounded(complex(points[0]))))
            else:
                self._letters[key] = self._found.fill(self._outline(path))

    def _outline(self, path: BkPath2d) -> Iterator[tuple[str, tuple[complex, ...]]]:
        yield "M", (self._at(path.start),)
        for element in path.commands():
            end = self._at(Vec2(element.end))
            if isinstance(element, LineTo):
                yield "L", (end,)
            elif isinstance(element, Curve3To):
                yield "Q", (self._at(Vec2(element.ctrl)), end)
            elif isinstance(element, Curve4To):
                yield "C", (self._at(Vec2(element.ctrl1)), self._at(Vec2(element.ctrl2)), end)
            else:
                yield "Z", ()
                yield "M", (end,)
        yield "Z", ()

    def draw_filled_polygon(self, points: BkPoints2d, properties: BackendProperties) -> None:
        """An arrow."""
        self._found.fill(_polygon([self._at(point) for point in points.vertices()]))

    def draw_point(self, pos: Vec2, properties: BackendProperties) -> None:
        """Points of dimensions are not drawn."""

    def draw_image(self, image_data: ImageData, properties: BackendProperties) -> None:
        """There is none."""

    def set_background(self, color: Color) -> None:
        """Paper has its own."""

    def clear(self) -> None:
        """Nothing is kept."""
