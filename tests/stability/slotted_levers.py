"""Cases of the slotted lever: nearly equal lengths, the pin on the lever's axis, many turns."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np
from mpmath import mp

from camgeo.kinematics.mechanism.slotted_lever import SlottedLever
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.extremes import Extreme
from camgeo.units import TURN
from tests.stability.measure import Case
from tests.stability.series import Number, Series, direction, logarithm, newton, variable

GROUP: Final = "slotted-levers"


THETAS: Final = (1e-8, 0.3, 1.4, 3.1, 5.0, 6.283, 20.0, -4.0)
"""Crank angles [rad]: next to where the pin is nearest, in the first turn, and in others. The
others are not used for a = R: there half an ulp of a length decides whether half a turn, a whole
one or none is lost."""

LEVERS: Final = {
    "beta 2.4": (25.0, 60.0),
    "HC03 turning lever": (10.0, 5.0),
    "HC01 a = R": (75.0, 75.0),
    "HC02 beta 1 + 1e-9": (1e9, 1e9 + 1.0),
    "beta 1 - 1e-9": (1e9, 1e9 - 1.0),
    "beta 1 + 1 ulp": (1.0, 1.0 + 2.0**-52),
    "HC04 beta 1e8": (1e-6, 100.0),
    "beta 1e-8": (1e6, 1e-2),
}
"""Crank and distance between the axes [mm]."""

GUESS: Final = 7
"""Digits of a crank angle from which an exact root is sought: an extreme lies as near to 0 as the
lengths are to each other."""

ENOUGH: Final = 46
"""A step that vanishes to this many decimals is the last one; its error is its square over the
angle itself, which is at least 1e-16."""


def cases() -> tuple[Case, ...]:
    """All cases of this module."""
    return tuple(case for name in LEVERS for case in _of_lever(name))


def _of_lever(name: str) -> Iterator[Case]:
    lever = SlottedLever(*LEVERS[name])
    lengths = (lever.crank, lever.distance)

    def found(theta: FloatArray) -> tuple[FloatArray, ...]:
        return lever.angle(theta), lever.velocity(theta), lever.acceleration(theta)

    def exact(theta: Number, crank: Number, distance: Number) -> tuple[Number, ...]:
        phi = exact_angle(theta, crank, distance, 3)
        return tuple(phi.derivative(order) for order in range(3))

    def velocities(theta: FloatArray) -> tuple[FloatArray, ...]:
        ends = lever.velocity_extremes
        near = {each.place: each.value for each in (ends.lowest, ends.highest)}
        return (np.array([near[place] for place in theta]),)

    def exact_velocity(theta: Number, crank: Number, distance: Number) -> tuple[Number, ...]:
        at = mp.pi * (theta > 1)
        return (exact_angle(at, crank, distance, 2).terms[1],)

    equal = lever.distance == lever.crank
    thetas = tuple(theta for theta in THETAS if 0.0 < theta < TURN or not equal)
    yield Case(
        GROUP,
        name,
        ("lever angle", "lever velocity", "lever acceleration"),
        thetas,
        lengths,
        found,
        exact,
    )
    if not equal:
        yield Case(
            GROUP,
            name,
            ("extreme lever velocity",),
            (0.0, math.pi),
            lengths,
            velocities,
            exact_velocity,
        )
        yield _extreme(
            name,
            lever,
            ("largest lever acceleration", "place of largest lever acceleration"),
            2,
            lever.largest_acceleration,
        )
    if lever.swings:
        yield _extreme(
            name,
            lever,
            ("largest lever angle", "place of largest lever angle"),
            0,
            lever.largest_angle,
        )


def _extreme(
    name: str, lever: SlottedLever, quantities: tuple[str, ...], order: int, engine: Extreme
) -> Case:
    """The extreme of a derivative of phi, where the next one is 0."""

    def found(guesses: FloatArray) -> tuple[FloatArray, ...]:
        return np.full(len(guesses), engine.value), np.full(len(guesses), engine.place)

    def exact(guess: Number, crank: Number, distance: Number) -> tuple[Number, ...]:
        def slope(theta: Number) -> tuple[Number, Number]:
            phi = exact_angle(theta, crank, distance, order + 3)
            return phi.derivative(order + 1), phi.derivative(order + 2)

        theta = newton(slope, guess, ENOUGH)
        return exact_angle(theta, crank, distance, order + 1).derivative(order), theta

    guess = float(f"{engine.place:.{GUESS}g}")
    return Case(GROUP, name, quantities, (guess,), (lever.crank, lever.distance), found, exact)


def exact_angle(theta: Number, crank: Number, distance: Number, terms: int) -> Series:
    """phi [rad] by the complex vector from the lever's axis to the pin, over any number of turns.

    phi = Im log(a - R exp(-i theta)) in the crank's first turn; with every further turn the lever
    loses what it lost over the first: a turn if a < R, half a turn if a = R.
    """
    slot = distance - crank * direction(variable(-theta, -1, terms))
    phi: Series = logarithm(slot).imag
    lost = mp.pi * (1 + mp.sign(crank - distance))
    angle: Series = phi - lost * mp.floor(theta / (2 * mp.pi))
    return angle
