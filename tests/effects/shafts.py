"""A cam whose shaft turns unevenly: a scene, and its motion by `solve_ivp` from Newton's law."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np
from scipy.integrate import solve_ivp

from camgeo.dynamics.effects.effect import Result
from camgeo.numeric.arrays import FloatArray
from camgeo.studies.accuracy.survey import compared
from camgeo.units import TURN

MASS, PRELOAD, SPRING, SPEED = 1.5, 250.0, 8.0, 500.0

SCENE: Final = f"""
camgeo = 1
name = "shaft"
[cam]
rotation = "ccw"
speed = {SPEED}
[follower]
kind = "translating-roller"
base_radius = 40
roller_radius = 10
[[motion]]
law = "polynomial-345"
span = 90
to = 20
[[motion]]
law = "polynomial-345"
span = 90
to = 0
[[motion]]
dwell = 180
[part]
thickness = 12
[effects.inertia]
mass = {MASS}
[effects.spring]
stiffness = {SPRING}
preload = {PRELOAD}
[effects.contact-force]
[effects.drive-torque]
[effects.kinematics]
"""

PHI: Final = np.linspace(0.003, TURN - 0.003, 400)

Lift = tuple[float, float, float]


def lift(phi: float) -> Lift:
    """s [mm] and its derivatives of the polynomial 10 x^3 - 15 x^4 + 6 x^5 up and down."""
    span = 0.5 * math.pi
    if phi >= 2.0 * span:
        return 0.0, 0.0, 0.0
    sign, x = (1.0, phi / span) if phi < span else (-1.0, 2.0 - phi / span)
    s = 20.0 * x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    s1 = 600.0 * x**2 * (1.0 - x) ** 2 / span * sign
    return s, s1, 1200.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / span**2


Rates = Callable[[Lift, list[float]], Sequence[float]]
"""Of states over the cam angle, by the lift there."""


def newton(
    moment: float,
    drive: Callable[[list[float]], float],
    train: tuple[float, float] | None = None,
    others: Callable[[list[float]], list[float]] = lambda _: [],
) -> Rates:
    """Of the speed omega, x and v of a train, and `others` over the cam angle, in N, mm, s and t.

    J alpha = T - s' (m (s'' omega^2 + s' alpha) + P + k s) with the torque T of the `drive`. Before
    a train of the natural frequency w and the damping D the follower has no mass but that of it:
    J alpha = T - s' (F + P + k s) and m v' = F = m (w^2 (s - x) + 2 D w (s' omega - v)).
    """
    mass = 1e-3 * MASS

    def rates(place: Lift, state: list[float]) -> list[float]:
        (s, s1, s2), omega = place, state[0]
        left, behind = drive(state) - s1 * (PRELOAD + SPRING * s), []
        if train is None:
            alpha = (left - s1 * mass * s2 * omega**2) / (1e3 * moment + mass * s1**2)
        else:
            w, (x, v) = TURN * train[0], state[1:3]
            force = mass * (w * w * (s - x) + 2.0 * train[1] * w * (s1 * omega - v))
            alpha, behind = (left - s1 * force) / (1e3 * moment), [v / omega, force / mass / omega]
        return [alpha / omega, *behind, *others(state)]

    return rates


def over_turn(rates: Rates, state: FloatArray, **exact: float) -> list[Any]:
    """From a state on, piece by piece of the motion."""
    pieces: list[Any] = []
    for span in itertools.pairwise((0.0, 0.5 * math.pi, math.pi, TURN)):
        pieces.append(
            solve_ivp(
                lambda phi, y: rates(lift(min(phi, TURN)), y.tolist()),
                span, pieces[-1].y[:, -1] if pieces else state, "DOP853", dense_output=True,
                max_step=0.04, **exact,  # for the interpolant
            )
        )  # fmt: skip
    return pieces


def settled(rates: Rates, start: Sequence[float], repeated: int, **exact: float) -> list[Any]:
    """A turn once disturbances have died out; of the states so many come back, others are sums."""
    state, sums = np.array(start), np.array(start)[repeated:]
    for _ in range(80):
        pieces = over_turn(rates, state, **exact)
        before, state = state, np.append(pieces[-1].y[:repeated, -1], sums)
        sizes = np.max(np.abs(np.hstack([each.y for each in pieces])), axis=1)
        if np.all(np.abs(state - before) <= 1e-11 * sizes):
            break
    return pieces


def states_at(pieces: list[Any], phi: FloatArray = PHI) -> FloatArray:
    """(k, n) of a turn at cam angles [rad]."""
    return np.transpose([next(p for p in pieces if p.t[-1] >= each).sol(each) for each in phi])


def assert_true(own: Result, best: Result, what: object) -> None:
    """No figure is off by more than stated."""
    for each in compared(own, best):
        assert each.holds, (what, each)
