"""What accuracy buys: what the written contour does to acceleration and contact force.

A contour within eps of the exact one has a curvature that is off by much more. With n pieces, eps
falls with n^-k, k as of `camgeo.accuracy.rows.ORDER`, and the curvature with n^-(k - 2): so the
acceleration of the follower is off in proportion to eps^(1 - 2/k), that is eps^0 for straight
pieces, eps^(1/3) for arcs and eps^(1/2) for cubics. On straight pieces the acceleration never comes
near the demanded one, however many they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final

import numpy as np

from camgeo.accuracy.contours import Progress, reason
from camgeo.accuracy.rows import FORMS
from camgeo.accuracy.spectrum import Spectrum, ripple_spectrum
from camgeo.contour.contour import Form
from camgeo.design import Design
from camgeo.effects.effect import Subject
from camgeo.effects.graph import Effects
from camgeo.effects.results import CONTACT_FORCE, ContactForce
from camgeo.errors import EffectError, GeometryError, SceneError, ToleranceError
from camgeo.lazy import Ledger
from camgeo.numeric.arrays import SIDES, FloatArray, Side, merged
from camgeo.numeric.extremes import Extremes, piecewise_extremes
from camgeo.outline.replay_result import AROUND, SEAM, SHIFT
from camgeo.state.contours import Writing
from camgeo.state.state import FIRST
from camgeo.state.written import Written
from camgeo.units import RPM, TURN

LIFT_OFF: Final = "lift-off"

SLOW: Final = 1e-3
"""Share of the lowest speed at which forces are looked at first: as good as at rest."""

SAMPLES: Final = 41
"""Places around a joint at which the error of the lift is looked at."""

Quantity = Callable[[FloatArray, Side], FloatArray]


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
    lowest, highest : contact force on the flank [N], negative where that would have to pull.
    exact_lowest, exact_highest : the same for the exact motion.
    lift_off : speed [rad/s] from which the contact force is 0 somewhere; infinite if it never is.
    exact_lift_off : the same for the exact motion.
    fault : why there are no values; empty if there are.
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
    def force_share(self) -> float | None:
        """The deviation of the contact force over its exact maximum; None if there is none."""
        return (
            None
            if self.force is None or not self.exact_highest
            else self.force / self.exact_highest
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

    Forces are those of the effects that the scene names. A row states why it has no values: a form
    or follower whose motion is not computed, a tolerance that cannot be reached.
    """
    slow, exact = slowed(design, min(speeds))
    rows: list[BenefitRow] = []
    for form in forms:
        for tolerance in tolerances:
            progress(f"{form}, {tolerance:g} mm")
            bare = [BenefitRow(form, tolerance, speed) for speed in speeds]
            try:
                made = exact.written_as(Writing(form, tolerance))
                pair = _Pair(exact, made, slow)
                rows += [pair.row(row) for row in bare]
            except (ToleranceError, GeometryError, EffectError, SceneError) as error:
                rows += [replace(row, fault=reason(error)) for row in bare]
    return tuple(rows)


def slowed(design: Design, speed: float) -> tuple[float, Made]:
    """A speed [rad/s] at which the cam all but rests, and the exact motion with it."""
    slow, scene = SLOW * speed, design.scene
    edits = {"cam.speed": slow / RPM, "cam.speed_curve": None, "state": None}
    subject = Design(scene.with_values(edits)).effects.subject
    return slow, Made(subject, scene.effects)


@dataclass(frozen=True)
class Made:
    """One motion of the follower, and the forces on it.

    Attributes
    ----------
    subject : with that motion, at a speed at which the cam all but rests.
    tables : of the effects that the scene names.
    """

    subject: Subject
    tables: Mapping[str, Mapping[str, Any]]

    def written_as(self, writing: Writing) -> Made:
        """That of a contour of the same disc."""
        return replace(self, subject=self.subject.written_as(writing, FIRST))

    @cached_property
    def effects(self) -> Effects:
        """Of the scene."""
        return Effects(self.subject, self.tables, Ledger())

    @cached_property
    def contact(self) -> ContactForce | None:
        """The contact force; None without forces."""
        found = self.effects.result(CONTACT_FORCE)
        return found if found.forces else None

    @cached_property
    def edges(self) -> FloatArray:
        """(k,) cam angles [rad] from 0 to 2 pi between which all is smooth."""
        smooth = self.subject.state.smooth_angles
        return smooth if self.contact is None else self.contact.edges

    def acceleration(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) of the output over the cam angle [mm or rad per rad^2]."""
        return np.asarray(self.subject.state.output.jet(phi, side, 2)[2])

    def force(self, speed: float) -> Quantity:
        """The force [N] on the only flank at a constant `speed` [rad/s]."""
        contact, sense = self.contact, self.subject.cam.contact.push

        def found(phi: FloatArray, side: Side) -> FloatArray:
            rates = np.zeros((2, len(phi)))
            rates[0] = speed
            return (
                np.zeros(len(phi))
                if contact is None
                else (sense * contact.normal_at(phi, side, rates))
            )

        return found

    def lift_off(self, slow: float) -> float:
        """Speed [rad/s] from which the force on the flank is 0 somewhere; infinite if it never is.

        The one that all but rests is `slow`.
        """
        factor: float = self.effects.result(LIFT_OFF).speed.value
        return slow * factor


@dataclass(frozen=True)
class _Pair:
    """The exact motion and that of a contour."""

    exact: Made
    made: Made
    slow: float

    def row(self, bare: BenefitRow) -> BenefitRow:
        """The row with its values."""
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
        if self.made.contact is None:
            return row
        force, exact = self.made.force(bare.speed), self.exact.force(bare.speed)
        ends, exact_ends = self._extremes(force), self._extremes(exact)
        return replace(
            row,
            force=self._deviation(force, exact),
            lowest=ends.lowest.value,
            highest=ends.highest.value,
            exact_lowest=exact_ends.lowest.value,
            exact_highest=exact_ends.highest.value,
            lift_off=self._lift_off,
            exact_lift_off=self._exact_lift_off,
        )

    @cached_property
    def _lift_off(self) -> float:
        return self.made.lift_off(self.slow)

    @cached_property
    def _exact_lift_off(self) -> float:
        return self.exact.lift_off(self.slow)

    @cached_property
    def _acceleration(self) -> float:
        return self._deviation(self.made.acceleration, self.exact.acceleration)

    @cached_property
    def _exact_acceleration(self) -> float:
        return piecewise_extremes(self.exact.acceleration, self.exact.edges).magnitude

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
    def _joints(self) -> tuple[tuple[float, float], ...]:
        """Cam angles [rad] at which the exact acceleration jumps, and how near to one the contour
        may place it.
        """
        state, own = self.made.subject.state, self.exact.subject.state.motion
        assert isinstance(state, Written)
        left, right = (own.jet(own.breaks, side, 2)[2] for side in SIDES)
        found = []
        for joint in own.breaks[left != right].tolist():
            around = joint + np.linspace(-AROUND, AROUND, SAMPLES)
            errors = state.motion.jet(around)[:3] - own.jet(around)[:3]
            reach = SEAM + SHIFT * float(np.max(state.replay.lift.shift_of(joint, errors)))
            found.append((joint, reach))
        return tuple(found)

    @cached_property
    def edges(self) -> FloatArray:
        """(k,) cam angles [rad] from 0 to 2 pi between which both are smooth."""
        near = [[joint - reach, joint, joint + reach] for joint, reach in self._joints]
        around = np.remainder(np.array(near).ravel(), TURN)
        return merged(np.concatenate((self.made.edges, self.exact.edges, around)))

    def _extremes(self, quantity: Quantity) -> Extremes:
        return piecewise_extremes(quantity, self.edges)

    def _deviation(self, quantity: Quantity, exact: Quantity) -> float:
        """The largest magnitude of the difference.

        A joint at which the exact quantity jumps lies on the contour only within the tolerance: so
        close to one, a value between those of its two sides is not off.
        """
        steps = []
        for joint, reach in self._joints:
            ends = [float(exact(np.array([joint]), side)[0]) for side in SIDES]
            steps.append((joint, reach, min(ends), max(ends)))

        def gap(phi: FloatArray, side: Side) -> FloatArray:
            values = quantity(phi, side)
            off = values - exact(phi, side)
            for joint, reach, low, high in steps:
                away = np.abs(np.remainder(phi - joint + 0.5 * TURN, TURN) - 0.5 * TURN)
                near = away <= reach
                off[near] = values[near] - np.clip(values[near], low, high)
            return off

        return self._extremes(gap).magnitude
