"""Solution for the steady state, and its obstacles: shocks, a stall, a follower that jams."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import Final

import numpy as np

from camgeo.effects.bearing_friction import linear_law
from camgeo.effects.effect import Quantity
from camgeo.effects.shaft.mesh import Mesh, collocation, double_mesh
from camgeo.effects.shaft.obstacles import jamming
from camgeo.effects.shaft.rate import Shaft, StuckError
from camgeo.effects.speed_fluctuation.march import outcome
from camgeo.effects.speed_fluctuation.steady import NoConvergenceError, SteadyTurn, steady_turn
from camgeo.effects.speed_fluctuation.table import Motor
from camgeo.effects.wording import N_M, missed
from camgeo.errors import EffectError
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.roots import bracketed_roots
from camgeo.units import TURN
from camgeo.wording import cam_angle

LONGEST: Final = TURN / 24.0
"""Largest length of an initial cell [rad]."""

GUESSES: Final = 65
"""Number of constant speeds, up to twice the no-load speed, at which the power balance is
tested.
"""


def solve(
    shaft: Shaft[Motor],
    law: Quantity,
    edges: FloatArray,
    tolerance: float,
    near: SteadyTurn | None = None,
) -> SteadyTurn:
    """The steady state, starting from one that is `near`; without it, or if that fails, from the
    power balance, and if that fails from single turns.

    Raises
    ------
    EffectError
        "stall", if there is none; "jamming", if no acceleration satisfies the equation of motion
        with friction; and if the tolerance cannot be reached.
    """
    mesh = double_mesh(law, edges, LONGEST)
    try:
        if near is not None:
            y = near.y(mesh.coarse.nodes.ravel()).reshape(mesh.coarse.nodes.shape)
            with suppress(NoConvergenceError):
                return steady_turn(shaft, law, mesh, y, tolerance)
        guess = _balanced(shaft, mesh.coarse)
        if guess is not None:
            try:
                return steady_turn(shaft, law, mesh, guess, tolerance)
            except NoConvergenceError as error:
                if error.reached is not None:
                    raise
        found = outcome(shaft, law, edges)
        if found.y is None:
            raise _stall(shaft, found.stall)
        y = np.interp(mesh.coarse.nodes, found.angles, found.y)
        return steady_turn(shaft, law, mesh, np.maximum(y, 1e-6 * np.max(y)), tolerance)
    except StuckError as error:
        raise jamming(shaft.inertia, mesh.fine) from error
    except NoConvergenceError as error:
        raise _missed(error.reached, tolerance) from error


def _balanced(shaft: Shaft[Motor], mesh: Mesh) -> float | None:
    """y [rad^2/s^2] of the largest constant speed with balanced power; None if there is none."""
    weights = mesh.spans[:, np.newaxis] * collocation().weights / TURN

    def surplus(omega: FloatArray) -> FloatArray:
        drive = shaft.motor.torque(omega)[0]
        taken = np.empty(len(omega))
        for k, each in enumerate(omega):
            c0, c1, c2, _, ahead, behind = linear_law(mesh.laws, each, 0.0)
            force = c0 + each * (c1 + each * c2)
            torque = np.where(force == 0.0, 0.0, force * np.where(force > 0.0, ahead, behind))
            taken[k] = np.sum(weights * torque)
        return drive - taken

    top = shaft.motor.no_load_speed
    speeds = np.linspace(0.0, 2.0 * top, GUESSES)[1:]
    values = surplus(speeds)
    if np.any(np.isnan(values)):
        raise StuckError
    falls = np.flatnonzero((values[:-1] >= 0.0) & (values[1:] < 0.0))
    if len(falls):
        k = int(falls[-1])
        found = float(bracketed_roots(surplus, speeds[k : k + 1], speeds[k + 1 : k + 2])[0])
        return 0.5 * found * found
    return 0.5 * top * top if values[-1] >= 0.0 else None


def _stall(shaft: Shaft[Motor], phi: float) -> EffectError:
    torque = N_M * float(shaft.motor.torque(np.zeros(1))[0][0])
    place = phi % TURN
    return EffectError(
        f"the motor stalls near cam angle {cam_angle(place, '.1f')} deg: whatever its initial"
        f" speed, its stall torque of {torque:.5g} N m cannot carry the cam through the turn, and"
        " there is no steady state",
        finding="stall",
        value=torque,
        unit="N m",
        cam_angle=place,
    )


def _missed(reached: float | None, tolerance: float) -> EffectError:
    if reached is None or not math.isfinite(reached):
        return EffectError(
            "no steady state of the cam's speed was found, though the motor does not stall"
        )
    return missed("the speed of the cam", reached, "the largest speed", tolerance)
