"""How far discs are from undercut."""

from __future__ import annotations

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.check.cures.discs import Discs
from camgeo.check.follower import check_follower
from camgeo.check.standstill import check_standstill
from camgeo.curve.extremes import Extremes, curvature_extremes
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError
from camgeo.motion.piece import SNAP
from camgeo.numeric.arrays import FloatArray
from camgeo.outline.cusps import CUSP
from camgeo.units import TURN

Flanks = tuple[WorkingCurve, ...]

Pair = tuple[int, float, float]
"""A crossing of a flank in use: the number of its disc, and its two cam angles [rad] in
[0, 2 pi)."""

Pairs = tuple[Pair, ...]


def flanks_of(cam: Cam) -> Flanks:
    """The working curves in use."""
    return tuple(curve for _, curve in cam.disc.flanks)


def margin(discs: Discs) -> float | None:
    """Smallest 1 + d kappa over the flanks in use; positive if there is no cusp and no
    local undercut.

    None if there is no such mechanism: it does not close, its roller covers the cam axis, its guide
    touches the base circle, or its roller centre stands still at an angle examined.
    """
    least = []
    for cam in discs:
        bends = bends_of(cam)
        if bends is None:
            return None
        least.append(float(np.min(margins(cam, bends))))
    return min(least)


def bends_of(cam: Cam) -> Extremes | None:
    """The extremes of the pitch curve's curvature; None as for `margin`."""
    inside = cam.contact.runs_inside
    if check_follower(cam.follower, runs_on_inner=inside, clearance=cam.clearance):
        return None
    try:
        return curvature_extremes(cam.disc.pitch_curve)
    except GeometryError:
        return None


def margins(cam: Cam, bends: Extremes) -> FloatArray:
    """The smallest 1 + d kappa (k,) of the flanks in use at each of `bends`."""
    every = [1.0 + distance * bends.values for distance in cam.distances]
    return np.asarray(np.min(every, axis=0))


def margins_within(discs: Discs, ranges: FloatArray) -> FloatArray | None:
    """(k,) smallest 1 + d kappa in each of the `ranges` (k, 2) of cam angle [rad], from inside.

    Both ends of each are breaks, or the ends of a dwell. None as for `margin`.
    """
    least = np.full(len(ranges), np.inf)
    for cam in discs:
        bends = bends_of(cam)
        if bends is None:
            return None
        shift = np.where(ranges[:, :1] < bends.phi[0] - SNAP, TURN, 0.0)
        start, end = (ranges + shift + SNAP * np.array([1.0, -1.0])).T
        first = np.maximum(np.searchsorted(bends.phi, start, side="right") - 1, 0)
        last = np.minimum(np.searchsorted(bends.phi, end) + 1, len(bends.phi))
        values = np.append(margins(cam, bends), np.inf)
        own = np.minimum.reduceat(values, np.column_stack((first, last)).ravel())[::2]
        least = np.minimum(least, own)
    return least


def crossings_of(discs: Discs) -> Pairs | None:
    """The crossings of the flanks in use; intact discs have none, ().

    None if there is worse: no mechanism, a cusp, local undercut, a standstill, a roller that
    reaches over the cam axis, or undecidable crossings.
    """
    try:
        return crossings(discs) if _is_regular(discs) else None
    except GeometryError:
        return None


def is_intact(discs: Discs) -> bool:
    """Whether the discs certainly exist without cusp, undercut, crossing or standstill: whether
    `crossings_of` them is (), without those beyond the first.
    """
    from camgeo.outline.crossings import crosses_itself  # only regular flanks need it

    try:
        return _is_regular(discs) and not any(
            crosses_itself(flank) for cam in discs for flank in flanks_of(cam)
        )
    except GeometryError:
        return False


def _is_regular(discs: Discs) -> bool:
    """Whether there is nothing worse than crossings, if they can be decided.

    GeometryError if a roller reaches over the cam axis.
    """
    from camgeo.outline.outline import require_room  # only regular flanks need it

    least = margin(discs)
    if least is None or least <= CUSP:
        return False
    if any(check_standstill(cam.disc.pitch_curve) for cam in discs):
        return False
    for cam in discs:
        for flank in flanks_of(cam):
            require_room(flank)
    return True


def crossings(discs: Discs) -> Pairs:
    """The crossings of each flank with itself, see `camgeo.outline.crossings`."""
    from camgeo.outline.crossings import find_crossings  # only regular flanks need it

    return tuple(
        (number, each.first, each.second)
        for number, cam in enumerate(discs)
        for flank in flanks_of(cam)
        for each in find_crossings(flank)
    )
