"""3MF: the part as one mesh object in millimetres, in double precision."""

from __future__ import annotations

import io
import re
import zipfile
from xml.etree import ElementTree as ET

import numpy as np

from camgeo.formats.plain import THREEMF
from camgeo.numeric.arrays import FloatArray, IntArray
from camgeo.product.printed import SWITCH_OFF
from camgeo.product.product import Product, bodies_of, title_of
from camgeo.writing.writer import Written
from camgeo_export.errors import FileError
from camgeo_export.solid.measure import measure
from camgeo_export.solid.prism import Body, body

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
CONTENT_TYPES = "http://schemas.openxmlformats.org/package/2006/content-types"
RELATIONSHIPS = "http://schemas.openxmlformats.org/package/2006/relationships"
MODEL_TYPE = "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"
RELATIONSHIP_TYPE = "application/vnd.openxmlformats-package.relationships+xml"
MODEL_RELATION = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
MODEL_PATH = "3D/3dmodel.model"
CONTENT_TYPES_PATH = "[Content_Types].xml"
RELATIONSHIPS_PATH = "_rels/.rels"

NAMESPACE = "urn:camgeo:2026"
"""Namespace of our metadata; names outside the core specification must have one."""

VERTICES, TRIANGLES = "@vertices@", "@triangles@"
"""Marks in the XML."""

FIXED_DATE = (1980, 1, 1, 0, 0, 0)
"""Earliest date that a zip can hold: the file's bytes depend only on its content."""

UNIX = 3
"""Number of the system that made a zip entry; fixed, because zipfile writes that of the host."""


class ThreeMfWriter:
    """Writes a 3MF package."""

    format = THREEMF

    def write(self, product: Product, tolerance: float) -> Written:
        """The body [mm] within `tolerance` [mm]."""
        solid = body(product.drawn.printed.target, tolerance, _exact)
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w") as package:
            _store(package, CONTENT_TYPES_PATH, _xml(_content_types()))
            _store(package, RELATIONSHIPS_PATH, _xml(_relationships()))
            _store(package, MODEL_PATH, _model(product, tolerance, solid))
        facts: dict[str, int | float | str] = {
            "triangles": len(solid.triangles),
            "volume_mm3": solid.volume,
            **product.drawn.printed.facts,
        }
        file = f"{product.name}{self.format.suffix}"
        return Written(stream.getvalue(), facts, product.drawn.printed.findings(file))

    def pieces(self, product: Product) -> tuple[Product, ...]:
        """The disc, or the pair that it is one piece with."""
        return bodies_of(product)

    def measure(self, product: Product, data: bytes) -> float:
        """Read the mesh back and measure it against the exact boundaries [mm].

        Raises FileError if the file is damaged or not a closed body.
        """
        return measure(product, *mesh_of(data))


def _exact(values: FloatArray) -> FloatArray:
    return values + 0.0  # -0.0 becomes 0.0


def _xml(root: ET.Element) -> bytes:
    found: bytes = ET.tostring(root, "UTF-8", xml_declaration=True)
    return found


def _store(package: zipfile.ZipFile, path: str, data: bytes) -> None:
    entry = zipfile.ZipInfo(path, FIXED_DATE)
    entry.compress_type = zipfile.ZIP_DEFLATED
    entry.create_system = UNIX
    package.writestr(entry, data)


def _content_types() -> ET.Element:
    root = ET.Element("Types", {"xmlns": CONTENT_TYPES})
    for extension, kind in (("rels", RELATIONSHIP_TYPE), ("model", MODEL_TYPE)):
        attributes = {"Extension": extension, "ContentType": kind}
        ET.SubElement(root, "Default", attributes)
    return root


def _relationships() -> ET.Element:
    root = ET.Element("Relationships", {"xmlns": RELATIONSHIPS})
    attributes = {"Target": f"/{MODEL_PATH}", "Id": "model", "Type": MODEL_RELATION}
    ET.SubElement(root, "Relationship", attributes)
    return root


def _model(product: Product, tolerance: float, solid: Body) -> bytes:
    """The model; an object for each of its vertices and triangles would take most of the time."""
    frame = _xml(_frame(product, tolerance)).decode()
    before, between, after = re.split(f"{VERTICES}|{TRIANGLES}", frame)
    vertices = (f'<vertex x="{x!r}" y="{y!r}" z="{z!r}" />' for x, y, z in solid.vertices.tolist())
    triangles = (f'<triangle v1="{a}" v2="{b}" v3="{c}" />' for a, b, c in solid.triangles.tolist())
    return "".join((before, *vertices, between, *triangles, after)).encode()


def _frame(product: Product, tolerance: float) -> ET.Element:
    """The model with marks in place of vertices and triangles."""
    attributes = {
        "xmlns": CORE,
        "xmlns:camgeo": NAMESPACE,
        "unit": "millimeter",
        "xml:lang": "en",
    }
    root = ET.Element("model", attributes)
    metadata = {
        "Title": title_of(product),
        "Application": f"camgeo {product.version}",
        "camgeo:scene": product.scene_hash,
        "camgeo:tolerance": f"{tolerance!r} mm",
    }
    if product.drawn.printed.text:
        metadata["Description"] = (
            f"Compensated for printing: {product.drawn.printed.text}; {SWITCH_OFF}"
        )
    for name, value in metadata.items():
        ET.SubElement(root, "metadata", {"name": name}).text = value
    resources = ET.SubElement(root, "resources")
    item = ET.SubElement(
        resources, "object", {"id": "1", "type": "model", "name": title_of(product)}
    )
    mesh = ET.SubElement(item, "mesh")
    ET.SubElement(mesh, "vertices").text = VERTICES
    ET.SubElement(mesh, "triangles").text = TRIANGLES
    build = ET.SubElement(root, "build")
    ET.SubElement(build, "item", {"objectid": "1"})
    return root


def mesh_of(data: bytes) -> tuple[FloatArray, IntArray]:
    """Vertices (n, 3) [mm] and triangles (m, 3) of one of our packages: one mesh, untransformed.

    Raises FileError if it is damaged or holds anything else.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as package:
            damaged = package.testzip()
            if damaged is not None:
                raise FileError(f"damaged entry {damaged} in the 3MF package")
            model = ET.fromstring(package.read(MODEL_PATH))
        (mesh,) = model.findall(f"{{{CORE}}}resources/{{{CORE}}}object/{{{CORE}}}mesh")
        (item,) = model.findall(f"{{{CORE}}}build/{{{CORE}}}item")
        vertices = np.array(_numbers(mesh, "vertices", "vertex", ("x", "y", "z")), np.float64)
        triangles = np.array(_numbers(mesh, "triangles", "triangle", ("v1", "v2", "v3")), np.int64)
    except (zipfile.BadZipFile, KeyError, ValueError, SyntaxError) as error:
        raise FileError(f"not a 3MF package by camgeo: {error}") from None
    if model.get("unit") != "millimeter" or item.get("transform") is not None:
        raise FileError("the 3MF model is not in millimetres, or not where it should be")
    return vertices, triangles


def _numbers(mesh: ET.Element, group: str, tag: str, names: tuple[str, ...]) -> list[list[str]]:
    found = mesh.iterfind(f"{{{CORE}}}{group}/{{{CORE}}}{tag}")
    return [[each.attrib[name] for name in names] for each in found]


WRITER = ThreeMfWriter()
