"""What accuracy buys, and where more of it stops paying.

A tighter tolerance buys a motion that is nearer to the exact one: this module computes what the
written contour does to acceleration, contact force and lift-off speed.

A contour within eps of the exact one has a curvature that deviates by much more. With n pieces, eps
falls with n^-k, where k is the order in `camgeo.studies.accuracy.contours.ORDER`, and the error of
the curvature with n^-(k - 2). The error of the follower's acceleration is therefore proportional to
eps^(1 - 2/k), that is eps^0 for straight pieces, eps^(1/3) for arcs and eps^(1/2) for cubics. On
straight pieces the acceleration never approaches the demanded one, however many there are.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final, Literal

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
from camgeo.studies.accuracy.contours import FORMS, ContourRow, FileCost, Progress, reason
from camgeo.units import RPM, counted

SLOW: Final = 1e-3
"""Fraction of the lowest speed at which forces with a rigid train are computed first: practically
at rest, where contact is lost nowhere."""

MOST_PIECES: Final = 500
"""Number of pieces of the motion up to which forces with an elastic train are computed: the search
for its lift-off speed computes about a hundred speeds, each on all pieces."""


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
        rad/s^2], without the impulses at jumps of the velocity. Like all figures of a row, it is
        exact for the given contour except for rounding.
    exact_acceleration : largest magnitude of the exact one.
    jump : largest jump of the output's velocity [mm/s or rad/s].
    force : largest deviation of the contact force [N], without the impulses at jumps of the
        velocity; None if the scene has no forces.
    lowest, highest : extremes of the contact force on the flank [N], negative where the flank would
        have to pull. For a follower that is held both ways, with the sign of
        `camgeo.dynamics.effects.results.ContactForce`: negative where the other side carries.
    exact_lowest, exact_highest : the same for the exact motion.
    lift_off_speed : speed [rad/s] from which the contact force is 0 somewhere; infinite if it never
        is; None also if it was not found for an elastic train, and if the follower is held both
        ways.
    exact_lift_off_speed : the same for the exact motion.
    fault : why values are missing; else empty.
    octaves : effective value of the deviation of the acceleration, jumps of the velocity included,
        in each octave of the cam's frequency: its harmonics 1, 2 and 3, 4 to 7 and so on [mm/s^2 or
        rad/s^2]. Empty if there are no values.
    octave_error : bound on the error of each harmonic's amplitude, in the same unit.
    strongest : number of the harmonic with the largest amplitude.
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
    lift_off_speed: float | None = None
    exact_lift_off_speed: float | None = None
    fault: str = ""
    octaves: tuple[float, ...] = ()
    octave_error: float | None = None
    strongest: int | None = None

    @property
    def ripple(self) -> float | None:
        """The deviation of the acceleration relative to its exact peak; None if the peak is 0."""
        if self.acceleration is None:
            return None
        return self.acceleration / self.exact_acceleration if self.exact_acceleration else None

    @property
    def strongest_octave(self) -> int | None:
        """The index of the largest of `octaves`; None if there are none."""
        return int(np.argmax(self.octaves)) if self.octaves else None

    @property
    def exact_force(self) -> float | None:
        """The largest contact force of the exact motion on either side; None without forces."""
        if self.exact_lowest is None or self.exact_highest is None:
            return None
        return max(self.exact_highest, -self.exact_lowest)

    @property
    def force_share(self) -> float | None:
        """The deviation of the contact force relative to `exact_force`; None without forces."""
        return (
            self.force / self.exact_force if self.force is not None and self.exact_force else None
        )

    @property
    def lift_off_share(self) -> float | None:
        """Relative error of the lift-off speed; None if it is infinite or not known."""
        actual, exact = self.lift_off_speed, self.exact_lift_off_speed
        if actual is None or exact is None or not math.isfinite(actual + exact):
            return None
        return abs(exact - actual) / exact


def benefit_rows(
    design: Design,
    tolerances: Sequence[float],
    speeds: Sequence[float],
    *,
    forms: Sequence[Form] = FORMS,
    progress: Progress = lambda _: None,
) -> tuple[BenefitRow, ...]:
    """One row per form, tolerance [mm] and constant speed of the cam [rad/s], in this order.

    Forces are those of the effects that the scene names, with its elastic train. The speed is taken
    as constant; no speed variation is computed. A row states why it has no values: a form or
    follower whose motion is not computed, a tolerance that cannot be reached, forces without an
    answer.
    """
    first = exact_motion(design, min(speeds))
    # Forces that hold for any speed are computed nearly at rest, where no contact is lost.
    if not first.of_one_speed:
        first = exact_motion(design, SLOW * first.speed)
    exact = {speed: first.for_speed(speed) for speed in speeds}
    rows: list[BenefitRow] = []
    for form in forms:
        for tolerance in tolerances:
            progress(f"{form}, {tolerance:g} mm")
            bare = [BenefitRow(form, tolerance, speed) for speed in speeds]
            try:
                written = first.with_contour(Writing(form, tolerance, design.scene.output.fit))
                pair = _MotionPair(first, written)
                rows += [pair.row(row, exact[row.speed]) for row in bare]
            except (ToleranceError, GeometryError, EffectError, SceneError) as error:
                rows += [replace(row, fault=reason(error)) for row in bare]
    return tuple(rows)


def exact_motion(design: Design, speed: float) -> SteadyMotion:
    """The exact motion at a constant `speed` [rad/s], with the train of the scene."""
    edits = {"cam.speed": speed / RPM, "cam.speed_curve": None, "state": None}
    subject = Design(design.scene.with_values(edits)).effects.subject
    return SteadyMotion(replace(subject, output=design.scene.train), design.scene.effects, speed)


@dataclass(frozen=True)
class SteadyMotion:
    """One motion of the follower at one constant speed of the cam, and the forces on it.

    Attributes
    ----------
    subject : the machine with that motion at that speed.
    tables : of the effects that the scene names, by their names.
    speed : of the cam [rad/s].
    """

    subject: Subject
    tables: Mapping[str, Mapping[str, Any]]
    speed: float

    def with_contour(self, writing: Writing) -> SteadyMotion:
        """The motion on a written contour of the same disc."""
        return replace(self, subject=self.subject.with_written_contours(writing, FIRST))

    @property
    def elastic(self) -> bool:
        """Whether forces are those of an elastic train."""
        return VIBRATION in self.tables and self.subject.output == "elastic"

    @property
    def of_one_speed(self) -> bool:
        """Whether forces are known at this speed only.

        That is so for an elastic train, and for a follower that is held both ways: which of its
        sides carries depends on the speed.
        """
        return self.elastic or holds_both_ways(self.subject)

    def for_speed(self, speed: float) -> SteadyMotion:
        """The motion with which the forces at `speed` [rad/s] can be computed."""
        if not self.of_one_speed or speed == self.speed:
            return self
        return replace(self, subject=self.subject.turning(ConstantSpeed(speed)), speed=speed)

    @cached_property
    def effects(self) -> Effects:
        """The effects of the scene. Contact is lost where the force is 0, whatever margin of the
        contact force the scene states.
        """
        tables = {**self.tables, LIFT_OFF: {}}
        return Effects(self.subject, tables, Ledger(), speed="stated")

    @cached_property
    def contact(self) -> ContactForce | None:
        """The contact force; None if the scene has no forces.

        Raises
        ------
        EffectError
            If an effect has no answer, or with an elastic train on more than `MOST_PIECES` pieces.
        """
        if self.elastic and len(self.subject.state.smooth_angles) > MOST_PIECES:
            raise EffectError(
                "forces with an elastic train are computed only on contours of up to"
                f" {MOST_PIECES} pieces"
            )
        contact_force = self.effects.result(CONTACT_FORCE)
        return contact_force if contact_force.forces else None

    def acceleration(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) second derivative of the output by the cam angle [mm or rad per rad^2]."""
        return np.asarray(self.subject.state.output.jet(phi, side, 2)[2])

    def force(self, speed: float) -> Quantity:
        """The contact force [N] as a function of the cam angle, at a constant `speed` [rad/s].

        It is positive where the flank pushes; of a follower that is held both ways it has the sign
        of `ContactForce`. See `for_speed` for which speeds it is known.
        """
        contact = self.contact
        assert contact is not None
        sense = 1 if holds_both_ways(self.subject) else self.subject.cam.contact.push

        def normal_force(phi: FloatArray, side: Side) -> FloatArray:
            if self.of_one_speed:
                return sense * contact.normal(phi, side)
            rates = np.zeros((2, len(phi)))
            rates[0] = speed  # and no angular acceleration
            return sense * contact.normal_at_rates(phi, side, rates)

        return normal_force

    @cached_property
    def lift_off_speed(self) -> float | None:
        """Speed [rad/s] from which the force on the flank is 0 somewhere; infinite if it never is;
        None if it was not found, see `camgeo.dynamics.effects.lift_off.elastic_speed`, and if the
        follower is held both ways.
        """
        if holds_both_ways(self.subject):
            return None
        relative_speed = self.effects.result(str(LIFT_OFF)).speed
        return None if relative_speed is None else relative_speed.value * self.speed


@dataclass(frozen=True)
class _MotionPair:
    """The exact motion and the motion on a written contour, at one speed of the cam."""

    exact: SteadyMotion
    written: SteadyMotion

    def row(self, bare: BenefitRow, exact: SteadyMotion) -> BenefitRow:
        """The row with its values; `exact` is the exact motion at the speed of the row."""
        # At a constant speed the time derivatives are those by the angle times its powers.
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
            row = replace(row, exact_lift_off_speed=self.exact.lift_off_speed)
            return replace(row, lift_off_speed=self.written.lift_off_speed)
        except (GeometryError, EffectError) as error:
            return replace(row, fault=reason(error))

    def _with_forces(self, row: BenefitRow, exact: SteadyMotion) -> BenefitRow:
        """The row with its forces, if the scene has any."""
        written = self.written.for_speed(row.speed)
        if exact.contact is None or written.contact is None:
            return row
        edges = merged(
            np.concatenate((exact.contact.edges, written.contact.edges, self._joints.ends))
        )
        forces = written.force(row.speed), exact.force(row.speed)
        actual, demanded = (piecewise_extremes(force, edges) for force in forces)
        return replace(
            row,
            force=self._deviation(*forces, edges),
            lowest=actual.lowest.value,
            highest=actual.highest.value,
            exact_lowest=demanded.lowest.value,
            exact_highest=demanded.highest.value,
        )

    @cached_property
    def _acceleration(self) -> float:
        written_angles, exact_angles = (
            self.written.subject.state.smooth_angles,
            self.exact.subject.state.smooth_angles,
        )
        edges = merged(np.concatenate((written_angles, exact_angles, self._joints.ends)))
        return self._deviation(self.written.acceleration, self.exact.acceleration, edges)

    @cached_property
    def _exact_acceleration(self) -> float:
        edges = self.exact.subject.state.smooth_angles
        return piecewise_extremes(self.exact.acceleration, edges).magnitude

    @cached_property
    def _spectrum(self) -> RippleSpectrum:
        return ripple_spectrum(self.written.subject.state, self.exact.subject.state)

    @cached_property
    def _jump(self) -> float:
        state = self.written.subject.state
        places = np.array(state.shocks)
        left, right = (state.output.jet(places, side, 1)[1] for side in SIDES)
        return float(np.max(np.abs(right - left), initial=0.0))

    @cached_property
    def _joints(self) -> AccelerationJoints:
        """The joints of the exact acceleration, at the cam angles where the contour has them."""
        state, exact = self.written.subject.state, self.exact.subject.state
        assert isinstance(state, Written)
        edges = merged(np.concatenate((state.smooth_angles, exact.smooth_angles)))
        return AccelerationJoints.from_motions(
            state.replay.lift.joint_shift, state.motion.jet, exact.motion, edges
        )

    def _deviation(self, quantity: Quantity, exact: Quantity, edges: FloatArray) -> float:
        """The largest difference of two quantities that are smooth between `edges` (k,) [rad]."""
        return piecewise_extremes(self._joints.deviation(quantity, exact), edges).magnitude


# -- spectrum -------------------------------------------------------------------------------------
# The spectrum of the ripple: harmonics of the cam's speed in the acceleration that is off.
#
# The deviation of the output's velocity is smooth from piece to piece of the contour and bounded,
# so its Fourier integrals are sums over the pieces; those of the acceleration follow by the factor
# i k, jumps of the velocity included.


OCTAVES: Final = 9
"""Number of octaves of a spectrum: the first is harmonic 1, the second 2 and 3, the last 256 to
511."""

MOST: Final = 2**OCTAVES - 1
"""Number of harmonics in these octaves."""

GAUSS: Final = (12, 16)
"""Nodes of the two Gauss quadratures of each cell; their difference estimates the error."""

PHASE: Final = 2.0
"""Largest change of the phase of the highest harmonic over a cell [rad]."""

EPS: Final = float(np.finfo(np.float64).eps)


@dataclass(frozen=True, slots=True, eq=False)
class RippleSpectrum:
    """Harmonics of a ripple at a constant speed of 1 rad/s; they grow with the square of the speed.

    Attributes
    ----------
    numbers : (n,) numbers of the harmonics, from 1: number k has k times the frequency of the cam.
    amplitudes : (n,) of the deviation of the output's acceleration [mm or rad per rad^2].
    error : bound on the error of each amplitude, in the same unit: the difference of two
        quadratures, and the rounding of their sums.
    """

    numbers: IntArray
    amplitudes: FloatArray
    error: float

    @property
    def octaves(self) -> FloatArray:
        """(m,) effective value of the harmonics 1, 2 to 3, 4 to 7, ..., in the same unit."""
        # Octave m begins with harmonic 2^m, at index 2^m - 1; a sine's mean square is half A^2.
        starts = 2 ** np.arange(int(np.log2(len(self.numbers) + 1))) - 1
        return np.asarray(np.sqrt(0.5 * np.add.reduceat(self.amplitudes**2, starts)))

    @property
    def strongest(self) -> int:
        """The number of the harmonic with the largest amplitude."""
        return int(self.numbers[np.argmax(self.amplitudes)])


def ripple_spectrum(written: State, exact: State, most: int = MOST) -> RippleSpectrum:
    """The first `most` harmonics of the `written` motion's acceleration less the `exact` one's."""
    edges = merged(np.concatenate((written.smooth_angles, exact.smooth_angles)))
    widths = np.diff(edges)
    # Each smooth stretch is cut into equal cells, in which the highest harmonic turns by PHASE at
    # most, so that a quadrature of few nodes resolves it.
    index, rank = grouped(np.maximum(1, np.ceil(widths * most / PHASE)).astype(np.intp))
    counts = np.bincount(index)
    width = (widths / counts)[index]
    low = edges[index] + rank * width
    numbers = np.arange(1, most + 1)
    integrals, sizes = [], []
    for nodes in GAUSS:
        places, weights = np.polynomial.legendre.leggauss(nodes)
        phi = (low[:, np.newaxis] + 0.5 * width[:, np.newaxis] * (1.0 + places)).ravel()
        shares = (0.5 * width[:, np.newaxis] * weights).ravel()
        term = shares * (
            written.output.jet(phi, "right", 1)[1] - exact.output.jet(phi, "right", 1)[1]
        )
        # Term k + 1 follows from term k by one product: the exponentials are computed only once.
        term, turn = term.astype(np.complex128), np.exp(-1j * phi)
        sizes.append(float(np.sum(np.abs(term))))
        sums = np.empty(most, np.complex128)
        for k in range(most):
            term *= turn
            sums[k] = np.sum(term)
        integrals.append(sums)
    # Each product turns by a phase rounded like phi, and is itself rounded.
    rounded = numbers * 8.0 * EPS * max(sizes)
    # The integral of the velocity's harmonic k, times k, over pi: the acceleration's amplitude.
    factor = numbers / np.pi
    error = float(np.max(factor * (np.abs(integrals[1] - integrals[0]) + rounded), initial=0.0))
    return RippleSpectrum(numbers, factor * np.abs(integrals[1]), error)


# -- knee ------------------------------------------------------------------------------------------
# The knee: among the contours of one form, the tolerance beyond which more cost gains nothing.
#
# Each decade of accuracy multiplies the pieces by 10^(1/k), k = 2, 3, 4 for chords, arcs and
# cubics; a power law has no knee. What the pieces are for has some, and the knee is where the first
# of these ends:
#
# - time: a contour is milled in at most 5 % more time than the quickest one; beyond it, blocks
#   become too short for the feed, which costs minutes of machining;
# - decimals: its program has no more decimals than the loosest one: a program has at least the
#   controller's number of decimals, and beyond that the printed numbers set the limit, not the
#   contour;
# - ripple: the error of the acceleration in a replay, if it was requested, falls by at least 5 %,
#   or benefit: at a speed of the cam, if one was requested, a tighter contour changes one of the
#   figures of `camgeo.studies.accuracy.benefit` by more than 5 %;
# - cost, where none of these two is known: what a contour costs, the geometric mean of its pieces,
#   of the bytes of its drawing and of the seconds to fit, prove, write and read that, is at most
#   two steps of a factor 1.5 above the cheapest. Bytes and seconds have a constant part, and while
#   that is the larger one, accuracy adds little to them; beyond it, each decade multiplies
#   everything.
#
# Where none of them ends within the tolerances that were measured, that is said: the end of a range
# is no knee.


SLACK: Final = 1.05
"""Machining times and ripples up to this factor of the best count as the best: feed override and
rounding of a plan change them more."""

STEP: Final = 1.5
"""Least ratio of costs that counts as a difference: two runs on a busy machine differ by less."""

STEPS: Final = 2
"""How many of these steps a contour may cost more than the cheapest one."""

LEAST_TIME: Final = 5e-4
"""Differences of computing times [s] below this are reported as none."""

NAMES: Final[dict[Form, str]] = {
    "polyline": "straight pieces",
    "arcs": "arcs",
    "spline": "a spline",
}

End = Literal["time", "decimals", "ripple", "benefit", "cost", "reach", "range"]

BEYOND: Final[dict[End, str]] = {
    "time": "tighter contours are milled more slowly, their blocks are too short for the feed",
    "ripple": "tighter contours run no smoother",
    "benefit": "tighter ones change what the follower does by at most 5 %",
    "cost": f"tighter ones cost more than {STEP**STEPS:g} times as much as the cheapest",
    "reach": "tighter tolerances cannot be reached",
    "range": "that is the end of what was tried, not a knee",
}
"""What the advice says of tighter tolerances; for decimals, `_beyond` adds their number."""


@dataclass(frozen=True, slots=True)
class Knee:
    """The recommendation, and which benefit ends beyond it.

    Attributes
    ----------
    row : the recommended contour.
    end : what a tighter tolerance loses, see above; "reach" if it cannot be reached, "range" if
        none was measured.
    quick : the tightest tolerance [mm] that is milled in at most 5 % more than the least time; None
        without milling.
    step : the same contour at two tolerances: the last step up to the knee, or the first one beyond
        it if the knee is the loosest; empty if only one was measured.
    bought : by which share of the acceleration's peak the second of them deviates less than the
        first; None if that is not known.
    """

    row: ContourRow
    end: End
    quick: float | None
    step: tuple[ContourRow, ...] = ()
    bought: float | None = None

    @property
    def step_sentence(self) -> str:
        """What the `step` costs and buys, as the end of a sentence; empty without a step."""
        if not self.step:
            return ""
        loose, tight = self.step
        pieces, size = _pieces(tight) - _pieces(loose), _drawing(tight).size - _drawing(loose).size
        seconds = _drawing(tight).seconds - _drawing(loose).seconds
        parts = [counted(pieces, "piece"), "no time" if seconds < LEAST_TIME else _time(seconds)]
        text = f"{', '.join(parts)} and {_digits(size / 1e3)} kB"
        if loose.round_seconds is not None and tight.round_seconds is not None:
            longer = tight.round_seconds - loose.round_seconds
            same = abs(longer) <= (SLACK - 1.0) * loose.round_seconds
            more = f"{abs(longer):.1f} s {'longer' if longer > 0.0 else 'shorter'}"
            text += f", machining {'the same' if same else more}"
        if self.bought is not None:
            share = f"{100.0 * self.bought:.2g} %" if self.bought > 0.0 else "nothing"
            text += f", and buys {share} of the acceleration"
        return f"from {loose.tolerance:g} mm to {tight.tolerance:g} mm costs {text}"


def find_knee(
    rows: Sequence[ContourRow], benefits: Sequence[BenefitRow] = (), *, timed: bool = True
) -> Knee | None:
    """The knee of `rows` of one form and effort, the loosest first; None if no tolerance can be
    reached.

    Parameters
    ----------
    benefits : rows of that form at one speed of the cam, if they are known.
    timed : whether seconds of computing count, which hold for one computer only.
    """
    known = [row for row in rows if row.count is not None and row.drawing is not None]
    if not known:
        return None
    milled = any(row.decimals is not None for row in known)
    rounds = {row.tolerance: row.round_seconds for row in known if milled}
    quick = _tightest(rounds, SLACK)
    limits: list[tuple[float | None, End]] = [
        (quick, "time"),
        (_tightest({row.tolerance: row.decimals for row in known}, 1.0), "decimals"),
    ]
    ripples = {row.tolerance: row.ripple for row in known if row.ripple is not None}
    deviations = {
        row.tolerance: row.ripple for row in benefits if row.ripple is not None
    } or ripples
    if ripples:
        least = min(ripples.values())
        limits.append(
            (max(t for t, ripple in ripples.items() if ripple <= SLACK * least), "ripple")
        )
    if benefits:
        sufficient = find_sufficient(benefits)
        limits.append((None if sufficient is None else sufficient.row.tolerance, "benefit"))
    # Cost alone decides only where nothing is known of what a tighter contour is good for.
    if not deviations:
        costs = {row.tolerance: _cost(row, timed=timed) for row in known}
        limits.append((_tightest(costs, STEP**STEPS), "cost"))
    # The benefit that ends first, at the loosest tolerance, sets the knee.
    tightest, end = max(
        ((limit, name) for limit, name in limits if limit is not None), key=lambda pair: pair[0]
    )
    number = max(k for k, row in enumerate(known) if row.tolerance >= tightest)
    if number == len(known) - 1:
        end = "reach" if rows[-1].tolerance < known[-1].tolerance else "range"
    step = tuple(known[number - 1 : number + 1] if number else known[:2])
    ends = [deviations[row.tolerance] for row in step if row.tolerance in deviations]
    bought = ends[0] - ends[1] if len(ends) > 1 else None
    return Knee(known[number], end, quick, step if len(step) > 1 else (), bought)


def _tightest(costs: Mapping[float, float | None], factor: float) -> float | None:
    """The tightest tolerance whose cost is at most `factor` times the least one; None if no costs
    are known.
    """
    known = {tolerance: cost for tolerance, cost in costs.items() if cost is not None}
    if not known:
        return None
    most = factor * min(known.values())
    return min(tolerance for tolerance, cost in known.items() if cost <= most)


def _cost(row: ContourRow, *, timed: bool) -> float:
    """The geometric mean of what a contour costs. Its unit is meaningless: only ratios count."""
    costs = [_pieces(row), _drawing(row).size, *([_drawing(row).seconds] if timed else [])]
    return math.prod(costs) ** (1.0 / len(costs))


def advice(knee: Knee | None) -> str:
    """The advice in words, without seconds of computing, which differ from run to run."""
    if knee is None:
        return "none of these tolerances can be reached"
    row = knee.row
    head = f"{NAMES[row.form]} ({row.effort}) within {row.tolerance:g} mm"
    costs = [counted(_pieces(row), "piece"), f"drawing of {counted(_drawing(row).size, 'byte')}"]
    if knee.quick is not None and row.round_seconds is not None:
        costs.append(f"milled round in {row.round_seconds:.1f} s")
    if row.ripple is not None:
        costs.append(f"ripple {100.0 * row.ripple:.2g} %")
    return f"{head}: {', '.join(costs)}; {_beyond(knee)}"


def _beyond(knee: Knee) -> str:
    """What a tighter tolerance costs, or why no tighter one is recommended."""
    if knee.end != "decimals":
        return BEYOND[knee.end]
    down = "" if knee.quick is None else f" are no slower down to {knee.quick:g} mm, but"
    return (
        f"tighter programs{down} need more decimals than {knee.row.decimals}, which the machine is"
        " not known to resolve"
    )


def _time(seconds: float) -> str:
    return f"{_digits(1e3 * seconds)} ms" if seconds < 1.0 else f"{_digits(seconds)} s"


def _digits(value: float) -> str:
    """The number with two significant digits, or all digits before the decimal point."""
    return f"{value:,.0f}" if abs(value) >= 9.95 else f"{value:.2g}"


def _drawing(row: ContourRow) -> FileCost:
    assert row.drawing is not None  # checked before
    return row.drawing


def _pieces(row: ContourRow) -> int:
    assert row.count is not None  # checked before
    return row.count.pieces


# -- enough ---------------------------------------------------------------------------------------
# Which tolerance is enough at one speed of the cam: beyond it, the cam runs no better.
#
# Of the measured contours of one form, the loosest is enough for which no tighter one changes any
# of three benefits by more than `SHARE` of the exact motion's figure: the deviation of the
# acceleration, that of the contact force, and the lift-off speed.


SHARE: Final = 0.05
"""Largest change of a benefit, relative to the exact motion, that counts as no improvement."""


@dataclass(frozen=True, slots=True)
class SufficientContour:
    """The contour that is enough.

    Attributes
    ----------
    row : the measurement of this contour.
    gain : largest share by which a tighter measured contour changes a benefit; 0 if none is
        tighter.
    last : whether it is the tightest one measured, so that a tighter one may still improve.
    """

    row: BenefitRow
    gain: float
    last: bool


def find_sufficient(rows: Sequence[BenefitRow]) -> SufficientContour | None:
    """The contour that is enough among `rows` of one form and speed; None if no row has values."""
    known = sorted(
        (row for row in rows if row.acceleration is not None),
        key=lambda row: row.tolerance,
        reverse=True,
    )
    for number, row in enumerate(known):
        gain = max((change(row, other) for other in known[number + 1 :]), default=0.0)
        if gain <= SHARE:
            return SufficientContour(row, gain, last=number == len(known) - 1)
    return None


def change(row: BenefitRow, other: BenefitRow) -> float:
    """The largest change of a benefit from one contour to another, relative to the exact motion."""
    figures = (
        (row.acceleration, other.acceleration, row.exact_acceleration),
        (row.force, other.force, row.exact_force),
        (row.lift_off_speed, other.lift_off_speed, row.exact_lift_off_speed),
    )
    changes = [
        abs(one - two) / exact
        for one, two, exact in figures
        if one is not None and two is not None and exact and math.isfinite(one + two + exact)
    ]
    return max(changes, default=0.0)


def sufficient_sentence(sufficient: SufficientContour | None) -> str:
    """Which tolerance is enough, and why, in words."""
    if sufficient is None:
        return "the motion on the written contour is not known for any of these tolerances"
    row = sufficient.row
    parts = [f"{row.form} within {row.tolerance:g} mm"]
    if row.ripple is not None:
        parts.append(f"the acceleration is off by up to {100.0 * row.ripple:.3g} % of its peak")
    if row.force is not None:
        parts.append(f"the contact force by up to {row.force:.3g} N")
    if sufficient.last:
        return f"{', '.join(parts)}; it still improves, and no tighter tolerance was tried"
    gain = f"{100.0 * sufficient.gain:.2g} %"
    return f"{', '.join(parts)}; tighter ones change none of its benefits by more than {gain}"
