"""A 3MF read back with trimesh and held against the part."""

from __future__ import annotations

import io
import zipfile

import numpy as np
import trimesh

from camgeo.files.product import Product
from camgeo_export.errors import FileError
from camgeo_export.solid.measure import measure as measure_body

HEAD_BYTES = 1000
"""Enough of the model to hold its first tag."""


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation [mm]; raises FileError if the file is damaged or no closed body."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as package:
            damaged = package.testzip()
            head = package.read("3D/3dmodel.model")[:HEAD_BYTES]
        if damaged is not None:
            raise FileError(f"damaged entry {damaged} in the 3MF package")
        # trimesh does not look at the unit
        if b'unit="millimeter"' not in head:
            raise FileError("the 3MF model is not in millimetres")
        mesh = trimesh.load_mesh(io.BytesIO(data), file_type="3mf", process=False)
    except (zipfile.BadZipFile, KeyError, SyntaxError) as error:
        raise FileError(f"not a 3MF package of ours: {error}") from None
    return measure_body(product, np.array(mesh.vertices), np.array(mesh.faces))
