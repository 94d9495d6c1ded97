"""DXF: the part's boundaries as closed polylines with bulges or as splines, at true size.

R2010, one LWPOLYLINE per boundary, on layer CUT if it goes through the disc, else on a layer named
by its depth (`camgeo_export.reading`). As splines a boundary is a chain of cubic SPLINE entities
with knots and control points, and an ARC or LINE wherever it is exactly one. The pitch curve,
always a polyline, the base circle and the mark of the cam axis are on their own layers, so that a
shop can remove them. No text, no dimensions.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from ezdxf import options  # type: ignore[attr-defined] # exported, but not declared
from ezdxf.document import Drawing as Document
from ezdxf.entities.lwpolyline import LWPolylinePoints
from ezdxf.filemanagement import new
from ezdxf.layouts.layout import Modelspace
from ezdxf.lldxf.types import DXFTag

from camgeo.design.product import Product, display_title
from camgeo.design.writing import Written
from camgeo.errors import FileError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.spline import CubicSpline, SplineContour, as_spline_contour
from camgeo.numeric.arrays import ComplexArray, FloatArray, phase
from camgeo.part.part import WRITTEN_SHARE, Boundary, written_contour
from camgeo.reading import DRAWING_LINES
from camgeo.scene.formats.dxf import FORMAT, SINGLE
from camgeo.units import MM_PER, LengthUnit, counted
from camgeo_export.dxf.reader import Drawing, read_drawing
from camgeo_export.reading import CUT, AnyContour, boundaries_by_layer
from camgeo_export.verify.plane import deviation

PITCH = "PITCH_CURVE"

AUXILIARY = {PITCH: 3, "BASE_CIRCLE": 5, "CENTRE": 1}
"""Layers besides those of the part, and their colour numbers."""

THROUGH, NOT_THROUGH = 7, 6
"""Colour numbers of layer CUT, and of the layers of edges that are not to be cut through."""

POLYLINE_SHARES = (0.6, 0.3)
"""Shares of the fit and of its chords where arcs are to be drawn as straight pieces."""

LINES = 4
"""Lines of the file for a vertex or a control point, at least."""

PLANAR = 8
"""Bit of group 70 that marks a SPLINE as planar."""

MARK_SHARE = 0.1
"""Half length of the centre mark, as a share of the base radius."""


class DxfWriter:
    """Writes a DXF drawing."""

    format = FORMAT

    def write(self, product: Product, tolerance: float) -> Written:
        """The drawing, in the unit of the product; all of it within `tolerance` [mm]."""
        drawing = product.options[FORMAT]
        straight = drawing.entity == "polyline"
        cut = {
            name: [_cut(boundary, product, tolerance) for boundary in boundaries]
            for name, boundaries in boundaries_by_layer(product).items()
        }
        curves = [curve for layer in cut.values() for curve in layer]
        has_pitch = drawing.auxiliary and product.drawn.has_pitch_curve
        pitch = _pitch(product, tolerance, straight) if has_pitch else None
        _limit(sum(map(len, (*curves, *([] if pitch is None else [pitch])))))
        document = new_document(product, tolerance)
        _draw(document.modelspace(), product, cut, pitch)
        return Written(document_bytes(document), _facts(product, curves))

    def measure(self, product: Product, data: bytes) -> float:
        """Read the drawing back, without ezdxf: largest proved deviation [mm] of all that is drawn.

        Raises FileError if the drawing is incomplete, foreign or in the wrong unit.
        """
        drawing = read_drawing(data)
        _check(drawing, product)
        largest = max(
            deviation(drawing.contours(name), boundaries)
            for name, boundaries in boundaries_by_layer(product).items()
        )
        if not product.options[FORMAT].auxiliary:
            return largest
        scale = drawing.scale()
        circles = [item for item in drawing.items if item.layer == "BASE_CIRCLE"]
        pitch = drawing.contours("PITCH_CURVE") if product.drawn.has_pitch_curve else ()
        if len(pitch) > 1 or len(circles) != 1:
            raise FileError("the drawing must have one base circle and at most one pitch curve")
        x, y, radius = (circles[0].number(code) * scale for code in (10, 20, 40))
        largest = max(largest, abs(complex(x, y)) + abs(radius - product.drawn.base_radius))
        for contour in pitch:
            assert isinstance(contour, Contour)  # a polyline, by `_check`
            largest = max(largest, product.drawn.pitch_deviation(contour))
        return largest


def _limit(pieces: int) -> None:
    """Raise FileError if a drawing of that many pieces could not be read back."""
    if LINES * pieces > DRAWING_LINES:
        raise FileError(
            f"the drawing would have {counted(pieces, 'piece')} of at least {LINES} lines of text;"
            f" at most {DRAWING_LINES:,} are allowed in a drawing that is read; a larger tolerance"
            " needs fewer"
        )


def _cut(boundary: Boundary, product: Product, tolerance: float) -> AnyContour:
    """A boundary as drawn; a drawing of splines or of single lines and arcs has no bulges, not even
    in the bore.
    """
    drawing = product.options[FORMAT]
    curve = written_contour(boundary, drawing.form, product.drawn.effort, tolerance).contour
    return (
        as_spline_contour(curve)
        if drawing.entity == SINGLE and isinstance(curve, Contour)
        else curve
    )


def _facts(product: Product, cut: list[AnyContour]) -> dict[str, int | float | str]:
    """How many entities and pieces of each kind the layers of the part hold."""
    splines = [
        spline for curve in cut if isinstance(curve, SplineContour) for spline in curve.splines
    ]
    singles = [arc for curve in cut if isinstance(curve, SplineContour) for arc in curve.arcs]
    polylines = [curve for curve in cut if isinstance(curve, Contour)]
    bent = sum(1 for arc in singles if arc.sweep)
    arcs = bent + sum(polyline.arc_count for polyline in polylines)
    lines = len(singles) - bent + sum(len(polyline) - polyline.arc_count for polyline in polylines)
    facts: dict[str, int | float | str] = {"boundaries": len(cut)}
    if product.options[FORMAT].entity == "spline":
        facts |= {"splines": len(splines), "cubics": sum(len(spline) for spline in splines)}
    return facts | {"arcs": arcs, "lines": lines}


def _pitch(product: Product, tolerance: float, straight: bool) -> Contour:
    if not straight:
        return product.drawn.pitch_contour(WRITTEN_SHARE * tolerance).contour.split(math.pi)
    fit, chord = POLYLINE_SHARES
    points = product.drawn.pitch_contour(fit * tolerance).contour.points(chord * tolerance)
    return Contour.polygon(points)


def _draw(
    space: Modelspace, product: Product, cut: dict[str, list[AnyContour]], pitch: Contour | None
) -> None:
    scale, auxiliary = MM_PER[product.unit], product.options[FORMAT].auxiliary
    for name in cut:
        space.doc.layers.add(name, color=THROUGH if name == CUT else NOT_THROUGH)
    for name, colour in AUXILIARY.items():
        if auxiliary and (pitch is not None or name != PITCH):
            space.doc.layers.add(name, color=colour)
    for name, curves in cut.items():
        for contour in curves:
            if isinstance(contour, SplineContour):
                _strands(space, contour, scale, name)
            else:
                _polyline(space, contour, scale, name)
    visible = [curve for layer in cut.values() for curve in layer]
    if auxiliary:
        _auxiliary(space, product, pitch, scale)
        visible += [
            *([pitch] if pitch is not None else []),
            Contour.circle(product.drawn.base_radius),
        ]
    show(space, visible, scale)


def _auxiliary(space: Modelspace, product: Product, pitch: Contour | None, scale: float) -> None:
    """Pitch curve if there is one, base circle and a cross at the cam axis."""
    if pitch is not None:
        _polyline(space, pitch, scale, PITCH)
    radius = product.drawn.base_radius / scale
    space.add_circle((0.0, 0.0), radius, dxfattribs={"layer": "BASE_CIRCLE"})
    mark = MARK_SHARE * radius
    for x, y in ((mark, 0.0), (0.0, mark)):
        space.add_line((-x, -y), (x, y), dxfattribs={"layer": "CENTRE"})


def _polyline(space: Modelspace, contour: Contour, scale: float, layer: str) -> None:
    # + 0.0 turns -0.0 into 0.0
    x = contour.vertices.real / scale + 0.0
    y = contour.vertices.imag / scale + 0.0
    bulges = np.tan(contour.sweeps / 4.0) + 0.0
    width = np.zeros(len(x))
    polyline = space.add_lwpolyline([], close=True, dxfattribs={"layer": layer})
    # All at once: ezdxf copies the whole array for each point that is appended.
    polyline.lwpoints = _Vertices()
    polyline.lwpoints.set(np.column_stack((x, y, width, width, bulges)))


class _Vertices(LWPolylinePoints):
    """Vertices of a polyline whose text is made at once, not by an object for each number."""

    def dxftags(self) -> Iterator[_Text]:
        """The vertices as text: code 10 and 20 for x and y, 42 for a bulge that is not 0."""
        rows = self.values[:, [0, 1, 4]].tolist()
        yield _Text(
            "".join(
                f" 10\n{x}\n 20\n{y}\n 42\n{bulge}\n" if bulge else f" 10\n{x}\n 20\n{y}\n"
                for x, y, bulge in rows
            )
        )


class _Text(DXFTag):
    """The text of many tags, written as it is."""

    __slots__ = ()

    def __init__(self, text: str) -> None:
        super().__init__(0, text)

    def dxfstr(self) -> str:
        text: str = self.value
        return text


def _strands(space: Modelspace, contour: SplineContour, scale: float, layer: str) -> None:
    for strand in contour.strands:
        attributes = {"layer": layer}
        if isinstance(strand, CubicSpline):
            points = [_xy(point, scale) for point in strand.controls.tolist()]
            spline = space.add_open_spline(
                points, degree=3, knots=strand.knots.tolist(), dxfattribs=attributes
            )
            spline.dxf.flags = PLANAR  # ezdxf sets it to 0 on creation
        elif strand.sweep:
            # An ARC runs counter-clockwise, so a clockwise one is stated from its end.
            ends = (strand.start, strand.end) if strand.sweep > 0.0 else (strand.end, strand.start)
            first, last = (math.degrees(phase(end - strand.centre)) for end in ends)
            centre, radius = _xy(strand.centre, scale), strand.radius / scale
            space.add_arc(centre, radius, first + 0.0, last + 0.0, dxfattribs=attributes)
        else:
            space.add_line(_xy(strand.start, scale), _xy(strand.end, scale), dxfattribs=attributes)


def _xy(point: complex, scale: float) -> tuple[float, float]:
    # + 0.0 turns -0.0 into 0.0
    return point.real / scale + 0.0, point.imag / scale + 0.0


WRITER = DxfWriter()


# -- view -----------------------------------------------------------------------------------------
# What a drawing shows when it is opened: its extents, its limits and the view of the model space.
#
# Most programs open a drawing in the view that it states, wherever its entities lie.


MARGIN = 0.05
"""Margin of the view on each side, as a fraction of the larger side of the drawing."""

ASPECT = 4.0 / 3.0
"""Width of the view over its height. The view is as high as the drawing is wide, so a window of any
shape shows the whole drawing."""

ACTIVE = "*Active"
"""Name of the view that is open."""


def show(space: Modelspace, contours: Sequence[Contour | SplineContour], scale: float) -> None:
    """Fit extents, limits and view to what is drawn: `contours` [mm], at `scale` mm per unit."""
    points = np.concatenate([_extremes(contour) for contour in contours]) / scale
    low = complex(points.real.min(), points.imag.min())
    high = complex(points.real.max(), points.imag.max())
    size = max((high - low).real, (high - low).imag)
    margin = MARGIN * size * (1.0 + 1.0j)
    space.reset_extents((low.real, low.imag, 0.0), (high.real, high.imag, 0.0))
    least, most = low - margin, high + margin
    space.reset_limits((least.real, least.imag), (most.real, most.imag))
    middle = 0.5 * (low + high)
    (view,) = space.doc.viewports.get_config(ACTIVE)
    view.dxf.center = (middle.real, middle.imag)
    view.dxf.height = (1.0 + 2.0 * MARGIN) * size
    view.dxf.aspect_ratio = ASPECT


def _extremes(contour: Contour | SplineContour) -> ComplexArray:
    """(n,) complex [mm] points on the contour, the outermost ones along both axes among them."""
    if isinstance(contour, Contour):
        return _piece_extremes(contour.vertices, contour.sweeps, contour.centres)
    rows = [(arc.start, arc.sweep, arc.centre) for arc in contour.arcs]
    starts, sweeps, centres = np.array(rows, dtype=np.complex128).reshape(-1, 3).T
    splines = [_cubic_extremes(spline.beziers) for spline in contour.splines]
    return np.concatenate((_piece_extremes(starts, sweeps.real, centres), *splines))


def _piece_extremes(
    starts: ComplexArray, sweeps: FloatArray, centres: ComplexArray
) -> ComplexArray:
    """The starts of the pieces, and the points at which arcs run parallel to an axis."""
    bent = sweeps != 0.0
    arc_starts, centres, sweeps = starts[bent], centres[bent], sweeps[bent]
    arm = arc_starts - centres
    points = [starts]
    for direction in (1.0, 1.0j, -1.0, -1.0j):
        turned = np.angle(direction / arm) * np.sign(sweeps) % (2.0 * np.pi)
        reached = turned <= np.abs(sweeps)
        points.append((centres + np.abs(arm) * direction)[reached])
    return np.concatenate(points)


def _cubic_extremes(pieces: ComplexArray) -> ComplexArray:
    """The ends of (n, 4) Bezier pieces, and the points at which they run parallel to an axis."""
    points = [pieces[:, 0], pieces[:, 3]]
    for values in (pieces.real, pieces.imag):
        a, b, c = np.diff(values, axis=1).T
        # The derivative is proportional to a (1 - t)^2 + 2 b t (1 - t) + c t^2. Its roots in the
        # form a / (a - b +- root) also hold where the square of t vanishes; those outside of the
        # piece are replaced by its ends.
        root = np.sqrt(np.maximum(b * b - a * c, 0.0))
        for bottom in (a - b + root, a - b - root):
            share = np.where(bottom == 0.0, 0.0, a) / np.where(bottom == 0.0, 1.0, bottom)
            share = np.clip(share, 0.0, 1.0)[:, None]
            level = pieces
            while level.shape[1] > 1:  # de Casteljau's algorithm
                level = (1.0 - share) * level[:, :-1] + share * level[:, 1:]
            points.append(level[:, 0])
    return np.concatenate(points)


# -- file -----------------------------------------------------------------------------------------
# What all DXF files of ours have in common: their units, their origin, and the same bytes.


INSUNITS: dict[LengthUnit, int] = {"mm": 4, "inch": 1}
UNITS_OF_HEADER: dict[LengthUnit, int] = {"mm": 1, "inch": 0}


@contextmanager
def _fixed_metadata() -> Iterator[None]:
    """Drawings without time stamps and random identifiers, which ezdxf stamps on a file when
    creating and when writing it; its setting is restored.
    """
    previous = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = previous


@_fixed_metadata()
def new_document(product: Product, tolerance: float) -> Document:
    """An empty drawing in the unit of the product; custom document properties record the file's
    origin, so that no text enters the drawing.
    """
    document = new("R2010", units=INSUNITS[product.unit])
    document.header["$MEASUREMENT"] = UNITS_OF_HEADER[product.unit]
    properties = {
        "camgeo": product.version,
        "scene": product.scene_hash,
        "tolerance mm": repr(tolerance),
        **({"title": display_title(product)} if display_title(product) != product.name else {}),
    }
    for label, value in properties.items():
        document.header.custom_vars.append(label, value)
    return document


@_fixed_metadata()
def document_bytes(document: Document) -> bytes:
    """The document as a file."""
    # ezdxf declares the classes in use in the order of a set, which differs between runs.
    for kind in sorted(document.entitydb.dxf_types_in_use()):
        document.classes.add_class(kind)
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue().encode(document.output_encoding)


# -- measure ---------------------------------------------------------------------------------------
# A drawing read back and compared with the exact curves.


KINDS: dict[str, tuple[str, ...]] = {
    "PITCH_CURVE": ("LWPOLYLINE",),
    "BASE_CIRCLE": ("CIRCLE",),
    "CENTRE": ("LINE",),
}
"""What each auxiliary layer holds; anything else does not belong in the drawing."""

PART_KINDS: dict[str, tuple[str, ...]] = {
    "arcs": ("LWPOLYLINE",),
    SINGLE: ("ARC", "LINE"),
    "polyline": ("LWPOLYLINE",),
    "spline": ("SPLINE", "ARC", "LINE"),
}
"""What the layers of the part hold, by the option `entity`."""

MEASUREMENT = {"mm": "1", "inch": "0"}


def _check(drawing: Drawing, product: Product) -> None:
    options = product.options[FORMAT]
    kinds = dict(KINDS) if options.auxiliary else {}
    kinds |= dict.fromkeys(boundaries_by_layer(product), PART_KINDS[options.entity])
    if not product.drawn.has_pitch_curve:
        kinds.pop("PITCH_CURVE", None)
    for item in drawing.items:
        if item.kind not in kinds.get(item.layer, ()):
            raise FileError(f"{item.kind} on layer {item.layer} is not part of the drawing")
    if drawing.scale() != MM_PER[product.unit]:
        raise FileError(f"$INSUNITS does not state {product.unit}")
    if drawing.value("$MEASUREMENT") != MEASUREMENT[product.unit]:
        raise FileError(f"$MEASUREMENT does not state {product.unit}")
