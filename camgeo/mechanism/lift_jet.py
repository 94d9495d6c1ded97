"""The lift of a roller on a curve, with its derivatives, where its path meets the curve."""

from __future__ import annotations

import numpy as np

from camgeo.errors import GeometryError
from camgeo.mechanism.follower_path import Bows, FollowerPath
from camgeo.numeric.arrays import FloatArray, dot


def lift_jet(
    path: FollowerPath,
    phi: FloatArray,
    q: FloatArray,
    bows: Bows,
    slopes: FloatArray | float = 0.0,
) -> FloatArray:
    """(4, n) lift and three derivatives [mm or rad per rad^k] where the path meets `bows` at q.

    For the bows of curvature of another curve, `slopes` (n,) are the changes of its curvature along
    it [1/mm^2], with the normal on the right.

    By implicit differentiation of F(phi, q) = 0: q' = -F_phi / F_q, and twice more. Along the path
    d^3Z/dq^3 follows from the second derivative by the same factor as that from the first.

    Raises
    ------
    GeometryError
        Where the path is tangent to the bow: the lift has no velocity there.
    """
    point = path.point(phi, q)
    along, bend = path.along(phi, q)
    normal = bows.normal_at(point)
    turn = -1j * path.rotation
    steep = dot(normal, along)
    if np.any(steep == 0.0):
        raise GeometryError("the contour runs along the path of the follower: its lift jumps there")
    first = -dot(normal, turn * point) / steep
    speed = turn * point + along * first
    rest = -point + 2.0 * turn * along * first + bend * first * first
    second = -(bows.curvatures * dot(speed, speed) + dot(normal, rest)) / steep
    pace = rest + along * second
    jolt = -turn * point - 3.0 * along * first
    jolt += 3.0 * turn * (bend * first * first + along * second)
    jolt += first * bend * (bend / along * first * first + 3.0 * second)
    twist = slopes * dot(1j * normal, speed) ** 3
    third = -(3.0 * bows.curvatures * dot(speed, pace) + twist + dot(normal, jolt)) / steep
    return path.outward * np.stack((q - path.start, first, second, third))
