"""The triangles of solids, as the scripts of pages take them."""

from __future__ import annotations

import base64
from typing import Final

import numpy as np

FACET: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
"""A triangle of a binary STL."""

PREFIX: Final = 84
"""Bytes of a binary STL before its triangles."""


def triangles(stl: bytes) -> str:
    """Three coordinates [mm] of three corners of each triangle of a binary STL, in base 64: single
    precision, little-endian.
    """
    corners = np.frombuffer(stl, FACET, offset=PREFIX)["corners"]
    return base64.b64encode(np.ascontiguousarray(corners).tobytes()).decode()
