"""Winding number of a contour about a point, exactly: the turns of its chords, and its segments."""

from __future__ import annotations

import numpy as np

from camgeo.contour.contour import Contour


def winding_number(contour: Contour, point: complex) -> int:
    """How often the contour goes round `point`, counter-clockwise positive.

    The point must not lie on the contour.
    """
    pieces = contour.split(0.5 * np.pi)
    start, end = pieces.vertices - point, pieces.ends - point
    # A point between an arc and its chord sees the arc go round by the other way than the chord.
    inside = np.abs(point - pieces.centres) < pieces.radii
    beyond = (np.conj(end - start) * -start).imag * pieces.sweeps < 0.0
    between = np.where(inside & beyond, np.sign(pieces.sweeps), 0.0)
    chords = float(np.sum(np.angle(end * np.conj(start)))) / (2.0 * np.pi)
    return round(chords + float(np.sum(between)))
