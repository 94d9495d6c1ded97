"""Verification of SVG drawings at true size: our own, and those of drawing programs."""

from __future__ import annotations

import re
from dataclasses import replace

from camgeo.design.product import Product
from camgeo.design.verify import Check, Origin, Reading, failed, length_of, reported
from camgeo.errors import CamgeoError, FileError
from camgeo.scene.formats.format import CUT_SVG
from camgeo_export.reading import layered
from camgeo_export.svg import check_contents
from camgeo_export.svg_reader import check_xml, drawing_of
from camgeo_export.verify.plane import contour_checks, matched, shapes_of

NOTE = re.compile(
    rb"<desc>camgeo [^;<]{1,100}; scene ([0-9a-f]{1,64}); tolerance ([-+.0-9e]{1,40}) mm</desc>"
)
"""What our drawings state of themselves."""

HEAD_BYTES = 10_000
"""Part of a drawing that holds it."""


class CutSvgVerifier:
    """Verifies an SVG drawing at true size."""

    format = CUT_SVG.name

    def origin(self, data: bytes) -> Origin:
        """From the description."""
        try:
            check_xml(data, "the file")
        except FileError as error:
            return Origin(damage=str(error))
        found = NOTE.search(data[:HEAD_BYTES])
        damage = "" if data.rstrip().endswith(b"</svg>") else "not a complete SVG drawing"
        if found is None:
            return Origin(damage=damage)
        return Origin(True, found[1].decode(), length_of(found[2].decode()), damage)

    def checks(
        self, product: Product, data: bytes, reading: Reading, tolerance: float
    ) -> tuple[Check, ...]:
        """Size, contents, and each closed contour against its boundary."""
        try:
            drawing = drawing_of(data, reading.name)
        except CamgeoError as error:
            return (failed("file", str(error)),)
        layers = layered(product)
        checks = [reported("unit", drawing.scale, "mm", note="of one unit of the drawing")]
        read = {"": drawing.contours}
        wanted = {"": product.drawn.part.boundaries}
        if reading.ours:
            try:
                check_contents(drawing, tuple(layers))
            except FileError as error:
                return (*checks, failed("contents", str(error)))
            checks.append(Check("contents", "", f"{len(read[''])} paths", ok=True))
            read = {name: tuple(drawing.layers.get(name, ())) for name in layers}
            wanted = layers
        for name, contours in read.items():
            shapes = shapes_of(wanted[name], product.drawn.base_radius, tolerance)
            pairs, count = matched(contours, shapes)
            checks.append(count if len(read) == 1 else replace(count, of=f"layer {name}"))
            for shape, contour in pairs:
                checks += contour_checks(shape, contour, tolerance)
        return tuple(checks)


VERIFIER = CutSvgVerifier()
