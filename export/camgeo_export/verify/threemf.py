"""Verification of 3MF packages, ours and others."""

from __future__ import annotations

import io
import zipfile
import zlib
from xml.etree import ElementTree as ET

from camgeo.product.product import Product
from camgeo.verifying.verification import Check, Origin, Reading, failed, length_of, unit_check
from camgeo_export.verify.body import mesh_checks
from camgeo_export.verify.package import package_checks

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
            _, metadata = _head(data)
        except (zipfile.BadZipFile, zlib.error, KeyError, SyntaxError, ValueError) as error:
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
        valid = package_checks(data, reading.ours, product.name)
        unit, _ = _head(data)
        name = SHORT.get(unit, unit)
        check = unit_check(name, reading, "mm", "our 3MF files are in millimetres")
        scale = MM_PER_UNIT.get(unit)
        if scale is None:
            return (*valid, check, failed("unit", f"{unit!r} is not a unit of 3MF"))
        return (*valid, check, *mesh_checks(product, data, "3mf", scale, tolerance))


def _head(data: bytes) -> tuple[str, dict[str, str]]:
    """Unit and metadata of the model; raises if the package or what is read from it is damaged."""
    with zipfile.ZipFile(io.BytesIO(data)) as package:
        damaged = package.testzip()
        if damaged is not None:
            raise ValueError(f"the entry {damaged} is damaged")
        models = [name for name in package.namelist() if name.lower().endswith(MODEL)]
        if not models:
            raise ValueError("it contains no model")
        metadata: dict[str, str] = {}
        unit = "millimeter"
        with package.open(models[0]) as model:
            for event, element in ET.iterparse(model, events=("start", "end")):
                tag = element.tag.rpartition("}")[2]
                if event == "start" and tag == "model":
                    unit = element.get("unit", unit)
                elif event == "start" and tag in ("resources", "build"):
                    break
                elif event == "end" and tag == "metadata":
                    metadata[element.get("name", "")] = element.text or ""
    return unit, metadata


VERIFIER = ThreeMfVerifier()
