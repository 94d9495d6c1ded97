"""The closed path of a planned operation, without what leads onto it and off again."""

from __future__ import annotations

import cmath
import math

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.toolpath.moves import ArcFeed, Operation, Rapid


def planned_contour(operation: Operation) -> Contour:
    """Path of the tool centre at the first depth [mm], in the direction of cutting.

    Raises
    ------
    ValueError
        If the operation runs no closed path.
    """
    depth = operation.cut.depths[0]
    at: complex | None = None
    starts: list[complex] = []
    sweeps: list[float] = []
    centres: list[complex] = []
    reached: dict[complex, int] = {}
    for move in operation.moves:
        end = complex(move.end[0], move.end[1])
        flat = not isinstance(move, Rapid) and move.end[2] == depth and at is not None
        if flat and end != at:
            assert at is not None  # as `flat` says
            reached[at] = len(starts)
            starts.append(at)
            sweeps.append(_sweep(move, at, end) if isinstance(move, ArcFeed) else 0.0)
            centres.append(complex(*move.centre) if isinstance(move, ArcFeed) else 0j)
            if end in reached:
                first = reached[end]
                return Contour(
                    np.array(starts[first:]), np.array(sweeps[first:]), np.array(centres[first:])
                )
        at = end
    raise ValueError(f"operation {operation.cut.name} runs no closed path")


def _sweep(move: ArcFeed, start: complex, end: complex) -> float:
    centre = complex(*move.centre)
    turn = cmath.phase((end - centre) / (start - centre))
    if move.ccw:
        return turn % (2.0 * math.pi)
    return -(-turn % (2.0 * math.pi))
