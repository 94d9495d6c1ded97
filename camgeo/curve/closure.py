"""Closure: how a curve joins at its breaks and after a full turn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.curve.pitch_curve import PitchCurve
from camgeo.motion.kept import kept_with_owner
from camgeo.numeric.arrays import FloatArray, ascending, frozen


@dataclass(frozen=True, slots=True, eq=False)
class Joints:
    """What jumps at the joints of the turn, including cam angle 0.

    Attributes
    ----------
    phi : (m,) cam angles [rad].
    gaps : (m,) distance between the curve's two ends [mm].
    turns : (m,) angle between their two tangents [rad], in [0, pi].
    """

    phi: FloatArray
    gaps: FloatArray
    turns: FloatArray


@kept_with_owner
def joints(curve: PitchCurve) -> Joints:
    """Compare the one-sided values at each break of `curve` and at cam angle 0."""
    phi = ascending(np.append(curve.breaks, 0.0))
    after, before = curve.jet(phi, "right"), curve.jet(phi, "left")
    turned = after[1] * np.conj(before[1])
    return Joints(
        phi=frozen(phi, np.float64),
        gaps=frozen(np.abs(after[0] - before[0]), np.float64),
        turns=frozen(np.abs(np.angle(turned)), np.float64),
    )
