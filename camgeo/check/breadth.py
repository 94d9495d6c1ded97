"""Check of a constant-breadth cam: whether both sides of its yoke touch all through the turn."""

from __future__ import annotations

import math

from camgeo.cam.breadth import Breadth
from camgeo.check.finding import Finding, held


def check_breadth(cam: Breadth, breadth: float, limit: float) -> Finding:
    """Hold the difference of the width of `cam` from the `breadth` [mm] of a yoke to `limit` [mm].

    Where the cam is wider the yoke is squeezed, where it is narrower the yoke has play.
    """
    (least, narrow), (most, wide) = cam.range
    error, phi = max((most - breadth, wide), (breadth - least, narrow))
    told = (
        f"yoke of breadth {breadth:.6g} mm: the cam is {least:.6g} to {most:.6g} mm wide, off"
        f" by up to {error + 0.0:.3g} mm at cam angle {math.degrees(phi):.4f} deg"
    )
    return held("closing-error", told, error, limit, "mm", phi)
