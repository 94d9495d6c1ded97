"""The faces of a disc, as scenes name them."""

from __future__ import annotations

from typing import Final

UPPER: Final = "upper"
LOWER: Final = "lower"
BOTH: Final = "both"

SIDES: Final = (UPPER, LOWER, BOTH)
"""Faces of the disc on which a hub stands, or whose edges have a chamfer."""
