"""Moves from rest to rest by a motion law, as the shock spectrum takes them."""

from __future__ import annotations

import numpy as np

from camgeo.dynamics.oscillator.steady import Shock, shock
from camgeo.kinematics.laws.law import Law
from camgeo.numeric.arrays import FloatArray


def shock_of(law: Law) -> Shock:
    """The move by `law`; velocities at its ends are shocks."""
    edges = np.array([0.0, *law.borders, 1.0])
    jumps = np.zeros(len(edges))
    jumps[0], jumps[-1] = law.start.velocity, -law.end.velocity
    return shock(lambda z: law(z)[0], lambda z: law(z)[2], edges, jumps)


def shock_spectrum(law: Law, ratios: FloatArray, damping: float = 0.0) -> FloatArray:
    """(n,) what remains after a move by `law`, as a share of the stroke."""
    return shock_of(law).residual(ratios, damping)
