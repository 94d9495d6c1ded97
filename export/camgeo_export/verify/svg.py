"""Verification of SVG drawings at true size: our own, and those of drawing programs."""

from __future__ import annotations

import re

from camgeo.design.product import Product
from camgeo.design.verify import Check, Origin, ReadingOptions, failed, parse_tolerance, reported
from camgeo.errors import CamgeoError, FileError
from camgeo.scene.formats.format import CUT_SVG
from camgeo_export.reading import ARC_SLACK, text_tokens
from camgeo_export.svg import check_xml, read_drawing
from camgeo_export.verify.plane import all_checks, boundary_shapes

NOTE = re.compile(
    rb"<desc>camgeo ([^;<]{1,100}); scene ([0-9a-f]{1,64}); tolerance ([-+.0-9e]{1,40}) mm</desc>"
)
"""What our drawings state of themselves."""

HEAD_BYTES = 10_000
"""Length of the beginning of a drawing that holds its description [bytes]."""


class CutSvgVerifier:
    """Verifies an SVG drawing at true size."""

    format = CUT_SVG.name
    slack = ARC_SLACK
    tokens = staticmethod(text_tokens)

    def origin(self, data: bytes) -> Origin:
        """The origin that the description states."""
        try:
            check_xml(data, "the file")
        except FileError as error:
            return Origin(damage=str(error))
        match = NOTE.search(data[:HEAD_BYTES])
        damage = "" if data.rstrip().endswith(b"</svg>") else "not a complete SVG drawing"
        if match is None:
            return Origin(damage=damage)
        version, scene, tolerance = (group.decode("utf-8", "replace") for group in match.groups())
        return Origin(version, scene, parse_tolerance(tolerance), damage)

    def checks(
        self, product: Product, data: bytes, reading: ReadingOptions, tolerance: float
    ) -> tuple[Check, ...]:
        """Size, and each closed contour against its boundary."""
        try:
            drawing = read_drawing(data, reading.name)
        except CamgeoError as error:
            return (failed("file", str(error)),)
        unit = reported("unit", drawing.scale, "mm", note="of one unit of the drawing")
        shapes = boundary_shapes(
            product.drawn.part.boundaries, product.drawn.base_radius, tolerance
        )
        return (unit, *all_checks(drawing.contours, shapes, tolerance))


VERIFIER = CutSvgVerifier()
