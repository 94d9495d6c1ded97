"""DXF: the part's boundaries as closed polylines with bulges or as splines, at true size.

R2010, one LWPOLYLINE a boundary on layer CUT. As splines a boundary is a chain of SPLINE entities,
cubic with knots and control points, and of an ARC or LINE each where it is one by nature. The pitch
curve, a polyline in either case, the base circle and the mark of the cam axis stand on layers of
their own, so that a shop can drop them. No text, no dimensions.

All that is alike in every drawing is a template: what ezdxf writes around layers and entities. The
library itself takes longer to import than the drawing to be made; the tests hold that it writes the
same bytes.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Iterator
from importlib.resources import files

from camgeo.contour.contour import Contour
from camgeo.contour.spline import Arc, CubicSpline, SplineContour
from camgeo.files.product import Product, Written
from camgeo.formats.dxf import FORMAT
from camgeo.part.part import Boundary
from camgeo.units import MM_PER, LengthUnit
from camgeo_export.dxf.curves import Curve
from camgeo_export.dxf.measure import measure
from camgeo_export.matching import reach_of

INSUNITS: dict[LengthUnit, int] = {"mm": 4, "inch": 1}
MEASUREMENT: dict[LengthUnit, int] = {"mm": 1, "inch": 0}

PITCH = "PITCH_CURVE"

LAYERS = {"CUT": 7, PITCH: 3, "BASE_CIRCLE": 5, "CENTRE": 1}
"""Layers with their colour numbers."""

FIT_SHARE = 0.98
"""Share of the tolerance that the fit may use; the rest is for rounding to the nearest double and
for the slack of the bound with which the file is measured."""

POLYLINE_SHARES = (0.6, 0.3)
"""Shares of the fit and of its chords, where a fit of arcs is to be drawn by straight pieces."""

CLOSED, PLANAR = 1, 8
"""Bits of group 70 of a closed LWPOLYLINE, and of a SPLINE that lies in a plane."""

MARK_SHARE = 0.1
"""Half length of the centre mark, as a share of the base radius."""

FIRST_HANDLE = 0x2F
"""Below it are the handles of the template: each layer, each entity, and what the template holds
behind them has one of its own."""

MODEL_SPACE = "17"
"""Handle of what owns the entities."""

Tags = list[tuple[int, float | str]]
"""Group codes with their values."""


class DxfWriter:
    """Writes a DXF drawing."""

    format = FORMAT

    def write(self, product: Product, tolerance: float) -> Written:
        """The drawing, in the unit of the product; all of it within `tolerance` [mm]."""
        drawing = product.options[FORMAT]
        straight = drawing.entity == "polyline"
        share = FIT_SHARE * tolerance
        cut = [_cut(boundary, product, share) for boundary in product.drawn.part.boundaries]
        has_pitch = drawing.auxiliary and product.drawn.has_pitch_curve
        pitch = _pitch(product, tolerance, straight) if has_pitch else None
        text = _drawing(product, tolerance, cut, pitch)
        return Written(text.encode("ascii"), _facts(product, cut))

    def measure(self, product: Product, data: bytes) -> float:
        """Read the drawing back and measure it against the exact curves [mm]."""
        return measure(product, data)


def _cut(boundary: Boundary, product: Product, share: float) -> Curve:
    """A boundary as it is drawn; a drawing of splines has no bulges, also in its bore."""
    entity = product.options[FORMAT].entity
    if entity == "spline":
        return boundary.spline(share, product.drawn.effort).contour.split(math.pi)
    if entity == "polyline":
        return boundary.polyline(share, product.drawn.effort).contour
    return boundary.arcs(share, product.drawn.effort).contour.split(math.pi)


def _facts(product: Product, cut: list[Curve]) -> dict[str, int | float | str]:
    """How many entities and pieces of each kind layer CUT holds."""
    splines = [
        spline for curve in cut if isinstance(curve, SplineContour) for spline in curve.splines
    ]
    singles = [arc for curve in cut if isinstance(curve, SplineContour) for arc in curve.arcs]
    polylines = [curve for curve in cut if isinstance(curve, Contour)]
    bent = sum(1 for arc in singles if arc.sweep)
    arcs = bent + sum(polyline.arc_count for polyline in polylines)
    lines = len(singles) - bent + sum(len(each) - each.arc_count for each in polylines)
    facts: dict[str, int | float | str] = {"boundaries": len(cut)}
    if product.options[FORMAT].entity == "spline":
        facts |= {"splines": len(splines), "cubics": sum(len(spline) for spline in splines)}
    return facts | {"arcs": arcs, "lines": lines}


def _pitch(product: Product, tolerance: float, straight: bool) -> Contour:
    if not straight:
        return product.drawn.pitch_contour(FIT_SHARE * tolerance).contour.split(math.pi)
    fit, chord = POLYLINE_SHARES
    points = product.drawn.pitch_contour(fit * tolerance).contour.points(chord * tolerance)
    return Contour.polygon(points)


def _drawing(product: Product, tolerance: float, cut: list[Curve], pitch: Contour | None) -> str:
    """The template with what this drawing has: layers, entities, and what made it.

    The latter stands in custom document properties: no text enters the drawing.
    """
    scale, auxiliary = MM_PER[product.unit], product.options[FORMAT].auxiliary
    entities = [entity for curve in cut for entity in _outline(curve, scale)]
    names = ["CUT"]
    if auxiliary:
        names = [name for name in LAYERS if pitch is not None or name != PITCH]
        entities += _auxiliary(product, pitch, scale)
    first = FIRST_HANDLE + len(names)
    layers = (_layer(name, FIRST_HANDLE + k) for k, name in enumerate(names))
    drawn = (_entity(*entity, first + k) for k, entity in enumerate(entities))
    behind = first + len(entities)
    reach = max(reach_of(curve) for curve in (*cut, *([] if pitch is None else [pitch]))) / scale
    values = {
        "version": product.version,
        "scene": product.scene_hash,
        "tolerance": repr(tolerance),
        "low": -reach,
        "high": reach,
        "measurement": MEASUREMENT[product.unit],
        "units": INSUNITS[product.unit],
        "count": len(names) + 2,  # 0 and Defpoints
        "layers": _spelled(layers),
        "entities": _spelled(drawn),
        "hatch": f"{behind:X}",
        "ezdxf": f"{behind + 1:X}",
        "written": f"{behind + 2:X}",
        "seed": f"{behind + 3:X}",
    }
    text = files("camgeo_export.dxf").joinpath("template.dxf").read_text("ascii")
    for mark, value in values.items():
        text = text.replace(f"<{mark}>", str(value))
    return text


def _spelled(records: Iterable[Tags]) -> str:
    return "".join(f"{code:3d}\n{value}\n" for tags in records for code, value in tags)


def _layer(name: str, handle: int) -> Tags:
    return [
        (0, "LAYER"), (5, f"{handle:X}"), (330, "1"), (100, "AcDbSymbolTableRecord"),
        (100, "AcDbLayerTableRecord"), (2, name), (70, 0), (62, LAYERS[name]), (6, "Continuous"),
        (370, -3), (390, "13"), (347, "21"),
    ]  # fmt: skip


Entity = tuple[str, str, Tags]
"""Type, layer, and the tags that are its own."""


def _entity(kind: str, layer: str, own: Tags, handle: int) -> Tags:
    head: Tags = [(0, kind), (5, f"{handle:X}"), (330, MODEL_SPACE), (100, "AcDbEntity")]
    return [*head, (8, layer), *own]


def _auxiliary(product: Product, pitch: Contour | None, scale: float) -> Iterator[Entity]:
    """Pitch curve if there is one, base circle and a cross at the cam axis."""
    if pitch is not None:
        yield _polyline(pitch, scale, PITCH)
    radius = product.drawn.base_radius / scale
    yield "CIRCLE", "BASE_CIRCLE", _circle(0j, radius)
    mark = MARK_SHARE * radius
    for end in (complex(mark, 0.0), complex(0.0, mark)):
        yield _line(-end, end, "CENTRE")


def _outline(curve: Curve, scale: float) -> Iterator[Entity]:
    """A boundary of the part on layer CUT."""
    if isinstance(curve, Contour):
        yield _polyline(curve, scale, "CUT")
        return
    for strand in curve.strands:
        if isinstance(strand, CubicSpline):
            yield _spline(strand, scale)
        elif strand.sweep:
            yield _arc(strand, scale)
        else:
            yield _line(_placed(strand.start, scale), _placed(strand.end, scale), "CUT")


def _polyline(contour: Contour, scale: float, layer: str) -> Entity:
    tags: Tags = [(100, "AcDbPolyline"), (90, len(contour)), (70, CLOSED)]
    for vertex, bulge in zip(contour.vertices.tolist(), contour.bulges.tolist(), strict=True):
        point = _placed(vertex, scale)
        tags += ((10, point.real), (20, point.imag))
        if bulge:
            tags.append((42, bulge))
    return "LWPOLYLINE", layer, tags


def _spline(spline: CubicSpline, scale: float) -> Entity:
    knots, controls = spline.knots.tolist(), spline.controls.tolist()
    tags: Tags = [(100, "AcDbSpline"), (70, PLANAR), (71, 3)]
    tags += [(72, len(knots)), (73, len(controls)), (74, 0), *((40, knot) for knot in knots)]
    for control in controls:
        tags += _point(_placed(control, scale))
    return "SPLINE", "CUT", tags


def _arc(arc: Arc, scale: float) -> Entity:
    ends = (arc.start, arc.end) if arc.sweep > 0.0 else (arc.end, arc.start)
    first, last = (math.degrees(cmath.phase(end - arc.centre)) + 0.0 for end in ends)
    circle = _circle(_placed(arc.centre, scale), arc.radius / scale)
    return "ARC", "CUT", [*circle, (100, "AcDbArc"), (50, first), (51, last)]


def _circle(centre: complex, radius: float) -> Tags:
    return [(100, "AcDbCircle"), *_point(centre), (40, radius)]


def _line(start: complex, end: complex, layer: str) -> Entity:
    return "LINE", layer, [(100, "AcDbLine"), *_point(start), *_point(end, 11)]


def _point(point: complex, code: int = 10) -> Tags:
    return [(code, point.real), (code + 10, point.imag), (code + 20, 0.0)]


def _placed(point: complex, scale: float) -> complex:
    """In the unit of the drawing; + 0.0 turns -0.0 into 0.0."""
    return complex(point.real / scale + 0.0, point.imag / scale + 0.0)


WRITER = DxfWriter()
