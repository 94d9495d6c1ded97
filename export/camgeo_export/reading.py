"""What all readers of files share: tokens, and the layers of drawings."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Final

import numpy as np

from camgeo.design.product import Product
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.spline import SplineContour
from camgeo.part.part import Boundary, PartEdge, part_edges
from camgeo.units import MM_PER

AnyContour = Contour | SplineContour


TOKEN: Final = re.compile(r"""[^\s,;()<>="']+|[,;()<>="']""")

NUMBER_SLACK: Final = 1e-9
"""Share of its size, or of 1, by which a number of a file may differ on another processor."""

ARC_SLACK: Final = 1e-5
"""The same for files that state centres or radii of arcs: the last digits of the ends of a flat arc
move its centre by much more."""


def text_tokens(data: bytes, place: str = "") -> Iterator[tuple[str, str]]:
    """The words, numbers and marks of a text, each with its `place`, by default its line."""
    for number, line in enumerate(data.decode("utf-8", "replace").splitlines(), 1):
        where = place or f"line {number}"
        for token in TOKEN.findall(line):
            yield where, token


# -- layers ---------------------------------------------------------------------------------------
# Layers of drawings by depth: what is cut through, and what is not.


CUT: Final = "CUT"
"""Layer of the edges that go through the disc."""

WORDS: Final = {"sunk": "BLIND", "raised": "RAISED"}

BELOW: Final = "BELOW"

DIGITS: Final = 6
"""Significant digits of a depth in the name of a layer."""


def layer_name(edge: PartEdge, scale: float) -> str:
    """Layer of an edge: "CUT", or e.g. "BLIND_6", "BLIND_BELOW_2.5", "RAISED_12".

    The number is the depth or height, `scale` mm to the unit; there is none if the scene states
    none.
    """
    if edge.kind == "through":
        return CUT
    words = [WORDS[edge.kind]]
    if edge.below:
        words.append(BELOW)
    if edge.height:
        depth = edge.height / scale
        words.append(np.format_float_positional(depth, DIGITS, fractional=False, trim="-"))
    return "_".join(words)


def boundaries_by_layer(product: Product) -> dict[str, tuple[Boundary, ...]]:
    """The boundaries of the part by layers, CUT first."""
    layers: dict[str, tuple[Boundary, ...]] = {CUT: ()}
    for edge in part_edges(product.drawn.part):
        name = layer_name(edge, MM_PER[product.unit])
        layers[name] = (*layers.get(name, ()), edge.boundary)
    return layers


def part_layers(layers: Iterable[str]) -> set[str]:
    """The `layers` that are named like layers of a part's edges."""
    heads = tuple(f"{word}_" for word in WORDS.values())
    known = (CUT, *WORDS.values())
    return {name for name in layers if name in known or name.startswith(heads)}
