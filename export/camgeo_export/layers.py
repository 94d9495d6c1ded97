"""Layers of drawings by depth: what is cut through, and what is not."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np

from camgeo.part.edges import Edge, edges_of
from camgeo.part.part import Boundary
from camgeo.product.product import Product
from camgeo.units import MM_PER

CUT: Final = "CUT"
"""Layer of the edges that go through the disc."""

WORDS: Final = {"sunk": "BLIND", "raised": "RAISED"}

BELOW: Final = "BELOW"

DIGITS: Final = 6
"""Significant digits of a depth in the name of a layer."""


def layer_name(edge: Edge, scale: float) -> str:
    """Layer of an edge: "CUT", or e.g. "BLIND_6", "BLIND_BELOW_2.5", "RAISED_12".

    The number is the depth or height, `scale` mm to the unit; there is none if the scene states
    none.
    """
    if edge.kind == "through":
        return CUT
    words = [WORDS[edge.kind]]
    if edge.below:
        words.append(BELOW)
    if edge.by:
        by = edge.by / scale
        words.append(np.format_float_positional(by, DIGITS, fractional=False, trim="-"))
    return "_".join(words)


def layered(product: Product) -> dict[str, tuple[Boundary, ...]]:
    """The boundaries of the part by layers, CUT first."""
    found: dict[str, tuple[Boundary, ...]] = {CUT: ()}
    for edge in edges_of(product.drawn.part):
        name = layer_name(edge, MM_PER[product.unit])
        found[name] = (*found.get(name, ()), edge.boundary)
    return found


def of_the_part(layers: Iterable[str]) -> set[str]:
    """Those of `layers` that are named like layers of a part's edges."""
    heads = tuple(f"{word}_" for word in WORDS.values())
    known = (CUT, *WORDS.values())
    return {name for name in layers if name in known or name.startswith(heads)}
