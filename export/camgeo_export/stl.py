"""STL, binary: the part as a body. Always in millimetres, as the format has no unit."""

from __future__ import annotations

import numpy as np

from camgeo.design.product import Product, solid_products
from camgeo.design.writing import Written
from camgeo.errors import FileError
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.formats.format import STL
from camgeo_export.solid.prism import body
from camgeo_export.verify.body import measure

HEADER_BYTES = 80

PREFIX = HEADER_BYTES + 4
"""Size in bytes of what precedes the facets: header and number of facets."""

FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


class StlWriter:
    """Writes a binary STL."""

    format = STL
    pieces = staticmethod(solid_products)  # the disc, or the pair that it is one piece with

    def write(self, product: Product, tolerance: float) -> Written:
        """The body [mm] within `tolerance` [mm], including the rounding to STL's single floats."""
        solid = body(product.drawn.printed.target, tolerance, _single)
        corners = solid.vertices[solid.triangles]
        facets = np.zeros(len(corners), dtype=FACET)
        facets["corners"] = corners
        facets["normal"] = _normals(corners)
        data = _header(product) + np.uint32(len(facets)).tobytes() + facets.tobytes()
        facts = {
            "triangles": len(facets),
            "volume_mm3": solid.volume,
            **product.drawn.printed.facts,
        }
        return Written(
            data, facts, product.drawn.printed.findings(f"{product.name}{self.format.suffix}")
        )

    def measure(self, product: Product, data: bytes) -> float:
        """Read the mesh back and measure it against the exact boundaries [mm].

        Raises FileError if the file is truncated or not a closed body.
        """
        count = int.from_bytes(data[HEADER_BYTES:PREFIX], "little")
        if len(data) != PREFIX + FACET.itemsize * count or b" unit mm " not in data[:PREFIX]:
            raise FileError("not a complete binary STL in mm by camgeo")
        vertices = np.frombuffer(data, FACET, offset=PREFIX)["corners"].reshape(-1, 3)
        triangles = np.arange(len(vertices)).reshape(-1, 3)
        return measure(product.drawn.printed.target, vertices.astype(np.float64), triangles)


def _single(values: FloatArray) -> FloatArray:
    return values.astype(np.float32).astype(np.float64)


def _normals(corners: FloatArray) -> FloatArray:
    """(m, 3) outward unit normals of the triangles `corners` (m, 3, 3)."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    # + 0.0 turns -0.0 into 0.0
    return normals / np.where(lengths > 0.0, lengths, 1.0) + 0.0


def _header(product: Product) -> bytes:
    """80 bytes; they must not begin with "solid", which marks the text form."""
    text = f"camgeo {product.version} unit mm scene {product.scene_hash[:16]} {product.name}"
    return text.encode("ascii", "replace")[:HEADER_BYTES].ljust(HEADER_BYTES)


WRITER = StlWriter()
