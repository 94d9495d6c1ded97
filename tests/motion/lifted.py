"""The lift of a plan as bytes: what another process computes, which imports no test."""

from __future__ import annotations

from typing import Final

import numpy as np

from camgeo.kinematics.plan import MotionPlan
from camgeo.units import TURN

PHI: Final = np.concatenate((np.linspace(-0.1, TURN + 0.1, 501), [0.0, TURN]))


def lift_of(plan: MotionPlan) -> bytes:
    """Lift and derivatives at `PHI`, bit by bit."""
    return plan.jet(PHI).tobytes()
