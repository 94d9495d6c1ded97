"""Verification of 3MF packages, ours and others."""

from __future__ import annotations

import io
from collections.abc import Mapping
from xml.etree import ElementTree as ET

from camgeo.product.plate import plate_of
from camgeo.product.product import Product, title_of
from camgeo.verifying.verification import Check, Origin, Reading, failed, length_of, unit_check
from camgeo_export.errors import FileError
from camgeo_export.threemf.parts import check_bodies, packed, parts_of
from camgeo_export.threemf.writer import MODEL_PATH
from camgeo_export.verify.body import compensation_checks, mesh_checks
from camgeo_export.verify.model import core
from camgeo_export.verify.package import model_path, package_checks
from camgeo_export.verify.plate import plate_checks

MM_PER_UNIT = {
    "micron": 1e-3,
    "millimeter": 1.0,
    "centimeter": 10.0,
    "inch": 25.4,
    "foot": 304.8,
    "meter": 1000.0,
}
"""Units of the 3MF core specification; a model without one is in millimetres."""

SHORT = {"millimeter": "mm"}

MODEL = ".model"


class ThreeMfVerifier:
    """Verifies a 3MF package."""

    format = "3mf"

    def origin(self, data: bytes) -> Origin:
        """From the metadata of the model."""
        try:
            parts = parts_of(data)
            check_bodies(parts)
            _, metadata = _head(parts)
        except (SyntaxError, FileError) as error:
            return Origin(damage=f"not a complete 3MF package: {error}")
        return Origin(
            metadata.get("Application", "").startswith("camgeo "),
            metadata.get("camgeo:scene", ""),
            length_of(metadata.get("camgeo:tolerance", "")),
        )

    def checks(
        self, product: Product, data: bytes, reading: Reading, tolerance: float
    ) -> tuple[Check, ...]:
        """Package, unit, and the body against the part."""
        parts = parts_of(data)
        plate = plate_of(product) if reading.ours else ()
        valid = package_checks(parts, reading.ours, title_of(product), plate)
        unit, _ = _head(parts)
        name = SHORT.get(unit, unit)
        check = unit_check(name, reading, "mm", "camgeo's 3MF files are in millimetres")
        scale = MM_PER_UNIT.get(unit)
        if scale is None:
            return (*valid, check, failed("unit", f"{unit!r} is not a unit of 3MF"))
        if plate:
            checks = plate_checks(plate, parts, _model(parts), scale, tolerance)
            return (*valid, check, *compensation_checks(product), *checks)
        # A name that trimesh looks for, before all others, and that no part of a package has.
        whole = packed({f"/{MODEL_PATH}": _model(parts), **parts})
        return (*valid, check, *mesh_checks(product, whole, scale, tolerance))


def _head(parts: Mapping[str, bytes]) -> tuple[str, dict[str, str]]:
    """Unit and metadata of the model; raises FileError or SyntaxError if there is none."""
    model = _model(parts)
    metadata: dict[str, str] = {}
    unit = "millimeter"
    for event, element in ET.iterparse(io.BytesIO(model), events=("start", "end")):
        if event == "start" and element.tag == core("model"):
            unit = element.get("unit", unit)
        elif event == "start" and element.tag in (core("resources"), core("build")):
            break
        elif event == "end" and element.tag == core("metadata"):
            metadata[element.get("name", "")] = element.text or ""
    return unit, metadata


def _model(parts: Mapping[str, bytes]) -> bytes:
    """The model that the package leads to: there may be others, in other units. The first one of a
    package that is not valid, which its checks report.
    """
    try:
        return parts[model_path(parts)]
    except FileError:
        models = [part for name, part in parts.items() if name.lower().endswith(MODEL)]
    if not models:
        raise FileError("it contains no model")
    return models[0]


VERIFIER = ThreeMfVerifier()
