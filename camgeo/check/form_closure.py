"""Checks of what holds a follower both ways: the two discs of a conjugate pair, or a yoke.

A normal force N of a disc on its roller does the work N dn on the follower, n positive outward and
dn/dq the leverage (`camgeo.curve.pitch_curve.PitchCurve.leverage`). Discs can only push. So a pair
holds the follower both ways where the two leverages have opposite signs, and an error t of a flank
along its normal moves the follower by t / |dn/dq|.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from camgeo.cam.breadth import Breadth
from camgeo.check.finding import Finding, held
from camgeo.curve.extremes import extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.wording import at_cam_angles

VANISHING: Final = 1e-12
"""A product of sines of transmission angles up to this is 0: rounding of the rollers' positions."""


def check_pair(
    main: PitchCurve, other: PitchCurve, tolerance: float, limit: float
) -> tuple[Finding, ...]:
    """Form closure of a pair of discs, and the error with which the pair closes.

    Parameters
    ----------
    main, other : pitch curves of the main disc and of the return disc, from one motion.
    tolerance : largest error of either flank along its normal [mm].
    limit : largest closing error allowed, as travel of the main roller [mm].

    Without form closure there is no closing error. Raises GeometryError where Z' of one of the
    curves vanishes.
    """
    closed = _check_form_closure(main, other)
    if closed.severity != "ok":
        return (closed,)
    return (closed, _check_closing_error(main, other, tolerance, limit))


def leverage_slope(curve: PitchCurve, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) d/dphi of `PitchCurve.leverage`, by the chain rule [1 or mm/rad, per rad].

    With dn/dq = reach u / |Z'| and |Z'|^2 = u^2 + w^2 it is reach w (w u' - u w') / |Z'|^3.
    """
    tangent = curve.follower.tangent_jet(curve.motion.jet(phi, side), curve.rotation)
    (u, u1), (w, w1) = tangent.u, tangent.w
    speed = np.hypot(u, w)
    return np.asarray(curve.follower.reach * (w / speed) * ((w * u1 - u * w1) / (speed * speed)))


def _check_form_closure(main: PitchCurve, other: PitchCurve) -> Finding:
    """Whether the product of the leverages, as sines of the transmission angles, is below 0."""
    scale = 1.0 / abs(main.follower.reach * other.follower.reach)

    def product(phi: FloatArray, side: Side) -> FloatArray:
        return scale * main.leverage(phi, side) * other.leverage(phi, side)

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        first, second = main.leverage(phi, side), other.leverage(phi, side)
        one = leverage_slope(main, phi, side) * second
        return np.asarray(one + first * leverage_slope(other, phi, side))

    value, phi = extremes(main, product, slope).largest()
    place = at_cam_angles(phi, form=".4f")
    bound = (
        f"product of the leverages as sines of the transmission angles {value + 0.0:.4f} {place}"
    )
    if value >= -VANISHING:
        sentence = (
            f"the two discs do not hold the follower between them: {bound}, where they do not push"
            " it in opposite senses"
        )
        return Finding("form-closure", "broken", sentence, value + 0.0, 0.0, cam_angle=phi)
    sentence = (
        f"the two discs push the follower in opposite senses over the whole turn; largest {bound}"
    )
    return Finding("form-closure", "ok", sentence, value, 0.0, cam_angle=phi)


def _check_closing_error(
    main: PitchCurve, other: PitchCurve, tolerance: float, limit: float
) -> Finding:
    """Compare the play or squeeze of two discs true to `tolerance` with `limit`."""
    scale = tolerance * abs(main.follower.reach)

    def play(phi: FloatArray, side: Side) -> FloatArray:
        either = (1.0 / np.abs(curve.leverage(phi, side)) for curve in (main, other))
        return scale * sum(either, start=np.zeros(len(phi)))

    def slope(phi: FloatArray, side: Side) -> FloatArray:
        total = np.zeros(len(phi))
        for curve in (main, other):
            lever = curve.leverage(phi, side)
            total -= leverage_slope(curve, phi, side) / (lever * np.abs(lever))
        return total

    value, phi = extremes(main, play, slope).largest()
    statement = (
        f"with both discs true to {tolerance:g} mm the rollers have at most {value:.6f} mm of"
        f" play or squeeze, as travel of the main roller, {at_cam_angles(phi, form='.4f')}"
    )
    return held("closing-error", statement, value, limit, "mm", phi)


def check_breadth(cam: Breadth, breadth: float, limit: float) -> Finding:
    """Compare how far the width of `cam` is from the `breadth` [mm] of a yoke with `limit` [mm].

    Where the cam is wider the yoke is squeezed, where it is narrower the yoke has play.
    """
    (least, narrow), (most, wide) = cam.range
    error, phi = max((most - breadth, wide), (breadth - least, narrow))
    statement = (
        f"yoke of breadth {breadth:.6g} mm: the cam is {least:.6g} to {most:.6g} mm wide, off"
        f" by up to {error + 0.0:.3g} mm {at_cam_angles(phi, form='.4f')}"
    )
    return held("closing-error", statement, error, limit, "mm", phi)
