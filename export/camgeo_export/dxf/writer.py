"""DXF: the part's boundaries as closed polylines with bulges, at true size.

R2010, one LWPOLYLINE a boundary on layer CUT. The pitch curve, the base circle and the mark of the
cam axis stand on layers of their own, so that a shop can drop them. No text, no dimensions.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterator
from contextlib import contextmanager

from ezdxf import options  # type: ignore[attr-defined] # exported, but not said so
from ezdxf.document import Drawing
from ezdxf.filemanagement import new
from ezdxf.layouts.layout import Modelspace

from camgeo.contour.contour import Contour
from camgeo.files.product import Product, Written
from camgeo.units import MM_PER, LengthUnit
from camgeo_export.dxf.measure import measure

INSUNITS: dict[LengthUnit, int] = {"mm": 4, "inch": 1}
MEASUREMENT: dict[LengthUnit, int] = {"mm": 1, "inch": 0}

LAYERS = {"CUT": 7, "PITCH_CURVE": 3, "BASE_CIRCLE": 5, "CENTRE": 1}
"""Layers with their colour numbers."""

FIT_SHARE = 0.9
"""Share of the tolerance that the fit may use; the rest is for rounding to the nearest double and
for the slack of the bound with which the file is measured."""

POLYLINE_SHARES = (0.6, 0.3)
"""Shares of the fit and of its chords, where a fit of arcs is to be drawn by straight pieces."""

MARK_SHARE = 0.1
"""Half length of the centre mark, as a share of the base radius."""


class DxfWriter:
    """Writes a DXF drawing."""

    suffix = ".dxf"
    needs: tuple[str, ...] = ()

    def write(self, product: Product, tolerance: float) -> Written:
        """The drawing, in the unit of the product; all of it within `tolerance` [mm]."""
        straight = product.dxf.entity == "polyline"
        share = FIT_SHARE * tolerance
        cut = [
            (boundary.polyline(share) if straight else boundary.arcs(share)).contour.split(math.pi)
            for boundary in product.part.boundaries
        ]
        pitch = _pitch(product, tolerance, straight) if product.dxf.auxiliary else None
        # ezdxf stamps time and random identifiers on a file at its making and at its writing
        with _fixed_metadata():
            document = new("R2010", units=INSUNITS[product.unit])
            document.header["$MEASUREMENT"] = MEASUREMENT[product.unit]
            _describe(document, product, tolerance)
            space = document.modelspace()
            _draw(space, product, cut, pitch)
            stream = io.StringIO()
            document.write(stream)
        arcs = sum(contour.arc_count for contour in cut)
        pieces = sum(len(contour) for contour in cut)
        facts: dict[str, int | float | str] = {
            "boundaries": len(cut),
            "arcs": arcs,
            "lines": pieces - arcs,
        }
        return Written(stream.getvalue().encode(document.output_encoding), facts)

    def measure(self, product: Product, data: bytes) -> float:
        """Read the drawing back, not with ezdxf, and measure it against the exact curves [mm]."""
        return measure(product, data)


def _pitch(product: Product, tolerance: float, straight: bool) -> Contour:
    if not straight:
        return product.pitch_contour(FIT_SHARE * tolerance).contour.split(math.pi)
    fit, chord = POLYLINE_SHARES
    points = product.pitch_contour(fit * tolerance).contour.points(chord * tolerance)
    return Contour(points, 0.0 * points.real, 0.0 * points)


@contextmanager
def _fixed_metadata() -> Iterator[None]:
    """Drawings without time stamps and random identifiers; ezdxf's setting is put back."""
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before


def _describe(document: Drawing, product: Product, tolerance: float) -> None:
    """Note what made the file as custom document properties: no text enters the drawing."""
    properties = document.header.custom_vars
    properties.append("camgeo", product.version)
    properties.append("scene", product.scene_hash)
    properties.append("tolerance mm", repr(tolerance))


def _draw(space: Modelspace, product: Product, cut: list[Contour], pitch: Contour | None) -> None:
    scale = MM_PER[product.unit]
    for name, colour in LAYERS.items():
        if name == "CUT" or pitch is not None:
            space.doc.layers.add(name, color=colour)
    for contour in cut:
        _polyline(space, contour, scale, "CUT")
    drawn = cut
    if pitch is not None:
        drawn = [*cut, pitch]
        _auxiliary(space, product, pitch, scale)
    reach = max(float(abs(contour.vertices).max()) for contour in drawn) / scale
    space.reset_extents((-reach, -reach, 0.0), (reach, reach, 0.0))


def _auxiliary(space: Modelspace, product: Product, pitch: Contour, scale: float) -> None:
    """Pitch curve, base circle and a cross at the cam axis."""
    _polyline(space, pitch, scale, "PITCH_CURVE")
    radius = product.base_radius / scale
    space.add_circle((0.0, 0.0), radius, dxfattribs={"layer": "BASE_CIRCLE"})
    mark = MARK_SHARE * radius
    for x, y in ((mark, 0.0), (0.0, mark)):
        space.add_line((-x, -y), (x, y), dxfattribs={"layer": "CENTRE"})


def _polyline(space: Modelspace, contour: Contour, scale: float, layer: str) -> None:
    # + 0.0 turns -0.0 into 0.0
    x = (contour.vertices.real / scale + 0.0).tolist()
    y = (contour.vertices.imag / scale + 0.0).tolist()
    bulges = (contour.bulges + 0.0).tolist()
    points = list(zip(x, y, bulges, strict=True))
    space.add_lwpolyline(points, format="xyb", close=True, dxfattribs={"layer": layer})


WRITER = DxfWriter()
