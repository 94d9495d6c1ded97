"""Lengths that files name in words."""

from __future__ import annotations

import math


def length_of(text: str) -> float | None:
    """The length in `text` [mm], e.g. "0.001" or "0.001 mm"; None if there is none above 0."""
    try:
        value = float(text.strip().removesuffix("mm"))
    except ValueError:
        return None
    return value if math.isfinite(value) and value > 0.0 else None
