"""Verification of STEP files of upright solids, ours and those of CAD programs."""

from __future__ import annotations

from camgeo.errors import GeometryError
from camgeo.product.product import Product, title_of
from camgeo.verifying.verification import (
    Check,
    Origin,
    Reading,
    failed,
    length_of,
    unit_check,
)
from camgeo_export.errors import FileError
from camgeo_export.part21.model import Model
from camgeo_export.part21.solid import solid_of
from camgeo_export.part21.text import exchange_of
from camgeo_export.verify.bevels import slopes_of
from camgeo_export.verify.body import level_checks, no_body, slope_checks
from camgeo_export.verify.contents import contents_check, header_of
from camgeo_export.verify.inclined import slope_contours
from camgeo_export.verify.shell import bounds_of, gap, levels, shell_checks, volume_of

OURS, SCENE, TOLERANCE = "camgeo ", "scene ", "tolerance "
"""How the lines of the description in our files begin."""

TOPOLOGY = ("closed", "oriented")
"""Checks without which there are no boundaries to compare."""


class StepVerifier:
    """Verifies a STEP file."""

    format = "step"

    def origin(self, data: bytes) -> Origin:
        """From the description in the header."""
        try:
            values = header_of(exchange_of(data, whole=False), "FILE_DESCRIPTION").values
        except FileError as error:
            return Origin(damage=str(error))
        lines = values[0] if values and isinstance(values[0], tuple) else ()
        texts = [line for line in lines if isinstance(line, str)]

        def stated(word: str) -> str:
            return next((line.removeprefix(word) for line in texts if line.startswith(word)), "")

        ours = bool(texts) and texts[0].startswith(OURS)
        return Origin(ours, stated(SCENE), length_of(stated(TOLERANCE)))

    def checks(
        self, product: Product, data: bytes, reading: Reading, tolerance: float
    ) -> tuple[Check, ...]:
        """Unit, contents, the shell, and the solid against the part."""
        try:
            exchange = exchange_of(data)
            model = Model.of(exchange)
            solid = solid_of(model)
        except FileError as error:
            return (failed("file", str(error)),)
        part = product.drawn.part
        note = f"the scene is in {product.unit}"
        checks = [unit_check(solid.unit_name, reading, product.unit, note)]
        try:
            part.require_heights()
        except GeometryError as error:
            return (*checks, no_body(error))
        if reading.ours:
            checks.append(contents_check(exchange, model, solid, part, title_of(product)))
        stated = solid.uncertainty
        shell = shell_checks(solid, min(stated or tolerance, tolerance))
        checks += shell
        if not all(check.ok for check in shell if check.name in TOPOLOGY):
            return tuple(checks)
        bounds = bounds_of(solid)
        ranges, contours = levels(bounds, tolerance)
        base = 0.0 if reading.ours or not len(ranges) else float(ranges[0, 0])
        try:
            found = volume_of(bounds, solid.faces)
        except FileError as error:
            return (*checks, failed("body", str(error)))
        off = gap(solid)
        extent, own = product.drawn.base_radius, contours.__getitem__
        checks += level_checks(part, extent, ranges - base, own, found, tolerance, off)
        for slope in slopes_of(part):
            there = slope_contours(solid, slope.z0 + base, slope.z1 + base, tolerance)
            checks += slope_checks(slope, extent, there, tolerance, off)
        return tuple(checks)


VERIFIER = StepVerifier()
