"""The spring that holds a follower on its flank."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from camgeo.check.cures.cure import DIGITS, rounded_beyond
from camgeo.effects.effect import Subject
from camgeo.effects.lift_off.flank import Flank
from camgeo.effects.lift_off.sizing import least_of
from camgeo.effects.results import ContactForce, Spring
from camgeo.effects.wording import N_M
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.numeric.extremes import Extreme

VectorOf = Callable[[FloatArray, Side], ComplexArray]
"""(k, n) complex at n cam angles [rad]."""


def least_spring(
    flank: Flank, spring: Spring, leaps: Sequence[float] = ()
) -> tuple[Extreme, Extreme]:
    """Least preload and least stiffness, each with the other one unchanged, that keep contact; see
    `least_of`. At the cam angles `leaps` [rad], where the velocity jumps away, none does.
    """
    if leaps:
        never = Extreme(math.inf, leaps[0])
        return never, never
    edges, loads = flank.contact.edges, _pivot_loads(flank, spring)
    return (
        least_of(flank, spring.per_preload, spring.preload, edges, loads[0]),
        least_of(flank, spring.per_stiffness, spring.stiffness, edges, loads[1]),
    )


def holding(
    subject: Subject,
    contact: ContactForce,
    spring: Spring,
    least: tuple[Extreme, Extreme] | None = None,
) -> str:
    """Which preload or which stiffness would hold a contact that is lost, each rounded so that it
    does; empty if neither does. They are those of `least_spring`, without a margin, unless `least`
    are known.
    """
    if least is None:
        flank = Flank(subject, contact, subject.cam.contact.push, 0.0)
        least = least_spring(flank, spring, contact.lost_contact.leaps)
    preload, stiffness = least
    kinds = (
        ("preload", preload, spring.preload, spring.unit_of_preload),
        ("stiffness", stiffness, spring.stiffness, spring.unit_of_stiffness),
    )
    values = [
        f"a {what} of {rounded_beyond(scale_of(unit) * enough.value, DIGITS, upward=True)} {unit}"
        f" instead of {scale_of(unit) * now:.6g} {unit}"
        for what, enough, now, unit in kinds
        if math.isfinite(enough.value)
    ]
    return f"{' or '.join(values)} of its spring would hold it" if values else ""


def scale_of(unit: str) -> float:
    """From internal units to the `unit` in which a property of a spring is shown."""
    return N_M if unit.startswith("N m") and not unit.startswith("N mm") else 1.0


def _pivot_loads(flank: Flank, spring: Spring) -> tuple[VectorOf | None, VectorOf | None]:
    """Loads of a pivot with friction per unit of preload and of stiffness; None without any."""
    line, per_stroke = spring.line, spring.per_stroke
    if flank.contact.bearings is None or flank.subject.cam.follower.pivot is None:
        return None, None
    if line is None and not per_stroke:
        return None, None

    def per_preload(phi: FloatArray, side: Side) -> ComplexArray:
        if line is not None:
            return -line(phi, side)[np.newaxis]
        return flank.passed(phi, side, np.full(len(phi), per_stroke))

    def per_stiffness(phi: FloatArray, side: Side) -> ComplexArray:
        return np.asarray(-spring.way(phi, side)[0] * per_preload(phi, side))

    return per_preload, per_stiffness
