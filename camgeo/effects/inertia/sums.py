"""Sums over all coordinates in which masses move: reduced inertia and inertia force."""

from __future__ import annotations

import numpy as np

from camgeo.effects.inertia.rates import Train
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray


def reduced(train: Train, phi: FloatArray, side: Side) -> FloatArray:
    """M (n,), see `Inertia.to_follower`."""
    out = np.zeros(len(phi))
    for each in train(phi, side):
        out += each.inertia * each.per_lift * each.per_lift
    return out


def inertia_force(train: Train, phi: FloatArray, side: Side) -> FloatArray:
    """(4, n) coefficients of the sum of -m (d^2 x/dt^2) dx/dq at n cam angles.

    d^2 x/dt^2 = x'' omega^2 + x' alpha (VDI 2143-1, eq. 2). By Lagrange's equation it is
    -(M d^2 q/dt^2 + dM/dq (dq/dt)^2 / 2), of the reduced inertia M(q).
    """
    out = np.zeros((4, len(phi)))
    for each in train(phi, side):
        of_lift = -each.inertia * each.per_lift
        out[2] += of_lift * each.second
        out[3] += of_lift * each.first
    return out
