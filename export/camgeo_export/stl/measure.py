"""An STL read back with trimesh and held against the part."""

from __future__ import annotations

import io

import numpy as np
import trimesh

from camgeo.files.product import Product
from camgeo_export.errors import FileError
from camgeo_export.solid.measure import measure as measure_body

PREFIX = 84
"""Bytes before the facets: header and number of facets."""

FACET_BYTES = 50


def measure(product: Product, data: bytes) -> float:
    """Largest proved deviation [mm]; raises FileError if the file is cut or no closed body."""
    count = int.from_bytes(data[PREFIX - 4 : PREFIX], "little")
    if len(data) != PREFIX + FACET_BYTES * count or b" unit mm " not in data[:PREFIX]:
        raise FileError("not a whole binary STL in mm of ours")
    mesh = trimesh.load_mesh(io.BytesIO(data), file_type="stl", process=False)
    return measure_body(product, np.array(mesh.vertices), np.array(mesh.faces))
