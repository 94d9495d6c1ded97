"""Winding number of a contour about a point, exactly: the turns of its chords and arcs."""

from __future__ import annotations

import numpy as np

from camgeo.contour.contour import Contour


def winding_number(contour: Contour, point: complex) -> int:
    """How often the contour goes round `point`, counter-clockwise positive.

    The point must not lie on the contour.
    """
    half = contour.split(0.5 * np.pi)  # a quarter arc never turns half round any point off it
    start, end = half.vertices - point, half.ends - point
    middle = np.where(
        half.sweeps != 0.0,
        half.centres + (half.vertices - half.centres) * np.exp(0.5j * half.sweeps) - point,
        0.5 * (start + end),
    )
    turned = np.angle(middle * np.conj(start)) + np.angle(end * np.conj(middle))
    return round(float(np.sum(turned)) / (2.0 * np.pi))
