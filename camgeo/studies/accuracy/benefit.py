"""What accuracy buys: what the written contour does to acceleration and contact force.

A contour within eps of the exact one has a curvature that is off by much more. With n pieces, eps
falls with n^-k, k as of `camgeo.studies.accuracy.contours.ORDER`, and the curvature with n^-(k -
2): so the acceleration of the follower is off in proportion to eps^(1 - 2/k), that is eps^0 for
straight pieces, eps^(1/3) for arcs and eps^(1/2) for cubics. On straight pieces the acceleration
never comes near the demanded one, however many they are.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final

import numpy as np

from camgeo.design.design import Design
from camgeo.dynamics.effects.contact import holds_both_ways
from camgeo.dynamics.effects.effect import Subject
from camgeo.dynamics.effects.graph import Effects
from camgeo.dynamics.effects.results import CONTACT_FORCE, LIFT_OFF, VIBRATION, ContactForce
from camgeo.dynamics.state.state import FIRST
from camgeo.dynamics.state.written import State, Writing, Written
from camgeo.errors import EffectError, GeometryError, SceneError, ToleranceError
from camgeo.geometry.contour.contour import Form
from camgeo.geometry.outline.replay import AccelerationJoints
from camgeo.kinematics.time_course import ConstantSpeed
from camgeo.lazy import Ledger
from camgeo.numeric.arrays import SIDES, FloatArray, IntArray, Quantity, Side, grouped, merged
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.studies.accuracy.contours import FORMS, Progress, reason
from camgeo.units import RPM

SLOW: Final = 1e-3
"""Share of the lowest speed at which forces with a rigid train are looked at first: as good as at
rest, where contact is lost nowhere."""

MOST_PIECES: Final = 500
"""Pieces of the motion up to which forces with an elastic train are computed: its lift-off speed is
searched at about a hundred speeds, on all pieces each time."""


@dataclass(frozen=True, slots=True)
class BenefitRow:
    """What one contour does at one constant speed of the cam.

    The output is the member with the demanded motion; the exact motion is the demanded one, or that
    of the outline of a trimmed cam.

    Attributes
    ----------
    form, tolerance : of the contour; the tolerance in mm.
    speed : of the cam [rad/s].
    acceleration : largest deviation of the output's acceleration from the exact one [mm/s^2 or
        rad/s^2], jumps of the velocity apart. It is exact but for rounding, as are all figures here
        for the given contour.
    exact_acceleration : largest magnitude of the exact one.
    jump : largest jump of the output's velocity [mm/s or rad/s].
    force : largest deviation of the contact force [N], jumps of the velocity apart; None if the
        scene has no forces.
    lowest, highest : contact force on the flank [N], negative where that would have to pull; of a
        follower that is held both ways as `camgeo.dynamics.effects.results.ContactForce` has it,
        negative where the other side carries.
    exact_lowest, exact_highest : the same for the exact motion.
    lift_off : speed [rad/s] from which the contact force is 0 somewhere; infinite if it never is;
        None also if it was not found for an elastic train, and if the follower is held both ways.
    exact_lift_off : the same for the exact motion.
    fault : why values are missing; else empty.
    octaves : effective value of the deviation of the acceleration, jumps of the velocity included,
        in each octave of the cam's frequency: its harmonics 1, 2 and 3, 4 to 7 and so on [mm/s^2 or
        rad/s^2]. Empty if there are no values.
    octave_error : of each harmonic's amplitude at most, in the same unit.
    strongest : number of the harmonic of them with the largest amplitude.
    """

    form: Form
    tolerance: float
    speed: float
    acceleration: float | None = None
    exact_acceleration: float | None = None
    jump: float | None = None
    force: float | None = None
    lowest: float | None = None
    highest: float | None = None
    exact_lowest: float | None = None
    exact_highest: float | None = None
    lift_off: float | None = None
    exact_lift_off: float | None = None
    fault: str = ""
    octaves: tuple[float, ...] = ()
    octave_error: float | None = None
    strongest: int | None = None

    @property
    def ripple(self) -> float | None:
        """The deviation of the acceleration over its exact peak; None if that is 0."""
        if self.acceleration is None:
            return None
        return self.acceleration / self.exact_acceleration if self.exact_acceleration else None

    @property
    def strongest_octave(self) -> int | None:
        """The index of the largest of `octaves`; None if there are none."""
        return int(np.argmax(self.octaves)) if self.octaves else None

    @property
    def exact_force(self) -> float | None:
        """The largest contact force of the exact motion, of either side; None if there is none."""
        if self.exact_lowest is None or self.exact_highest is None:
            return None
        return max(self.exact_highest, -self.exact_lowest)

    @property
    def force_share(self) -> float | None:
        """The deviation of the contact force over `exact_force`; None if there is none."""
        return (
            self.force / self.exact_force if self.force is not None and self.exact_force else None
        )

    @property
    def lift_off_share(self) -> float | None:
        """How far the speed of lift-off is from the exact one, over that one; None if infinite."""
        own, exact = self.lift_off, self.exact_lift_off
        if own is None or exact is None or not math.isfinite(own + exact):
            return None
        return abs(exact - own) / exact


def benefit_rows(
    design: Design,
    tolerances: Sequence[float],
    speeds: Sequence[float],
    *,
    forms: Sequence[Form] = FORMS,
    progress: Progress = lambda _: None,
) -> tuple[BenefitRow, ...]:
    """One row per form, tolerance [mm] and constant speed of the cam [rad/s], in this order.

    Forces are those of the effects that the scene names, with its elastic train at that speed; no
    speed is found. A row states why it has no values: a form or follower whose motion is not
    computed, a tolerance that cannot be reached, forces without an answer.
    """
    first = exact_motion(design, min(speeds))
    if not first.of_one_speed:
        first = exact_motion(design, SLOW * first.speed)
    exact = {speed: first.known_at(speed) for speed in speeds}
    rows: list[BenefitRow] = []
    for form in forms:
        for tolerance in tolerances:
            progress(f"{form}, {tolerance:g} mm")
            bare = [BenefitRow(form, tolerance, speed) for speed in speeds]
            try:
                made = first.written_as(Writing(form, tolerance, design.scene.output.fit))
                pair = _Pair(first, made)
                rows += [pair.row(row, exact[row.speed]) for row in bare]
            except (ToleranceError, GeometryError, EffectError, SceneError) as error:
                rows += [replace(row, fault=reason(error)) for row in bare]
    return tuple(rows)


def exact_motion(design: Design, speed: float) -> Made:
    """The exact motion at a constant `speed` [rad/s], with the train of the scene."""
    edits = {"cam.speed": speed / RPM, "cam.speed_curve": None, "state": None}
    subject = Design(design.scene.with_values(edits)).effects.subject
    return Made(replace(subject, output=design.scene.train), design.scene.effects, speed)


@dataclass(frozen=True)
class Made:
    """One motion of the follower at one constant speed of the cam, and the forces on it.

    Attributes
    ----------
    subject : with that motion and that speed.
    tables : of the effects that the scene names; no speed is found.
    speed : [rad/s].
    """

    subject: Subject
    tables: Mapping[str, Mapping[str, Any]]
    speed: float

    def written_as(self, writing: Writing) -> Made:
        """That of a contour of the same disc."""
        return replace(self, subject=self.subject.written_as(writing, FIRST))

    @property
    def elastic(self) -> bool:
        """Whether forces are those of an elastic train."""
        return VIBRATION in self.tables and self.subject.output == "elastic"

    @property
    def of_one_speed(self) -> bool:
        """Whether forces are known for this speed only: those of an elastic train, and those on a
        follower that is held both ways, on which the other side carries at another speed.
        """
        return self.elastic or holds_both_ways(self.subject)

    def known_at(self, speed: float) -> Made:
        """That of which the forces at `speed` [rad/s] are known."""
        if not self.of_one_speed or speed == self.speed:
            return self
        return replace(self, subject=self.subject.turning(ConstantSpeed(speed)), speed=speed)

    @cached_property
    def effects(self) -> Effects:
        """Of the scene, with contact lost where the force is 0, whatever margin it wants."""
        tables = {**self.tables, LIFT_OFF: {}}
        return Effects(self.subject, tables, Ledger(), speed="stated")

    @cached_property
    def contact(self) -> ContactForce | None:
        """The contact force; None without forces.

        Raises
        ------
        EffectError
            As the effects; with an elastic train on more than `MOST_PIECES`.
        """
        if self.elastic and len(self.subject.state.smooth_angles) > MOST_PIECES:
            raise EffectError(
                "forces with an elastic train are computed on contours of up to"
                f" {MOST_PIECES} pieces only"
            )
        found = self.effects.result(CONTACT_FORCE)
        return found if found.forces else None

    def acceleration(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) of the output over the cam angle [mm or rad per rad^2]."""
        return np.asarray(self.subject.state.output.jet(phi, side, 2)[2])

    def force(self, speed: float) -> Quantity:
        """(n,) the contact force [N] at a constant `speed` [rad/s], see `known_at`: on the only
        flank, or in the sense of `ContactForce`.
        """
        contact = self.contact
        assert contact is not None
        sense = 1 if holds_both_ways(self.subject) else self.subject.cam.contact.push

        def found(phi: FloatArray, side: Side) -> FloatArray:
            if self.of_one_speed:
                return sense * contact.normal(phi, side)
            rates = np.zeros((2, len(phi)))
            rates[0] = speed
            return sense * contact.normal_at(phi, side, rates)

        return found

    @cached_property
    def lift_off(self) -> float | None:
        """Speed [rad/s] from which the force on the flank is 0 somewhere; infinite if it never is;
        None if it was not found, see `camgeo.dynamics.effects.lift_off.elastic_speed`, and if the
        follower is held both ways.
        """
        if holds_both_ways(self.subject):
            return None
        found = self.effects.result(str(LIFT_OFF)).speed
        return None if found is None else found.value * self.speed


@dataclass(frozen=True)
class _Pair:
    """The exact motion and that of a contour."""

    exact: Made
    made: Made

    def row(self, bare: BenefitRow, exact: Made) -> BenefitRow:
        """The row with its values; `exact` is the exact motion known at its speed."""
        square = bare.speed**2
        row = replace(
            bare,
            acceleration=square * self._acceleration,
            exact_acceleration=square * self._exact_acceleration,
            jump=bare.speed * self._jump,
            octaves=tuple((square * self._spectrum.octaves).tolist()),
            octave_error=square * self._spectrum.error,
            strongest=self._spectrum.strongest,
        )
        try:
            row = self._with_forces(row, exact)
            if row.force is None:
                return row
            row = replace(row, exact_lift_off=self.exact.lift_off)
            return replace(row, lift_off=self.made.lift_off)
        except (GeometryError, EffectError) as error:
            return replace(row, fault=reason(error))

    def _with_forces(self, row: BenefitRow, exact: Made) -> BenefitRow:
        """The row with its forces, if the scene has any."""
        made = self.made.known_at(row.speed)
        if exact.contact is None or made.contact is None:
            return row
        edges = merged(np.concatenate((exact.contact.edges, made.contact.edges, self._joints.ends)))
        forces = made.force(row.speed), exact.force(row.speed)
        own, demanded = (piecewise_extremes(each, edges) for each in forces)
        return replace(
            row,
            force=self._deviation(*forces, edges),
            lowest=own.lowest.value,
            highest=own.highest.value,
            exact_lowest=demanded.lowest.value,
            exact_highest=demanded.highest.value,
        )

    @cached_property
    def _acceleration(self) -> float:
        made, exact = self.made.subject.state.smooth_angles, self.exact.subject.state.smooth_angles
        edges = merged(np.concatenate((made, exact, self._joints.ends)))
        return self._deviation(self.made.acceleration, self.exact.acceleration, edges)

    @cached_property
    def _exact_acceleration(self) -> float:
        edges = self.exact.subject.state.smooth_angles
        return piecewise_extremes(self.exact.acceleration, edges).magnitude

    @cached_property
    def _spectrum(self) -> Spectrum:
        return ripple_spectrum(self.made.subject.state, self.exact.subject.state)

    @cached_property
    def _jump(self) -> float:
        state = self.made.subject.state
        places = np.array(state.shocks)
        before, after = (state.output.jet(places, side, 1)[1] for side in SIDES)
        return float(np.max(np.abs(after - before), initial=0.0))

    @cached_property
    def _joints(self) -> AccelerationJoints:
        """Of the exact motion, as the contour places them."""
        state, own = self.made.subject.state, self.exact.subject.state
        assert isinstance(state, Written)
        edges = merged(np.concatenate((state.smooth_angles, own.smooth_angles)))
        return AccelerationJoints.between(
            state.replay.lift.shift_of, state.motion.jet, own.motion, edges
        )

    def _deviation(self, quantity: Quantity, exact: Quantity, edges: FloatArray) -> float:
        """The largest magnitude of the difference; both are smooth between `edges` (k,) [rad]."""
        return piecewise_extremes(self._joints.deviation(quantity, exact), edges).magnitude


# -- spectrum -------------------------------------------------------------------------------------
# The spectrum of the ripple: harmonics of the cam's speed in the acceleration that is off.
#
# The deviation of the output's velocity is smooth from piece to piece of the contour and bounded,
# so its Fourier integrals are sums over the pieces; those of the acceleration follow by the factor
# i k, jumps of the velocity included.


OCTAVES: Final = 9
"""Of a spectrum: the first is harmonic 1, the second 2 and 3, the last 256 to 511."""

MOST: Final = 2**OCTAVES - 1
"""Harmonics in them."""

GAUSS: Final = (12, 16)
"""Nodes of Gauss's quadrature of a cell, and of the one that it is compared with."""

PHASE: Final = 2.0
"""Most by which the phase of the highest harmonic changes over a cell [rad]."""

EPS: Final = float(np.finfo(np.float64).eps)


def harmonics(octave: int) -> str:
    """Those of an octave, from 0, in words: "1", "2-3", "4-7" and so on."""
    first = 2**octave
    return f"{first}-{2 * first - 1}" if octave else "1"


@dataclass(frozen=True, slots=True, eq=False)
class Spectrum:
    """Harmonics of a ripple at a constant speed of 1 rad/s; they go with the square of the speed.

    Attributes
    ----------
    numbers : (n,) of the harmonics, from 1: number k has k times the frequency of the cam.
    amplitudes : (n,) of the output's acceleration that is off [mm or rad per rad^2].
    error : of each amplitude at most, in the same unit: the difference of two quadratures, and the
        rounding of their sums.
    """

    numbers: IntArray
    amplitudes: FloatArray
    error: float

    @property
    def octaves(self) -> FloatArray:
        """(m,) effective value of the harmonics 1, 2 to 3, 4 to 7, ..., in the same unit."""
        starts = 2 ** np.arange(int(np.log2(len(self.numbers) + 1))) - 1
        return np.asarray(np.sqrt(0.5 * np.add.reduceat(self.amplitudes**2, starts)))

    @property
    def strongest(self) -> int:
        """The number of the harmonic with the largest amplitude."""
        return int(self.numbers[np.argmax(self.amplitudes)])


def ripple_spectrum(made: State, exact: State, most: int = MOST) -> Spectrum:
    """The first `most` harmonics of the ripple of the motion `made`, which should be `exact`."""
    edges = merged(np.concatenate((made.smooth_angles, exact.smooth_angles)))
    widths = np.diff(edges)
    index, rank = grouped(np.maximum(1, np.ceil(widths * most / PHASE)).astype(np.intp))
    counts = np.bincount(index)
    width = (widths / counts)[index]
    low = edges[index] + rank * width
    numbers = np.arange(1, most + 1)
    found, sizes = [], []
    for nodes in GAUSS:
        places, weights = np.polynomial.legendre.leggauss(nodes)
        phi = (low[:, np.newaxis] + 0.5 * width[:, np.newaxis] * (1.0 + places)).ravel()
        shares = (0.5 * width[:, np.newaxis] * weights).ravel()
        term = shares * (made.output.jet(phi, "right", 1)[1] - exact.output.jet(phi, "right", 1)[1])
        term, turn = term.astype(np.complex128), np.exp(-1j * phi)
        sizes.append(float(np.sum(np.abs(term))))
        sums = np.empty(most, np.complex128)
        for k in range(most):
            term *= turn
            sums[k] = np.sum(term)
        found.append(sums)
    # Each product turns by a phase rounded like phi, and is itself rounded.
    rounded = numbers * 8.0 * EPS * max(sizes)
    factor = numbers / np.pi
    error = float(np.max(factor * (np.abs(found[1] - found[0]) + rounded), initial=0.0))
    return Spectrum(numbers, factor * np.abs(found[1]), error)
