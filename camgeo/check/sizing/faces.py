"""The smallest base circle for a flat face: by exchange, from below, as for the transmission angle.

The place with the smallest base circle that meets some conditions is found, those that it breaks
most are added, and so on until none is broken, see `camgeo.check.sizing.exchange`. On a rocker that
place is the smallest chi_0 that the arcs of all conditions have in common. So the answer is exact.
"""

from __future__ import annotations

import math

import numpy as np

from camgeo.check.face import check_convexity
from camgeo.check.sizing.exchange import CLOSE, MOST, SIDES
from camgeo.check.sizing.face_task import CONVEX, OVER_AXIS, Asked, FaceTask, Rows
from camgeo.check.sizing.smallest import Active, Rating, Sizing, require_angle
from camgeo.check.transmission_angle import transmission_angle_extremes
from camgeo.errors import GeometryError
from camgeo.motion.extremes import lift_range
from camgeo.numeric.extremes import Extreme
from camgeo.outline.convex import contact_extremes, convexity, smallest_radius, smallest_turn
from camgeo.units import TURN

JUMP = "contact-jump"
"""Name of the finding that the velocity jumps."""

ACTIVE = 1e-9
"""A condition this close to its limit, as a fraction of the size of its terms, is active."""

BESIDE = 1e-5
"""Fraction by which a cam is enlarged to prove that no extreme was missed."""


def size_for_face(task: FaceTask, angle: float, radius: float) -> Sizing:
    """The smallest base circle for a flat face.

    Parameters
    ----------
    angle : smallest transmission angle mu [rad], in (0, pi/2).
    radius : smallest radius of curvature of the outline [mm], 0 for any convex one.

    Raises
    ------
    GeometryError
        If one of them is out of range, or the follower does not move.
    """
    require_angle(angle)
    if not 0.0 <= radius < math.inf:
        key = "radius_of_curvature"
        raise GeometryError("must be a length, 0 or more", key=key, value=f"{radius:g}")
    low, high = lift_range(task.motion)
    if low == high:
        raise GeometryError("there is nothing to size: the follower does not move", key="motion")
    asked = task.asked(angle, radius)
    hopeless = _hopeless(task)
    place, active = (None, ()) if hopeless else smallest_for_face(task, asked)
    answer = None if place is None else rate_face(task, place)
    none_below = math.inf if answer is None else answer.base_radius
    return Sizing(
        angle,
        ratio=1.0,
        answer=answer,
        active=active,
        none_below=none_below,
        radius=radius,
        hopeless=hopeless,
    )


def _hopeless(task: FaceTask) -> str | None:
    """Why no size will do (the linkage, a face that turns back, a velocity jump), or None."""
    if task.hopeless is not None:
        return task.hopeless
    curve = task.pitch_curve_at(task.present)
    findings = check_convexity(curve)
    if smallest_turn(curve)[0] <= 0.0:
        return findings[0].sentence
    return next((each.sentence for each in findings if each.name == JUMP), None)


def rate_face(task: FaceTask, place: complex) -> Rating | None:
    """What the cam axis at `place` results in; None if there is no such mechanism, or its face
    turns back in the cam.
    """
    try:
        curve = task.pitch_curve_at(place)
        if smallest_turn(curve)[0] <= 0.0:
            return None
        angle = transmission_angle_extremes(curve).smallest()
        contact = contact_extremes(curve)
    except GeometryError:
        return None
    bend = smallest_radius(curve)
    ends = Extreme(*contact.smallest()), Extreme(*contact.largest())
    none = Extreme(0.0, 0.0)
    return Rating(place, curve.follower, Extreme(*angle), none, Extreme(*bend), ends)


def smallest_for_face(task: FaceTask, asked: Asked) -> tuple[complex | None, tuple[Active, ...]]:
    """The place with the smallest base circle for which `asked` holds, and what decides it.

    None if there is none. tau must be positive over the turn, and the velocity without jumps.
    """
    known: Rows = task.rows(OVER_AXIS, np.zeros(1), "right", asked)
    place = task.lowest(known)
    for _ in range(MOST):
        if place is None:
            return None, ()
        curve = task.pitch_curve_at(place)
        broken, active = False, []
        for name in task.names:
            found = task.slack(curve, name, asked)
            size = CLOSE * (abs(place) + task.base_radius_at(place))
            worst = found.values < -size
            active += [
                Active(name, float(phi) % TURN)
                for phi in found.phi[np.abs(found.values) <= ACTIVE * size / CLOSE]
            ]
            if np.any(worst):
                broken = True
                for side in SIDES:
                    known = _joined(known, task.rows(name, found.phi[worst], side, asked))
        if not broken:
            missed = _missed(task, place)
            if missed is None:
                return place, tuple(active)
            known = _joined(known, task.rows(CONVEX, np.array([missed]), "right", asked))
        before, place = place, task.lowest(known)
        if place == before:
            return place, tuple(active)
    return None, ()


def _missed(task: FaceTask, place: complex) -> float | None:
    """Cam angle [rad] of a cusp or undercut that `slack` misses; None without one, as is usual.

    Of a cam that is larger by `BESIDE`: close to a cusp the proof takes ever smaller cells.
    """
    try:
        cam = task.cam.sized(base_radius=(1.0 + BESIDE) * task.base_radius_at(place))
    except GeometryError:  # the face stands square to the line of centres
        return None
    found = convexity(cam.disc.pitch_curve)
    return None if found.is_convex else found.radius[1]


def _joined(one: Rows, other: Rows) -> Rows:
    a, b, c = (np.concatenate(each) for each in zip(one, other, strict=True))
    return a, b, c
