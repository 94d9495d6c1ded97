"""A 3MF read back and held against the part."""

from __future__ import annotations

import io
import zipfile
from xml.etree import ElementTree as ET

import numpy as np

from camgeo.files.product import Product
from camgeo.numeric.arrays import FloatArray, IntArray
from camgeo_export.errors import FileError
from camgeo_export.solid.measure import measure as measure_body

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
"""Before the names of the tags of the core specification."""


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation [mm]; raises FileError if the file is damaged or no closed body."""
    return measure_body(product, *mesh_of(data))


def mesh_of(data: bytes) -> tuple[FloatArray, IntArray]:
    """Vertices (n, 3) [mm] and triangles (m, 3) of a package of ours: one mesh, as it stands.

    Raises FileError if it is damaged or holds anything else.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as package:
            damaged = package.testzip()
            if damaged is not None:
                raise FileError(f"damaged entry {damaged} in the 3MF package")
            model = ET.fromstring(package.read("3D/3dmodel.model"))
        (mesh,) = model.findall(f"{CORE}resources/{CORE}object/{CORE}mesh")
        (item,) = model.findall(f"{CORE}build/{CORE}item")
        vertices = np.array(_numbers(mesh, "vertices", "vertex", ("x", "y", "z")), np.float64)
        triangles = np.array(_numbers(mesh, "triangles", "triangle", ("v1", "v2", "v3")), np.int64)
    except (zipfile.BadZipFile, KeyError, ValueError, SyntaxError) as error:
        raise FileError(f"not a 3MF package of ours: {error}") from None
    if model.get("unit") != "millimeter" or item.get("transform") is not None:
        raise FileError("the 3MF model is not in millimetres, or not where it should be")
    return vertices, triangles


def _numbers(mesh: ET.Element, group: str, tag: str, names: tuple[str, ...]) -> list[list[str]]:
    found = mesh.iterfind(f"{CORE}{group}/{CORE}{tag}")
    return [[each.attrib[name] for name in names] for each in found]
