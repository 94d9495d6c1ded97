"""3MF: the part as one mesh object in millimetres, or several on a plate, in double precision."""

from __future__ import annotations

import io
import math
import re
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from xml.etree import ElementTree as ET

import numpy as np

from camgeo.design.plate import plate_pieces
from camgeo.design.product import Product, display_title, solid_products
from camgeo.design.writing import Written
from camgeo.errors import FileError
from camgeo.numeric.arrays import FloatArray, IntArray
from camgeo.part.part import Part
from camgeo.scene.formats.threemf import FORMAT
from camgeo_export.solid.prism import Body, body, limit_facets
from camgeo_export.verify.body import measure

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
MODEL_PATH = "3D/3dmodel.model"

FRAME = {
    "[Content_Types].xml": b"<?xml version='1.0' encoding='UTF-8'?>\n"
    b'<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    b'<Default Extension="rels"'
    b' ContentType="application/vnd.openxmlformats-package.relationships+xml" />'
    b'<Default Extension="model"'
    b' ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml" /></Types>',
    "_rels/.rels": b"<?xml version='1.0' encoding='UTF-8'?>\n"
    b'<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    b'<Relationship Target="/3D/3dmodel.model" Id="model"'
    b' Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel" /></Relationships>',
}
"""The parts around the model, which are the same in all packages: the types of parts by their
endings, and which part is the model."""

NAMESPACE = "urn:camgeo:2026"
"""Namespace of our metadata; names outside the core specification must have one."""

VERTICES, TRIANGLES = "@vertices@", "@triangles@"
"""Marks in the XML that stand for vertices and triangles."""

FIXED_DATE = (1980, 1, 1, 0, 0, 0)
"""Earliest date that a zip can hold: the file's bytes depend only on its content."""

MATERIALS = "1"
"""Id of the colours, where there are any."""

UNIX = 3
"""Number of the system that made a zip entry; fixed, because zipfile writes that of the host."""


@dataclass(frozen=True, slots=True)
class Item:
    """An object of a package, and where it stands.

    Attributes
    ----------
    name : of the object.
    part : that it shows.
    colour : "#RRGGBB"; None for none.
    transform : of the item, as in the file; None for none.
    """

    name: str
    part: Part
    colour: str | None = None
    transform: str | None = None


def package_items(product: Product) -> tuple[Item, ...]:
    """The objects of the package: the disc about its cam axis, or the pieces on the plate."""
    plate = plate_pieces(product)
    if not plate:
        return (Item(display_title(product), product.drawn.printed.target),)
    return tuple(  # with the matrix of a shift, row by row
        Item(piece.name, piece.part, piece.colour, f"1 0 0 0 1 0 0 0 1 {piece.x!r} {piece.y!r} 0")
        for piece in plate
    )


class ThreeMfWriter:
    """Writes a 3MF package."""

    format = FORMAT

    def pieces(self, product: Product) -> tuple[Product, ...]:
        """The disc, or the pair that it is one piece with; a plate is that of the main disc."""
        return (
            () if (product.position and product.options[FORMAT].plate) else solid_products(product)
        )

    def write(self, product: Product, tolerance: float) -> Written:
        """The bodies [mm] within `tolerance` [mm]."""
        items = package_items(product)
        bodies = [body(item.part, tolerance, _exact) for item in items]
        triangles = sum(len(solid.triangles) for solid in bodies)
        limit_facets(triangles, "the bodies would have")
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w") as package:
            parts = FRAME | {MODEL_PATH: _model(product, tolerance, items, bodies)}
            for path, data in parts.items():
                entry = zipfile.ZipInfo(path, FIXED_DATE)
                entry.compress_type = zipfile.ZIP_DEFLATED
                entry.create_system = UNIX
                package.writestr(entry, data)
        plate = product.options[FORMAT].plate
        facts: dict[str, int | float | str] = {
            **({"bodies": ", ".join(plate)} if plate else {}),
            "triangles": triangles,
            "volume_mm3": math.fsum(solid.volume for solid in bodies),
            **product.drawn.printed.facts,
        }
        file = f"{product.name}{self.format.suffix}"
        return Written(stream.getvalue(), facts, product.drawn.printed.findings(file))

    def measure(self, product: Product, data: bytes) -> float:
        """Read the meshes back and measure each against the exact boundaries [mm].

        Raises FileError if the file is damaged, or if an object is not a closed body or does not
        have the name and the place that it should have.
        """
        items, meshes = package_items(product), read_meshes(data)
        places = [(item.name, item.transform) for item in items]
        if [(name, transform) for name, transform, *_ in meshes] != places:
            raise FileError("objects of the 3MF model, or their places, are not those of the scene")
        return max(
            measure(item.part, vertices, triangles)
            for item, (*_, vertices, triangles) in zip(items, meshes, strict=True)
        )


def _exact(values: FloatArray) -> FloatArray:
    return values + 0.0  # -0.0 becomes 0.0


def _model(
    product: Product, tolerance: float, items: Sequence[Item], bodies: Sequence[Body]
) -> bytes:
    """The model; an object for each of its vertices and triangles would take most of the time."""
    frame = ET.tostring(_frame(product, tolerance, items), "UTF-8", xml_declaration=True).decode()
    head, *parts = re.split(f"{VERTICES}|{TRIANGLES}", frame)
    written = [head]
    for solid, middle, tail in zip(bodies, parts[::2], parts[1::2], strict=True):
        written += [
            *(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}" />' for x, y, z in solid.vertices.tolist()),
            middle,
            *(f'<triangle v1="{a}" v2="{b}" v3="{c}" />' for a, b, c in solid.triangles.tolist()),
            tail,
        ]
    return "".join(written).encode()


def _frame(product: Product, tolerance: float, items: Sequence[Item]) -> ET.Element:
    """The model with marks in place of vertices and triangles."""
    attributes = {
        "xmlns": CORE,
        "xmlns:camgeo": NAMESPACE,
        "unit": "millimeter",
        "xml:lang": "en",
    }
    root = ET.Element("model", attributes)
    metadata = {
        "Title": display_title(product),
        "Application": f"camgeo {product.version}",
        "camgeo:scene": product.scene_hash,
        "camgeo:tolerance": f"{tolerance!r} mm",
    }
    printed = product.drawn.printed
    if printed.advice:
        metadata["Description"] = f"Compensated for printing: {printed.advice}"
    for name, value in metadata.items():
        ET.SubElement(root, "metadata", {"name": name}).text = value
    resources = ET.SubElement(root, "resources")
    coloured = [item for item in items if item.colour is not None]
    if coloured:
        group = ET.SubElement(resources, "basematerials", {"id": MATERIALS})
        for item in coloured:
            ET.SubElement(group, "base", {"name": item.name, "displaycolor": item.colour or ""})
    build = ET.Element("build")
    for number, item in enumerate(items):
        # The colours, if there are any, have taken the first id.
        object_attributes = {
            "id": str(number + 1 + bool(coloured)),
            "type": "model",
            "name": item.name,
        }
        if coloured:
            object_attributes |= {"pid": MATERIALS, "pindex": str(number)}
        mesh = ET.SubElement(ET.SubElement(resources, "object", object_attributes), "mesh")
        ET.SubElement(mesh, "vertices").text = VERTICES
        ET.SubElement(mesh, "triangles").text = TRIANGLES
        item_attributes = {"objectid": object_attributes["id"]}
        if item.transform is not None:
            item_attributes["transform"] = item.transform
        ET.SubElement(build, "item", item_attributes)
    root.append(build)
    return root


Mesh = tuple[str, str | None, FloatArray, IntArray]
"""An object: its name, the transform of its item as in the file (None for none), its vertices
(n, 3) [mm] before the transform, and its triangles (m, 3)."""


def read_meshes(data: bytes) -> tuple[Mesh, ...]:
    """The objects of one of our packages, each built once, in their order.

    Raises FileError if it is damaged or holds anything else.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as package:
            damaged = package.testzip()
            if damaged is not None:
                raise FileError(f"damaged entry {damaged} in the 3MF package")
            model = ET.fromstring(package.read(MODEL_PATH))
        objects = model.findall(f"{{{CORE}}}resources/{{{CORE}}}object")
        items = model.findall(f"{{{CORE}}}build/{{{CORE}}}item")
        if [element.get("objectid") for element in items] != [
            element.get("id") for element in objects
        ]:
            raise FileError("the 3MF package does not build each of its objects exactly once")
        meshes = tuple(_mesh(element, item) for element, item in zip(objects, items, strict=True))
    except (zipfile.BadZipFile, KeyError, ValueError, SyntaxError) as error:
        raise FileError(f"not a 3MF package by camgeo: {error}") from None
    if model.get("unit") != "millimeter":
        raise FileError("the 3MF model is not in millimetres")
    return meshes


def _mesh(element: ET.Element, item: ET.Element) -> Mesh:
    (mesh,) = element.findall(f"{{{CORE}}}mesh")
    vertices = np.array(_numbers(mesh, "vertices", "vertex", ("x", "y", "z")), np.float64)
    triangles = np.array(_numbers(mesh, "triangles", "triangle", ("v1", "v2", "v3")), np.int64)
    return element.get("name", ""), item.get("transform"), vertices, triangles


def _numbers(mesh: ET.Element, group: str, tag: str, names: tuple[str, ...]) -> list[list[str]]:
    elements = mesh.iterfind(f"{{{CORE}}}{group}/{{{CORE}}}{tag}")
    return [[element.attrib[name] for name in names] for element in elements]


WRITER = ThreeMfWriter()
