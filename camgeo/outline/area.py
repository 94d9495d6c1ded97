"""Area inside a path, by Green's theorem on its exact curves."""

from __future__ import annotations

import cmath
import math

import numpy as np

from camgeo.numeric.quadrature import gauss
from camgeo.outline.path import Path, Pivot, Stretch

LONGEST = math.pi / 16.0
"""Longest part of a stretch [rad] that one quadrature takes."""

NODES = 12
"""Of a Gauss-Legendre quadrature; a part of the longest kind has its digits with eight."""


def area(path: Path) -> float:
    """Signed area [mm^2], positive if the path runs counter-clockwise."""
    return math.fsum(
        _of_pivot(each) if isinstance(each, Pivot) else _of_stretch(each) for each in path.elements
    )


def _of_stretch(stretch: Stretch) -> float:
    """Half the integral of Im(conj(W) W') over the stretch."""
    curve = stretch.curve
    marks = stretch.marks
    parts = np.maximum(1, np.ceil(np.diff(marks) / LONGEST)).astype(int)
    marks = np.concatenate(
        [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(marks, marks[1:], parts, strict=False)]
        + [marks[-1:]]
    )
    places, half, weights = gauss(marks[:-1], marks[1:], NODES)
    phi = places.ravel()
    across = (np.conj(curve.point(phi)) * curve.tangent(phi)).imag * curve.pace(phi)
    return 0.5 * math.fsum((half[:, None] * weights).ravel() * across)


def _of_pivot(pivot: Pivot) -> float:
    """A sector about the centre, and the triangles that join it to the axis."""
    if pivot.distance == 0.0:
        return 0.0
    sector = pivot.distance**2 * pivot.sweep
    arm = pivot.distance * pivot.normal * (cmath.exp(1j * pivot.sweep) - 1.0)
    return 0.5 * (sector + (pivot.centre.conjugate() * arm).imag)
