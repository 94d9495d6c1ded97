"""A sheet as a DXF document: the part at true size, the sheet around it at the inverse scale.

So every dimension measures the part itself, with factor 1, and its text is what it measures. The
sheet is plotted at its scale, which fills the paper. Everything is in the model space, for many
programs show no other.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import singledispatchmethod
from typing import Final

import numpy as np
from ezdxf.document import Drawing
from ezdxf.entities.dimstyleoverride import DimStyleOverride
from ezdxf.enums import TextEntityAlignment
from ezdxf.filemanagement import new
from ezdxf.layouts.layout import Modelspace

from camgeo.sheet.ink import ARROW, BEFORE, BEHIND, LETTERS, LIFTED, number_of
from camgeo.sheet.lettering import NARROWED, squeeze
from camgeo.sheet.marks import (
    DIAMETER,
    Chain,
    Diameter,
    Distance,
    Filled,
    Hatched,
    Label,
    Layer,
    Mark,
    Round,
    Sheet,
)
from camgeo.units import MM_PER
from camgeo_export.dxf.file import INSUNITS, MEASUREMENT

STYLE: Final = "CAMGEO"
"""Name of our text style and of our dimension style."""

FONT: Final = "DejaVuSans.ttf"
"""Comes with matplotlib, so that PDF and SVG are the same on every machine."""

DASHED: Final = "DASHED"
"""A name that all programs know."""

HIDDEN: Final = (5.25, 4.2, -1.05)
"""Line 02 of ISO 128-2 for lines 0.35 wide: the whole pattern, dash and gap [mm of paper]. Other
patterns are drawn."""

LAYERS: Final[dict[Layer, tuple[int, str, int]]] = {
    "OUTLINE": (7, "CONTINUOUS", 50),
    "HIDDEN": (7, DASHED, 25),
    "SECTION": (7, "CONTINUOUS", 50),
    "EDGES": (7, "CONTINUOUS", 50),
    "CENTRE": (1, "CONTINUOUS", 25),
    "PITCH_CURVE": (3, "CONTINUOUS", 25),
    "BASE_CIRCLE": (5, "CONTINUOUS", 25),
    "HATCH": (8, "CONTINUOUS", 25),
    "DIMENSION": (7, "CONTINUOUS", 25),
    "SYMBOL": (7, "CONTINUOUS", 25),
    "TEXT": (7, "CONTINUOUS", 25),
    "FRAME": (7, "CONTINUOUS", 70),
    "GRID": (7, "CONTINUOUS", 25),
    "DIAGRAM": (7, "CONTINUOUS", 50),
    "ENGRAVING": (7, "CONTINUOUS", 18),
}
"""Colour, line type and width [1/100 mm] of each layer."""

RARE: Final[frozenset[Layer]] = frozenset(("ENGRAVING",))
"""Layers that only sheets have which need them."""

HATCHING: Final = 2.5
"""Distance between the lines of a cut face [mm of paper]."""

BY_LAYER: Final = 256
"""Colour number of what has the colour of its layer."""

ANSI31: Final = 3.175
"""The same of the pattern of that name at scale 1, for programs that have patterns of their own."""

SIZES: Final = {
    "dimtxt": LETTERS,
    "dimasz": ARROW,
    "dimexe": BEHIND,
    "dimexo": BEFORE,
    "dimgap": LIFTED,
}
"""Of dimensions [mm of paper]: text, arrows, extension lines beyond and before, gap."""

APART: Final = 20.0
"""Between sheets side by side [mm of paper]."""

JUSTIFIED: Final = {"left": "LEFT", "centre": "CENTER", "right": "RIGHT"}


def document_of(sheets: Sequence[Sheet]) -> Drawing:
    """The document of sheets side by side; to be made and written with `fixed_metadata`."""
    first = sheets[0]
    document = new("R2010", units=INSUNITS[first.unit])
    document.header["$MEASUREMENT"] = MEASUREMENT[first.unit]
    drawing = _Drawing(document, first)
    drawing.tables()
    for sheet, at in zip(sheets, corners(sheets), strict=True):
        for view in sheet.views:
            shift = at + view.at / sheet.scale
            for mark in view.marks:
                drawing.add(mark, 1.0, shift)
        for mark in sheet.marks:
            drawing.add(mark, 1.0 / sheet.scale, at)
    drawing.extents(len(sheets))
    return document


def corners(sheets: Sequence[Sheet]) -> list[complex]:
    """Lower left corners of sheets side by side [mm of the part]: the origin is that of the first
    one's first view.
    """
    first = sheets[0]
    origin = first.views[0].at if first.views else 0j
    step = first.width + APART
    return [(number * step - origin) / first.scale for number in range(len(sheets))]


class _Drawing:
    """Adds marks to a document."""

    def __init__(self, document: Drawing, sheet: Sheet) -> None:
        self._document = document
        self._sheet = sheet
        self._space: Modelspace = document.modelspace()
        self._mm = MM_PER[sheet.unit]
        self._paper = 1.0 / (sheet.scale * self._mm)  # units for each mm of paper
        self._factor, self._shift = 1.0, 0j

    def tables(self) -> None:
        """Line types, layers, text and dimension style, and the scale of patterns."""
        self._document.linetypes.add(DASHED, list(HIDDEN), description="hidden edges")
        self._document.header["$LTSCALE"] = self._paper
        marks = (mark for view in self._sheet.views for mark in view.marks)
        used = {getattr(mark, "layer", "") for mark in marks}
        for layer, (colour, kind, width) in LAYERS.items():
            if layer in RARE - used:
                continue
            self._document.layers.add(layer, color=colour, linetype=kind, lineweight=width)
        self._document.styles.add(STYLE, font=FONT, dxfattribs={"width": NARROWED})
        style = self._document.dimstyles.new(STYLE)
        for name, size in SIZES.items():
            style.set_dxf_attrib(name, size)
        style.dxf.dimscale = self._paper
        for name, size in {**SIZES, "dimscale": self._paper, "dimlfac": 1.0}.items():
            self._document.header[f"${name.upper()}"] = size  # some programs know no styles
        style.dxf.dimlfac = 1.0
        style.dxf.dimtxsty = STYLE
        style.dxf.dimdsep = ord("," if self._sheet.comma else ".")
        style.dxf.dimzin = 8  # no zeros at the end
        style.dxf.dimlunit = 2  # decimal
        style.dxf.dimtad = 1  # text above its line,
        style.dxf.dimtih = style.dxf.dimtoh = 0  # and along it
        style.dxf.dimtix = 1  # nowhere but where it was placed,
        style.dxf.dimtofl = 1  # the line also between arrows that are outside
        style.dxf.dimlwd = style.dxf.dimlwe = 25

    def extents(self, count: int) -> None:
        """What programs show when the drawing is opened: all sheets."""
        sheet = self._sheet
        low = self._xy(0j, 1.0 / sheet.scale, corners([sheet])[0])
        wide = (count * (sheet.width + APART) - APART) * self._paper
        high = sheet.height * self._paper
        corner = (low[0] + wide, low[1] + high)
        self._space.reset_extents((*low, 0.0), (*corner, 0.0))
        self._space.reset_limits(low, corner)
        (view,) = self._document.viewports.get_config("*Active")
        view.dxf.center = (low[0] + 0.5 * wide, low[1] + 0.5 * high)
        view.dxf.height = 1.05 * max(wide, high)
        view.dxf.aspect_ratio = 4.0 / 3.0

    def add(self, mark: Mark, factor: float, shift: complex) -> None:
        """A mark of a view or of the sheet, enlarged and moved [mm of the part]."""
        self._factor, self._shift = factor, shift
        self._add(mark)

    def _xy(self, point: complex, factor: float, shift: complex) -> tuple[float, float]:
        moved = (point * factor + shift) / self._mm
        return moved.real + 0.0, moved.imag + 0.0  # + 0.0 turns -0.0 into 0.0

    def _at(self, point: complex) -> tuple[float, float]:
        return self._xy(complex(point), self._factor, self._shift)

    def _length(self, size: float) -> float:
        return size * self._factor / self._mm

    @singledispatchmethod
    def _add(self, mark: object) -> None:
        raise TypeError(f"{type(mark).__name__} is not a mark")

    @_add.register
    def _(self, mark: Chain) -> None:
        attributes = {"layer": mark.layer}
        if len(mark.vertices) == 2 and not mark.closed and not mark.sweeps[0]:
            start, end = (self._at(each) for each in mark.vertices.tolist())
            self._space.add_line(start, end, dxfattribs=attributes)
            return
        bulges = np.tan(mark.sweeps / 4.0) + 0.0
        points = [
            (*self._at(at), bulge)
            for at, bulge in zip(mark.vertices.tolist(), bulges.tolist(), strict=True)
        ]
        polyline = self._space.add_lwpolyline(points, "xyb", close=mark.closed,
                                              dxfattribs=attributes)  # fmt: skip
        polyline.dxf.flags |= 128  # the pattern of a line runs on around vertices

    @_add.register
    def _(self, mark: Round) -> None:
        centre, radius = self._at(mark.centre), self._length(mark.radius)
        self._space.add_circle(centre, radius, dxfattribs={"layer": mark.layer})

    @_add.register
    def _(self, mark: Label) -> None:
        narrow = squeeze(mark.text, mark.height, mark.width)
        text = self._space.add_text(
            mark.text,
            height=mark.height * self._paper,
            rotation=math.degrees(mark.angle),
            dxfattribs={"layer": mark.layer, "style": STYLE, "width": NARROWED * narrow},
        )
        text.set_placement(self._at(mark.at), align=TextEntityAlignment[JUSTIFIED[mark.across]])

    @_add.register
    def _(self, mark: Filled) -> None:
        corners = [self._at(each) for each in mark.corners]
        if len(corners) == 4:
            corners[2], corners[3] = corners[3], corners[2]  # of a SOLID they go across
        self._space.add_solid(corners, dxfattribs={"layer": mark.layer})

    @_add.register
    def _(self, mark: Hatched) -> None:
        hatch = self._space.add_hatch(dxfattribs={"layer": "HATCH"})
        step = ANSI31 * math.sqrt(0.5)
        pattern = [[45.0, (0.0, 0.0), (-step, step), []]]
        scale = HATCHING * self._paper / ANSI31
        hatch.set_pattern_fill("ANSI31", BY_LAYER, scale=scale, definition=pattern)
        corners = [self._at(each) for each in mark.corners.tolist()]
        hatch.paths.add_polyline_path(corners, is_closed=True)

    @_add.register
    def _(self, mark: Distance) -> None:
        override = self._override(mark.prefix, mark)
        if mark.bare:
            names = ["", ""]
            names[mark.bare - 1] = "NONE"
            override |= {"dimsah": 1, "dimblk1": names[0], "dimblk2": names[1]}
        drawn = self._space.add_linear_dim(
            base=self._at(mark.line),
            p1=self._at(mark.first),
            p2=self._at(mark.second),
            angle=math.degrees(mark.angle),
            dimstyle=STYLE,
            override=override,
            dxfattribs={"layer": "DIMENSION"},
        )
        if mark.aside:
            drawn.shift_text(mark.aside * self._paper, 0.0)
        self._state(drawn, mark)

    @_add.register
    def _(self, mark: Diameter) -> None:
        text = number_of(mark, self._sheet.unit).replace(DIAMETER, "Ø")
        own = {"dimtmove": 1, "dimtoh": 1, "dimtad": 1, "dimtofl": 0, "dimcen": 0.0}
        override = {**self._override(mark.prefix, mark), **own}
        reach = self._length(mark.radius) + mark.reach * self._paper
        centre = self._at(mark.centre)
        way = (math.cos(mark.angle), math.sin(mark.angle))
        drawn = self._space.add_diameter_dim(
            center=centre,
            radius=self._length(mark.radius),
            angle=math.degrees(mark.angle),
            location=(centre[0] + reach * way[0], centre[1] + reach * way[1]),
            text=text.replace(".", ",") if self._sheet.comma else text,
            dimstyle=STYLE,
            override=override,
            dxfattribs={"layer": "DIMENSION"},
        )
        self._state(drawn, mark)
        drawn.dimension.dxf.text = "<>"  # ezdxf would write a second sign before the number

    def _state(self, drawn: DimStyleOverride, mark: Distance | Diameter) -> None:
        """Draw a dimension, and state what it measures, which ezdxf does not."""
        drawn.render()
        drawn.dimension.dxf.actual_measurement = self._length(mark.measure)

    def _override(self, prefix: str, mark: Distance | Diameter) -> dict[str, object]:
        return {"dimdec": mark.decimals, "dimpost": f"{prefix}<>{mark.suffix}"}
