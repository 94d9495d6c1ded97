"""The drawing: one sheet as DXF, PDF and SVG."""

from __future__ import annotations

import cmath
import math
import pathlib
import zlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import singledispatchmethod
from itertools import pairwise
from typing import Final

import matplotlib as mpl
import numpy as np
from ezdxf.addons.drawing.backend import Backend, BkPath2d, BkPoints2d, ImageData
from ezdxf.addons.drawing.config import BackgroundPolicy, ColorPolicy, Configuration
from ezdxf.addons.drawing.frontend import Frontend
from ezdxf.addons.drawing.properties import BackendProperties, RenderContext
from ezdxf.addons.drawing.type_hints import Color
from ezdxf.document import Drawing
from ezdxf.entities.dimstyleoverride import DimStyleOverride
from ezdxf.enums import TextEntityAlignment
from ezdxf.fonts import fonts
from ezdxf.layouts.layout import Modelspace
from ezdxf.math import Vec2
from ezdxf.path import Curve3To, Curve4To, LineTo

from camgeo.design.product import Product
from camgeo.design.writing import Written
from camgeo.errors import FileError
from camgeo.numeric.arrays import ComplexArray
from camgeo.pictures.sheet.marks import (
    ARROW,
    DIAMETER,
    EXTENSION_GAP,
    EXTENSION_OVERSHOOT,
    LETTERS,
    LIFTED,
    NARROWED,
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
    dimension_text,
)
from camgeo.pictures.sheet.sheet import build_sheets, dashed_stretch
from camgeo.scene.formats.drawing import FORMAT
from camgeo.scene.formats.format import Format
from camgeo.units import MM_PER
from camgeo_export.dxf.reader import Item, read_drawing
from camgeo_export.dxf.writer import document_bytes, new_document
from camgeo_export.verify.plane import deviation

# -- document -------------------------------------------------------------------------------------
# A sheet as a DXF document: the part at true size, the sheet around it at the inverse scale.
#
# So every dimension measures the part itself, with factor 1, and its text is what it measures. The
# sheet is plotted at its scale, which fills the paper. Everything is in the model space, for many
# programs show no other.


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
"""Layers that a sheet has only if something is on them."""

HATCHING: Final = 2.5
"""Distance between the hatching lines of a cut face [mm of paper]."""

BY_LAYER: Final = 256
"""Colour number of what has the colour of its layer."""

ANSI31: Final = 3.175
"""Distance between the lines of the pattern ANSI31 at scale 1, for programs that draw it from their
own definition."""

SIZES: Final = {
    "dimtxt": LETTERS,
    "dimasz": ARROW,
    "dimexe": EXTENSION_OVERSHOOT,
    "dimexo": EXTENSION_GAP,
    "dimgap": LIFTED,
}
"""Sizes of dimensions [mm of paper]: text, arrows, extension lines beyond the dimension line and
before the edge, gap below the text."""

TEXTS: Final = {
    "dimzin": 8,  # no zeros at the end
    "dimlunit": 2,  # decimal
    "dimtad": 1,  # text above its line,
    "dimtih": 0,  # and along it
    "dimtoh": 0,
    "dimtix": 1,  # nowhere but where it was placed,
    "dimtofl": 1,  # the line also between arrows that are outside
    "dimlwd": 25,
    "dimlwe": 25,
}
"""Form of dimensions: how their texts and lines are placed, and how wide lines are [1/100 mm]."""

SHEET_GAP: Final = 20.0
"""Distance between sheets side by side [mm of paper]."""

JUSTIFIED: Final = {"left": "LEFT", "centre": "CENTER", "right": "RIGHT"}


def sheet_document(sheets: Sequence[Sheet], product: Product, tolerance: float) -> Drawing:
    """The document of sheets of a product side by side."""
    document = new_document(product, tolerance)
    drawing = _Drawing(document, sheets[0])
    drawing.tables()
    for sheet, corner in zip(sheets, corners(sheets), strict=True):
        for view in sheet.views:
            shift = corner + view.origin / sheet.scale
            for mark in view.marks:
                drawing.add(mark, 1.0, shift)
        for mark in sheet.marks:
            drawing.add(mark, 1.0 / sheet.scale, corner)
    drawing.extents(len(sheets))
    return document


def corners(sheets: Sequence[Sheet]) -> list[complex]:
    """Lower left corners of sheets side by side [mm of the part]: the origin is that of the first
    one's first view.
    """
    first = sheets[0]
    origin = first.views[0].origin if first.views else 0j
    step = first.width + SHEET_GAP
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
        """Add line types, layers, text and dimension style, and the scale of patterns."""
        self._document.linetypes.add(DASHED, list(HIDDEN), description="hidden edges")
        self._document.header["$LTSCALE"] = self._paper
        marks = (mark for view in self._sheet.views for mark in view.marks)
        used = {getattr(mark, "layer", "") for mark in marks}
        for layer, (colour, kind, width) in LAYERS.items():
            if layer in RARE - used:
                continue
            self._document.layers.add(layer, color=colour, linetype=kind, lineweight=width)
        self._document.styles.add(STYLE, font=FONT, dxfattribs={"width": NARROWED})
        scaled = {**SIZES, "dimscale": self._paper, "dimlfac": 1.0}
        for name, size in scaled.items():
            self._document.header[f"${name.upper()}"] = size  # some programs know no styles
        sign = ord("," if self._sheet.comma else ".")
        style = self._document.dimstyles.new(STYLE)
        for name, value in {**scaled, "dimtxsty": STYLE, "dimdsep": sign, **TEXTS}.items():
            style.set_dxf_attrib(name, value)

    def extents(self, count: int) -> None:
        """Set what programs show when the drawing is opened: all sheets."""
        sheet = self._sheet
        low = self._xy(0j, 1.0 / sheet.scale, corners([sheet])[0])
        wide = (count * (sheet.width + SHEET_GAP) - SHEET_GAP) * self._paper
        high = sheet.height * self._paper
        corner = (low[0] + wide, low[1] + high)
        self._space.reset_extents((*low, 0.0), (*corner, 0.0))
        self._space.reset_limits(low, corner)
        (view,) = self._document.viewports.get_config("*Active")
        view.dxf.center = (low[0] + 0.5 * wide, low[1] + 0.5 * high)
        view.dxf.height = 1.05 * max(wide, high)
        view.dxf.aspect_ratio = 4.0 / 3.0

    def add(self, mark: Mark, factor: float, shift: complex) -> None:
        """Add a mark of a view or of the sheet, enlarged and moved [mm of the part]."""
        self._factor, self._shift = factor, shift
        self._add(mark)

    def _xy(self, point: complex, factor: float, shift: complex) -> tuple[float, float]:
        moved = (point * factor + shift) / self._mm
        return moved.real + 0.0, moved.imag + 0.0  # + 0.0 turns -0.0 into 0.0

    def _point(self, point: complex) -> tuple[float, float]:
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
            start, end = (self._point(vertex) for vertex in mark.vertices.tolist())
            self._space.add_line(start, end, dxfattribs=attributes)
            return
        bulges = np.tan(mark.sweeps / 4.0) + 0.0
        points = [
            (*self._point(vertex), bulge)
            for vertex, bulge in zip(mark.vertices.tolist(), bulges.tolist(), strict=True)
        ]
        polyline = self._space.add_lwpolyline(points, "xyb", close=mark.closed,
                                              dxfattribs=attributes)  # fmt: skip
        polyline.dxf.flags |= 128  # the pattern of a line runs on around vertices

    @_add.register
    def _(self, mark: Round) -> None:
        centre, radius = self._point(mark.centre), self._length(mark.radius)
        self._space.add_circle(centre, radius, dxfattribs={"layer": mark.layer})

    @_add.register
    def _(self, mark: Label) -> None:
        text = self._space.add_text(
            mark.text,
            height=mark.height * self._paper,
            rotation=0.0,
            dxfattribs={"layer": mark.layer, "style": STYLE, "width": NARROWED * mark.squeeze},
        )
        text.set_placement(
            self._point(mark.place), align=TextEntityAlignment[JUSTIFIED[mark.across]]
        )

    @_add.register
    def _(self, mark: Filled) -> None:
        corners = [self._point(corner) for corner in mark.corners]
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
        corners = [self._point(corner) for corner in mark.corners.tolist()]
        hatch.paths.add_polyline_path(corners, is_closed=True)

    @_add.register
    def _(self, mark: Distance) -> None:
        override = self._override(mark)
        if mark.bare:
            names = ["", ""]
            names[mark.bare - 1] = "NONE"
            override |= {"dimsah": 1, "dimblk1": names[0], "dimblk2": names[1]}
        entity = self._space.add_linear_dim(
            base=self._point(mark.line),
            p1=self._point(mark.first),
            p2=self._point(mark.second),
            angle=math.degrees(mark.angle),
            dimstyle=STYLE,
            override=override,
            dxfattribs={"layer": "DIMENSION"},
        )
        if mark.aside:
            entity.shift_text(mark.aside * self._paper, 0.0)
        self._state(entity, mark)

    @_add.register
    def _(self, mark: Diameter) -> None:
        text = dimension_text(mark, self._sheet.unit).replace(DIAMETER, "Ø")
        settings = {"dimtmove": 1, "dimtoh": 1, "dimtad": 1, "dimtofl": 0, "dimcen": 0.0}
        override = {**self._override(mark), **settings}
        reach = self._length(mark.radius) + mark.reach * self._paper
        centre = self._point(mark.centre)
        way = (math.cos(mark.angle), math.sin(mark.angle))
        entity = self._space.add_diameter_dim(
            center=centre,
            radius=self._length(mark.radius),
            angle=math.degrees(mark.angle),
            location=(centre[0] + reach * way[0], centre[1] + reach * way[1]),
            text=text.replace(".", ",") if self._sheet.comma else text,
            dimstyle=STYLE,
            override=override,
            dxfattribs={"layer": "DIMENSION"},
        )
        self._state(entity, mark)
        entity.dimension.dxf.text = "<>"  # ezdxf would write a second sign before the number

    def _state(self, entity: DimStyleOverride, mark: Distance | Diameter) -> None:
        """Draw a dimension, and state what it measures, which ezdxf does not."""
        entity.render()
        entity.dimension.dxf.actual_measurement = self._length(mark.measure)

    def _override(self, mark: Distance | Diameter) -> dict[str, object]:
        return {"dimdec": mark.decimals, "dimpost": f"{mark.prefix}<>{mark.suffix}"}


# -- page -----------------------------------------------------------------------------------------
# A drawing as PDF and SVG, at true scale: coordinates are whole multiples of `GRAIN`.


POINT: Final = 25.4 / 72.0
"""Unit of a PDF [mm]."""

TURN: Final = 0.25 * math.pi
"""Largest angle of an arc [rad] that one cubic of a PDF replaces, within 1e-5 of the radius."""

Pieces = list[tuple[complex, complex, float, complex]]
"""Start and end in whole grains, angle turned [rad], centre of an arc."""


def svg(pages: Sequence[Strokes]) -> bytes:
    """The pages side by side in one picture: letters are defined once and used where they stand."""
    wide = sum(page.width for page in pages) + SHEET_GAP * (len(pages) - 1)
    high = max(page.height for page in pages)
    box = f'width="{wide:g}mm" height="{high:g}mm" viewBox="0 0 {_grains(wide)} {_grains(high)}"'
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" {box}>',
        '<rect width="100%" height="100%" fill="#fff"/>',
    ]
    left = 0.0
    for number, page in enumerate(pages):
        head = f'<g transform="translate({_grains(left)} 0)">' if number else "<g>"
        lines += [head, *_svg_page(page, number), "</g>"]
        left += page.width + SHEET_GAP
    return "\n".join([*lines, "</svg>", ""]).encode()


def _grains(length: float) -> int:
    return round(length / GRAIN)


def _svg_page(page: Strokes, number: int) -> Iterator[str]:
    top = _grains(page.height)
    yield '<g fill="none" stroke="#000" stroke-linejoin="round">'
    for width, strokes in sorted(page.lines.items()):
        path = "".join(_svg_stroke(stroke, top) for stroke in strokes)
        yield f'<path stroke-width="{_grains(0.01 * width)}" d="{path}"/>'
    yield "</g>"
    yield "<defs>"
    for shape, name in page.shapes.items():
        yield f'<path id="s{number}-{name}" d="{_svg_outline(shape)}"/>'
    yield "</defs>"
    for name, origin in page.places:
        yield f'<use href="#s{number}-{name}" x="{origin.real:.0f}" y="{top - origin.imag:.0f}"/>'


def _svg_stroke(stroke: Chain, top: int) -> str:
    pieces = _pieces(stroke)
    if not pieces:
        return ""
    commands = [f"M{pieces[0][0].real:.0f} {top - pieces[0][0].imag:.0f}"]
    for start, end, sweep, centre in pieces:
        way = f"{_number(end.real - start.real)}{_signed(start.imag - end.imag)}"
        if sweep:
            radius = f"{abs(start - centre):.0f}"
            flags = f"{int(abs(sweep) > math.pi)} {int(sweep < 0.0)}"
            commands.append(f"a{radius} {radius} 0 {flags} {way}")
        else:
            commands.append(f"l{way}")
    return "".join([*commands, "z"] if stroke.closed else commands)


def _svg_outline(outline: Outline) -> str:
    commands, here = [], 0j
    for word, points in outline:
        commands.append(word.lower())
        ways = [point - here for point in points]
        commands.append("".join(f"{_signed(w.real)}{_signed(-w.imag)}" for w in ways).strip())
        here = points[-1] if points else here
    return "".join(commands)


def _number(value: float) -> str:
    return f"{value + 0.0:.0f}"


def _signed(value: float) -> str:
    """A number after another one: a minus separates them."""
    text = _number(value)
    return text if text.startswith("-") else f" {text}"


def _pieces(stroke: Chain) -> Pieces:
    """The pieces of a stroke that are longer than a grain."""
    points = [rounded(vertex) for vertex in stroke.vertices.tolist()]
    sweeps = stroke.sweeps.tolist()
    if stroke.closed:
        points.append(points[0])
    exact = [*stroke.vertices.tolist(), complex(stroke.vertices[0])]
    pieces: Pieces = []
    for (start, end), sweep, one, other in zip(pairwise(points), sweeps, exact, exact[1:],
                                               strict=False):  # fmt: skip
        if start != end:
            centre = 0j
            if sweep:
                # On the bisector of the chord, half the chord over the tangent of half the sweep
                # from it.
                centre = 0.5 * (one + other) + 0.5j * (other - one) / math.tan(0.5 * sweep)
            pieces.append((start, end, sweep, centre))
    return pieces


def pdf(pages: Sequence[Strokes]) -> bytes:
    """A document with a page for each."""
    # Objects 1 to 3 are catalogue, page tree and information; a page has two more, itself and its
    # contents.
    kids = " ".join(f"{4 + 2 * number} 0 R" for number in range(len(pages)))
    objects = [
        b"<< /Type /Catalog /Pages 2 0 R >>",
        f"<< /Type /Pages /Kids [ {kids} ] /Count {len(pages)} >>".encode(),
        b"<< /Creator (camgeo) >>",
    ]
    for number, page in enumerate(pages):
        size = f"{page.width / POINT:.4f} {page.height / POINT:.4f}"
        objects.append(
            f"<< /Type /Page /Parent 2 0 R /MediaBox [ 0 0 {size} ] /Resources << >>"
            f" /Contents {5 + 2 * number} 0 R >>".encode()
        )
        stream = zlib.compress("\n".join(_pdf_page(page)).encode(), 9)
        head = f"<< /Length {len(stream)} /Filter /FlateDecode >>\nstream\n".encode()
        objects.append(head + stream + b"\nendstream")
    data = bytearray(b"%PDF-1.4\n%\xc2\xb5\xc2\xb6\n")
    places = []
    for number, body in enumerate(objects):
        places.append(len(data))
        data += f"{number + 1} 0 obj\n".encode() + body + b"\nendobj\n"
    start = len(data)
    table = "".join(f"{place:010d} 00000 n \n" for place in places)
    data += f"xref\n0 {len(objects) + 1}\n0000000000 65535 f \n{table}".encode()
    data += f"trailer\n<< /Size {len(objects) + 1} /Root 1 0 R /Info 3 0 R >>\n".encode()
    return bytes(data + f"startxref\n{start}\n%%EOF\n".encode())


def _pdf_page(page: Strokes) -> Iterator[str]:
    grain = GRAIN / POINT
    yield f"{grain:.9f} 0 0 {grain:.9f} 0 0 cm 1 j"
    for width, strokes in sorted(page.lines.items()):
        yield f"{_grains(0.01 * width)} w"
        for stroke in strokes:
            yield from _pdf_stroke(stroke)
        yield "S"
    shapes = {name: " ".join(_pdf_outline(shape)) for shape, name in page.shapes.items()}
    for name, origin in page.places:
        yield f"q 1 0 0 1 {_xy(origin)} cm {shapes[name]} f Q"


def _xy(point: complex) -> str:
    return f"{_number(point.real)} {_number(point.imag)}"


def _pdf_stroke(stroke: Chain) -> Iterator[str]:
    pieces = _pieces(stroke)
    if not pieces:
        return
    yield f"{_xy(pieces[0][0])} m"
    for start, end, sweep, centre in pieces:
        if not sweep:
            yield f"{_xy(end)} l"
            continue
        count = math.ceil(abs(sweep) / TURN)
        turn = sweep / count
        # Arms of the cubic that meets the arc in its ends, their tangents and its middle.
        reach = 4.0 / 3.0 * math.tan(0.25 * turn)
        turned = np.exp(1j * turn * np.arange(count + 1))
        points = [start, *(centre + (start - centre) * factor for factor in turned[1:-1]), end]
        for one, other in pairwise(points):
            first = one + reach * 1j * (one - centre)
            second = other - reach * 1j * (other - centre)
            yield f"{_xy(first)} {_xy(second)} {_xy(other)} c"
    if stroke.closed:
        yield "h"


def _pdf_outline(outline: Outline) -> Iterator[str]:
    here = 0j
    for word, points in outline:
        if word == "Q":  # a quadratic as a cubic
            control, end = points
            points = (here + 2 / 3 * (control - here), end + 2 / 3 * (control - end), end)
        numbers = " ".join(map(_xy, points))
        letter = {"M": "m", "L": "l", "Q": "c", "C": "c", "Z": "h"}[word]
        yield f"{numbers} {letter}".strip()
        here = points[-1] if points else here


# -- strokes --------------------------------------------------------------------------------------
# What is drawn on a page: lines and arcs by their widths, letters and other filled areas.
#
# Lines come from the sheet itself, with its arcs; texts and dimensions are decomposed by the
# drawing add-on of ezdxf. Everything is black.


GRAIN: Final = 0.005
"""Unit of coordinates on a page [mm], which are whole multiples of it."""


RECTANGLE = 4
"""Corners of a face without chamfers."""


WRITTEN: Final = frozenset(("TEXT", "DIMENSION"))
"""Entities that ezdxf decomposes."""

Outline = tuple[tuple[str, tuple[complex, ...]], ...]
"""A filled outline: commands "M", "L", "Q", "C" and "Z" with their points, in grains."""


@dataclass(slots=True)
class Strokes:
    """What is drawn on a page.

    Attributes
    ----------
    width, height : of the page [mm].
    lines : by the width of the line [1/100 mm], in grains.
    shapes : filled outlines, each from its own first point.
    places : number of each filled outline, and where its first point is [grains].
    """

    width: float
    height: float
    lines: dict[int, list[Chain]] = field(default_factory=dict)
    shapes: dict[Outline, int] = field(default_factory=dict)
    places: list[tuple[int, complex]] = field(default_factory=list)

    def add(self, width: int, stroke: Chain) -> None:
        """Add a line of some width [1/100 mm]."""
        self.lines.setdefault(width, []).append(stroke)

    def fill(self, outline: Iterable[tuple[str, tuple[complex, ...]]]) -> int:
        """Add a filled outline [grains]; return its number."""
        commands = list(outline)
        origin = commands[0][1][0]
        shape = tuple(
            (w, tuple(rounded(point - origin) for point in points)) for w, points in commands
        )
        number = self.shapes.setdefault(shape, len(self.shapes))
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


def sheet_strokes(document: Drawing, sheet: Sheet) -> Strokes:
    """What is drawn on a sheet; `document` has no other sheet."""
    strokes = Strokes(sheet.width, sheet.height)
    views = [(view.marks, view.origin, sheet.scale) for view in sheet.views]
    frame = (sheet.marks, 0j, 1.0)
    for marks, origin, scale in (*views, frame):
        for mark in marks:
            for stroke in _strokes(mark, origin, scale):
                strokes.add(LAYERS[stroke.layer][2], stroke)
    for marks, origin, scale in (frame, *views):
        for mark in marks:
            if isinstance(mark, Filled):
                strokes.fill(
                    _polygon([(origin + scale * corner) / GRAIN for corner in mark.corners])
                )
    low = corners([sheet])[0] / MM_PER[sheet.unit]
    backend = _StrokeBackend(strokes, low, sheet.scale * MM_PER[sheet.unit] / GRAIN)
    config = Configuration(
        color_policy=ColorPolicy.BLACK, background_policy=BackgroundPolicy.OFF,
        min_lineweight=0.0,
    )  # fmt: skip
    Frontend(RenderContext(document), backend, config=config).draw_layout(
        document.modelspace(),
        finalize=False,
        filter_func=lambda entity: entity.dxftype() in WRITTEN,
    )
    return strokes


def _strokes(mark: Mark, origin: complex, scale: float) -> Iterator[Chain]:
    """The lines of a mark [grains], hidden ones in dashes."""
    if isinstance(mark, Round):
        points = (origin + scale * mark.quarters) / GRAIN
        yield Chain(points, np.full(4, 0.5 * np.pi), mark.layer, closed=True)
    elif isinstance(mark, Hatched):
        for ends in hatching(mark, HATCHING / scale):
            points = np.array([(origin + scale * end) / GRAIN for end in ends], np.complex128)
            yield Chain(points, np.zeros(2), "HATCH")
    elif isinstance(mark, Chain):
        chains: Iterable[Chain] = (mark,)
        if mark.layer == "HIDDEN":
            chains = dashed_stretch(mark, scale, (HIDDEN[1], -HIDDEN[2]))
        for chain in chains:
            yield replace(chain, vertices=(origin + scale * chain.vertices) / GRAIN)


def hatching(face: Hatched, step: float) -> Iterator[tuple[complex, complex]]:
    """The lines of a cut face, at 45 degrees and `step` [mm] apart, through the same points in all
    faces of a view.
    """
    x0, x1 = float(face.corners.real.min()), float(face.corners.real.max())
    y0, y1 = float(face.corners.imag.min()), float(face.corners.imag.max())
    # Lines at 45 degrees are sqrt(2) times as far apart along an axis.
    along = step * math.sqrt(2.0)
    for number in range(math.ceil((y0 - x1) / along), math.floor((y1 - x0) / along) + 1):
        rise = number * along
        start, end = max(x0, y0 - rise), min(x1, y1 - rise)
        if len(face.corners) != RECTANGLE:
            start, end = _inside(face.corners, rise, start, end)
        if start < end:
            yield complex(start, start + rise), complex(end, end + rise)


def _inside(corners: ComplexArray, rise: float, start: float, end: float) -> tuple[float, float]:
    """The range of x in which the line y = x + `rise`, x from `start` to `end`, lies inside a
    convex polygon that runs counter-clockwise; empty, with its start not below its end, if outside.
    """
    for one, other in zip(corners.tolist(), np.roll(corners, -1).tolist(), strict=True):
        # Distance of the line from the side, times its length: at x = 0, and its change with x.
        normal = 1j * (other - one)  # inwards
        at_zero = ((complex(0.0, rise) - one) * normal.conjugate()).real
        pace = normal.real + normal.imag
        if pace > 0.0:
            start = max(start, -at_zero / pace)
        elif pace < 0.0:
            end = min(end, -at_zero / pace)
        elif at_zero < 0.0:
            return 0.0, 0.0
    return start, end


def _polygon(points: list[complex]) -> Iterator[tuple[str, tuple[complex, ...]]]:
    yield "M", (points[0],)
    for point in points[1:]:
        yield "L", (point,)
    yield "Z", ()


class _StrokeBackend(Backend):
    """Turns texts and dimensions into lines and outlines; a backend of ezdxf's drawing add-on."""

    def __init__(self, strokes: Strokes, low: complex, factor: float) -> None:
        super().__init__()
        self._strokes, self._low, self._factor = strokes, low, factor
        self._letters: dict[tuple[bytes, bytes], int] = {}

    def _grain_point(self, point: Vec2) -> complex:
        return (complex(point.x, point.y) - self._low) * self._factor

    def draw_line(self, start: Vec2, end: Vec2, properties: BackendProperties) -> None:
        """Add a line of a dimension."""
        ends = np.array([self._grain_point(start), self._grain_point(end)], np.complex128)
        self._strokes.add(
            round(100.0 * properties.lineweight), Chain(ends, np.zeros(2), "DIMENSION")
        )

    def draw_filled_paths(self, paths: Iterable[BkPath2d], properties: BackendProperties) -> None:
        """Add letters, each as an outline that later ones of the same shape share."""
        for path in paths:
            if not len(path):
                continue
            corners = path.np_vertices()
            points = (corners[:, 0] + 1j * corners[:, 1] - self._low) * self._factor
            shape = np.rint(points - points[0]) + 0.0
            key = bytes(path.command_codes()), shape.tobytes()
            if key in self._letters:
                self._strokes.places.append((self._letters[key], rounded(complex(points[0]))))
            else:
                self._letters[key] = self._strokes.fill(self._outline(path))

    def _outline(self, path: BkPath2d) -> Iterator[tuple[str, tuple[complex, ...]]]:
        yield "M", (self._grain_point(path.start),)
        for element in path.commands():
            end = self._grain_point(Vec2(element.end))
            if isinstance(element, LineTo):
                yield "L", (end,)
            elif isinstance(element, Curve3To):
                yield "Q", (self._grain_point(Vec2(element.ctrl)), end)
            elif isinstance(element, Curve4To):
                yield (
                    "C",
                    (
                        self._grain_point(Vec2(element.ctrl1)),
                        self._grain_point(Vec2(element.ctrl2)),
                        end,
                    ),
                )
            else:
                yield "Z", ()
                yield "M", (end,)
        yield "Z", ()

    def draw_filled_polygon(self, points: BkPoints2d, properties: BackendProperties) -> None:
        """Add an arrow."""
        self._strokes.fill(_polygon([self._grain_point(point) for point in points.vertices()]))

    def draw_point(self, pos: Vec2, properties: BackendProperties) -> None:
        """Draw nothing: points of dimensions are not visible."""

    def draw_image(self, image_data: ImageData, properties: BackendProperties) -> None:
        """Draw nothing: sheets have no images."""

    def set_background(self, color: Color) -> None:
        """Set nothing: the background is that of the paper."""

    def clear(self) -> None:
        """Clear nothing: each backend is used once."""


# -- writer ---------------------------------------------------------------------------------------


def _known_document(product: Product, tolerance: float) -> tuple[tuple[Sheet, ...], Drawing]:
    """The sheets and their document, once for all files of a disc."""
    known = product.pictured.known
    name = f"{FORMAT.name} within {tolerance!r} mm"
    if name not in known:
        sheets = build_sheets(product, tolerance)
        know_the_font()
        known[name] = sheets, sheet_document(sheets, product, tolerance)
    entry: tuple[tuple[Sheet, ...], Drawing] = known[name]
    return entry


def _pages(product: Product, tolerance: float) -> tuple[Strokes, ...]:
    """What is drawn on each sheet, once for PDF and SVG."""
    known = product.pictured.known
    name = f"pages of the {FORMAT.name} within {tolerance!r} mm"
    if name not in known:
        sheets, document = _known_document(product, tolerance)
        documents = [document]
        if len(sheets) > 1:
            documents = [sheet_document([sheet], product, tolerance) for sheet in sheets]
        known[name] = tuple(map(sheet_strokes, documents, sheets))
    pages: tuple[Strokes, ...] = known[name]
    return pages


def with_pair(product: Product) -> tuple[Product, ...]:
    """What has a sheet each: the disc, and with a main disc the pair that is one piece."""
    return (product,) if product.pair is None else (product, product.pair)


@dataclass(frozen=True, slots=True)
class PageWriter:
    """Writes the sheets as pictures.

    Attributes
    ----------
    format : with the suffix of the file.
    encode : makes a file of pages.
    """

    format: Format[None]
    encode: Callable[[Sequence[Strokes]], bytes]
    pieces = staticmethod(with_pair)

    def write(self, product: Product, tolerance: float) -> Written:
        """The whole sheets, at their scale."""
        return Written(self.encode(_pages(product, tolerance)))

    def measure(self, product: Product, data: bytes) -> None:
        """None: the drawing itself is measured."""


@dataclass(frozen=True, slots=True)
class DrawingWriter:
    """Writes the sheet as DXF.

    Attributes
    ----------
    format : with the suffix of the file.
    companions : writers of PDF and SVG.
    """

    format: Format[None]
    companions: tuple[PageWriter, ...]
    pieces = staticmethod(with_pair)

    def write(self, product: Product, tolerance: float) -> Written:
        """The sheet; the edges of the part lie within `tolerance` [mm]."""
        sheets, document = _known_document(product, tolerance)
        facts: dict[str, int | float | str] = {
            "scale": sheets[0].ratio,
            "dimensions": sum(len(sheet.dimensions) for sheet in sheets),
        }
        findings = tuple(finding for sheet in sheets for finding in sheet.findings())
        return Written(document_bytes(document), facts, findings)

    def measure(self, product: Product, data: bytes) -> float:
        """Read the sheet back, without ezdxf: edges and dimensions against the part [mm]."""
        return measure(product, data)


PDF: Final = PageWriter(replace(FORMAT, suffix="-drawing.pdf"), pdf)
SVG: Final = PageWriter(replace(FORMAT, suffix="-drawing.svg"), svg)
WRITER: Final = DrawingWriter(FORMAT, (PDF, SVG))


# -- measure --------------------------------------------------------------------------------------
# A sheet read back: its edges against the part, its dimensions against what they measure.


EDGES: Final = ("OUTLINE", "HIDDEN", "ENGRAVING")
"""Layers of the front view's edges, in the axes of the part."""

DIAMETER_SIGN: Final = 3
"""Type of a dimension of a diameter, in the lowest bits of group 70."""

KIND: Final = 7
"""The bits of group 70 that hold the type of a dimension."""


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation of the edges [mm].

    Raises FileError if a boundary is missing, or a dimension has a text of its own or does not
    state what its definition points are apart.
    """
    drawing = read_drawing(data)
    if drawing.scale() != MM_PER[product.unit]:
        raise FileError(f"$INSUNITS does not state {product.unit}")
    edges = tuple(item for item in drawing.items if item.layer in EDGES)
    contours = replace(drawing, items=edges).contours(None)  # an edge may be hidden in part
    largest = deviation(contours, product.drawn.part.boundaries)
    for item in drawing.items:
        if item.kind == "DIMENSION":
            largest = max(
                largest, abs(_stated_length(item) - measured_length(item)) * drawing.scale()
            )
    return largest


def _stated_length(item: Item) -> float:
    """The measurement that a dimension states, in units of the drawing."""
    if item.text(1) not in ("", "<>"):
        raise item.fault(f"has the text {item.text(1)!r} instead of what it measures")
    return item.number(42)


def measured_length(item: Item) -> float:
    """The distance of a dimension's definition points that it measures, in units of the drawing."""
    if int(item.number(70)) & KIND == DIAMETER_SIGN:
        return abs(item.point(10) - item.point(15))
    along = cmath.rect(1.0, math.radians(item.number(50, 0.0)))
    return abs(((item.point(14) - item.point(13)) * along.conjugate()).real)
