"""A contour from what files state: end points and the angle turned between them."""

from __future__ import annotations

import numpy as np

from camgeo.contour.contour import Contour, is_straight
from camgeo.numeric.arrays import ComplexArray, FloatArray


def chain(vertices: ComplexArray, sweeps: FloatArray) -> Contour:
    """Closed contour through `vertices` (n,) [mm] whose pieces turn by `sweeps` (n,) [rad].

    The centres follow from both, so that each arc passes through its end points; one that is
    straight except for rounding is a line.
    """
    ends = np.roll(vertices, -1)
    chord = ends - vertices
    straight = is_straight(vertices, ends, sweeps)
    half = np.tan(0.5 * np.where(straight, 1.0, sweeps))
    centres = np.where(straight, 0.0, vertices + 0.5 * chord * (1.0 + 1j / half))
    return Contour(vertices, np.where(straight, 0.0, sweeps), centres)
