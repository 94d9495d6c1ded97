"""Parallels of convex contours: a cutter runs around the outside of a blank."""

from __future__ import annotations

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.errors import GeometryError
from camgeo.toolpath.plane.track import Track

CORNER = 1e-9
"""Turn [rad] below which two pieces join without a corner."""


def grown(contour: Contour, by: float) -> Contour:
    """The parallel at `by` [mm] outside a convex contour, counter-clockwise, round at its corners.

    Raises
    ------
    GeometryError
        With key "stock", if the contour is not convex.
    """
    contour = contour.counter_clockwise()
    pieces = Track.around(contour).pieces
    leaving, arriving = pieces.tangents(pieces.starts), pieces.tangents(pieces.ends)
    turns = np.angle(leaving * np.conj(np.roll(arriving, 1)))
    if np.any(turns < -CORNER) or np.any(contour.sweeps < 0.0):
        raise GeometryError("the outline of the blank must be convex", "stock")
    vertices: list[complex] = []
    sweeps: list[float] = []
    centres: list[complex] = []
    for k, turn in enumerate(turns.tolist()):
        corner = complex(contour.vertices[k])
        if turn > CORNER:
            vertices.append(corner - 1j * by * complex(arriving[k - 1]))
            sweeps.append(turn)
            centres.append(corner)
        vertices.append(corner - 1j * by * complex(leaving[k]))
        sweeps.append(float(contour.sweeps[k]))
        centres.append(complex(contour.centres[k]))
    return Contour(np.array(vertices), np.array(sweeps), np.array(centres))
