"""The edges of a part seen from above: which go through the disc, which end at a depth.

A drawing has one edge per boundary. Whoever cuts a part from a sheet needs to know which edges go
through; a blind one would be cut through otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from camgeo.contour.simple import winding_number
from camgeo.part.part import Boundary, Layer, Part

Kind = Literal["through", "sunk", "raised"]
"""An edge goes through the disc, is sunk into it from a face, or stands on a face of it."""


COARSE: Final = 0.01
"""Tolerance [mm] of the contours that show which holes lie within others."""


@dataclass(frozen=True, slots=True)
class Edge:
    """A boundary as it is drawn.

    Attributes
    ----------
    boundary : of the part.
    kind : see `Kind`.
    below : whether it begins at the lower face of the disc, not at its upper one.
    by : depth or height over that face [mm]; 0 if the edge goes through, or if the scene does not
        state it.
    """

    boundary: Boundary
    kind: Kind = "through"
    below: bool = False
    by: float = 0.0


def edges_of(part: Part) -> tuple[Edge, ...]:
    """The edges, in the order of the part's boundaries."""
    return tuple(_edge(part, boundary) for boundary in part.boundaries)


def _edge(part: Part, boundary: Boundary) -> Edge:
    """Sunk is what lies within the heights of the disc, from the face that it is open to."""
    disc = part.disc
    if all(boundary in layer.boundaries or _is_open(boundary, layer) for layer in disc):
        return Edge(boundary)
    bottom, top = disc[0].z0, disc[-1].z1
    own = [layer for layer in part.layers if boundary in layer.boundaries]
    z0, z1 = own[0].z0, own[-1].z1
    if not any(layer in disc for layer in own):
        below = own[-1] in part.layers[: part.layers.index(disc[0])]
        return Edge(boundary, "raised", below, bottom - z0 if below else z1 - top)
    below = boundary in disc[0].boundaries
    return Edge(boundary, "sunk", below, z1 - bottom if below else top - z0)


def _is_open(boundary: Boundary, layer: Layer) -> bool:
    """Whether a hole goes on through a layer within a wider one, as below a counterbore."""
    if not boundary.hole:
        return False
    start = complex(boundary.beside(COARSE).contour.vertices[0])
    return any(
        each.hole and winding_number(each.beside(COARSE).contour, start)
        for each in layer.boundaries
    )
