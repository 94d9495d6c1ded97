"""The steady state of a cam at the end of an elastic shaft, and its obstacles."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from camgeo.effects.bearing_friction import linear_law
from camgeo.effects.camshaft_windup.periodic import (
    NoConvergenceError,
    Pair,
    WoundTurn,
    newton,
    periodic,
)
from camgeo.effects.camshaft_windup.wound import Wound
from camgeo.effects.effect import Quantity
from camgeo.effects.shaft.mesh import DoubleMesh, Mesh, double_mesh
from camgeo.effects.shaft.obstacles import jamming
from camgeo.effects.shaft.rate import StuckError
from camgeo.effects.shaft.switches import switches
from camgeo.effects.wording import missed
from camgeo.errors import EffectError
from camgeo.numeric.arrays import FloatArray, merged
from camgeo.units import RPM, TURN

LONGEST: Final = TURN / 24.0
"""Largest length of an initial cell [rad]."""

PHASE: Final = 4.0
"""Largest angle [rad] by which the cam swings on its shaft within an initial cell: a longer one
would damp the swing, alike on the halves of the cell, which would not show it."""

SWINGS: Final = 4.0
"""Largest number of swings on the shaft within a piece in which extremes are sought."""

STIFFEST: Final = 4000.0
"""Largest natural frequency, in speeds of the drive."""

ROUGH: Final = (1e-3, 1e-6)
"""Tolerances of the turns from which the places of kinks are taken."""

STIFFER: Final = (100.0, 30.0, 10.0, 5.0, 3.0, 2.0, 1.5, 1.2)
"""Shafts stiffer by these factors, by whose motions Newton's method is led to that of a soft one.
"""

SPURIOUS: Final = 0.1
"""A solution that is off by this share, however short the cells, is none."""


def solve(
    wound: Wound, law: Quantity, edges: FloatArray, tolerance: float, near: WoundTurn | None
) -> tuple[WoundTurn, FloatArray]:
    """The steady state, of which one that is `near` may be known, with speed and windup to the
    tolerance, and cam angles (k,) [rad] from 0 to 2 pi between which both are smooth and swing no
    more than `SWINGS` times.

    Parameters
    ----------
    law : the torque law of the cam, smooth between `edges` (k,) [rad].

    Raises
    ------
    EffectError
        "stiff-shaft", if it swings too fast to be followed; "soft-shaft", if there is no steady
        state in which the cam always turns forward; "jamming", if no acceleration satisfies the
        equation of motion with friction; and if the tolerance cannot be reached.
    """
    ratio = wound.shaft.natural_frequency / wound.speed
    if ratio > STIFFEST:
        raise EffectError(
            f"the natural frequency of the cam on its shaft is {ratio:.6g} times the speed of the"
            f" drive; allowed: up to {STIFFEST:g} times. So stiff a shaft follows the torque at"
            " once: its windup is drive torque / stiffness",
            finding="stiff-shaft",
            value=ratio,
            limit=STIFFEST,
        )
    turn = near
    if turn is None:
        turn = _solved(wound, law, edges, max(ROUGH[0], tolerance), None)
    for rough in ROUGH:
        found = switches(law, edges, turn.mesh.laws, turn.driven)
        if not len(found):
            break
        edges = merged(np.concatenate((edges, found)))
        turn = _solved(wound, law, edges, max(rough, tolerance), turn)
    turn = _solved(wound, law, edges, tolerance, turn)
    pieces = np.linspace(0.0, TURN, max(math.ceil(ratio / SWINGS), 1) + 1)
    return turn, merged(np.concatenate((edges, pieces)))


def _solved(
    wound: Wound, law: Quantity, edges: FloatArray, tolerance: float, near: WoundTurn | None
) -> WoundTurn:
    longest = min(LONGEST, PHASE * wound.speed / wound.shaft.natural_frequency)
    mesh = double_mesh(law, edges, longest)
    try:
        return periodic(wound, law, mesh, _guess(wound, mesh, tolerance, near), tolerance)
    except StuckError as error:
        raise jamming(wound.shaft.moment_of_inertia, mesh.fine) from error
    except NoConvergenceError as error:
        if error.reached is None or not error.reached < SPURIOUS:
            raise _too_soft(wound) from error
        raise missed("the windup", error.reached, "the largest one", tolerance) from error


def _guess(wound: Wound, mesh: DoubleMesh, tolerance: float, near: WoundTurn | None) -> Pair:
    """Near the solution on the coarse mesh: by way of stiffer shafts, if it must be."""
    coarse = mesh.coarse
    try:
        first = _static(wound, coarse) if near is None else near.on(coarse)
        return newton(wound, coarse, first, tolerance)[0]
    except (NoConvergenceError, StuckError):
        pair = _static(wound.stiffened(STIFFER[0]), coarse)
        for factor in (*STIFFER, 1.0):
            pair = newton(wound.stiffened(factor), coarse, pair, tolerance)[0]
        return pair


def _static(wound: Wound, mesh: Mesh) -> Pair:
    """The cam at the speed of the drive, with the shaft wound up by the torque at this speed."""
    c0, c1, c2, _, ahead, behind = linear_law(mesh.laws, wound.speed, 0.0)
    force = c0 + wound.speed * (c1 + wound.speed * c2)
    torque = np.where(force == 0.0, 0.0, force * np.where(force > 0.0, ahead, behind))
    if np.any(np.isnan(torque)):
        raise StuckError
    nodes = np.zeros((*torque.shape, 2))
    nodes[..., 1] = torque / wound.shaft.stiffness
    return Pair(np.concatenate((nodes[-1:, -1], nodes[:, -1])), nodes)


def _too_soft(wound: Wound) -> EffectError:
    hertz = wound.shaft.natural_frequency / TURN
    return EffectError(
        "no steady state was found in which the cam always turns forward: the camshaft is too"
        " soft for the torque of the cam, or swings in resonance with it. The cam alone swings on"
        f" it at {hertz:.6g} Hz, and its drive turns at {wound.speed / RPM:.6g} rev/min",
        finding="soft-shaft",
        value=hertz,
        unit="Hz",
    )
