"""The cures of the faults of a cam, or of a conjugate pair, by its dimensions and its motion."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_FLOOR, Decimal, localcontext
from functools import lru_cache, singledispatch
from itertools import chain
from typing import Any, Final

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.check.cures.search import (
    BEYOND,
    CONDITIONS,
    UNKNOWN,
    Condition,
    Conditions,
    Discs,
    Excess,
    KnobSearch,
    MarginCurve,
    holds,
)
from camgeo.check.finding import BROKEN, DIGITS, NO_OUTLINE, RETURN, Finding, rounded_beyond
from camgeo.errors import GeometryError, SceneError
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.together import LinkedMotions, Repeated
from camgeo.kinematics.laws import FAMILIES, build_law
from camgeo.kinematics.laws.law import Law, acceleration_jumps, characteristic
from camgeo.kinematics.mechanism.flat import flat_follower
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.motion import FULL_ORDER, Jet, Motion
from camgeo.kinematics.plan import EXACT, Dwell, MotionPlan, Move, Segment
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.units import MM_PER, LengthUnit, in_unit, listed

# -- cure -----------------------------------------------------------------------------------------


Value = float | Decimal | str
"""A length in the unit of the scene, an angle in degrees exactly as written, or the name of a
law."""


@dataclass(frozen=True, slots=True)
class KeyChange:
    """One key of the scene with another value.

    Attributes
    ----------
    key : path of the key in the scene, e.g. "motion[2].span".
    old_value, new_value : the present and the new value, in the unit of the scene or in degrees, or
        names of laws.
    """

    key: str
    old_value: Value
    new_value: Value


@dataclass(frozen=True, slots=True)
class Cure:
    """The nearest value of one knob at which a fault is gone, or the statement that there is none.

    Attributes
    ----------
    knob : "base radius", "roller radius", "offset", "arm", "longer segment" or "other law".
    key : path of its key in the scene.
    old_value : the present value, in `unit`; for a law its name.
    new_value : the value that cures: for a length the limit rounded to the side on which it cures,
        as the sentence has it; for a span the next millionth of a degree beyond the limit; for a
        law its name. None if the knob has no cure.
    unit : unit of both values: that of the scene for a length, "deg", or "".
    cost : relative change, referred to the base radius for an offset; for a law the relative
        increase of its peak acceleration, 0 if that does not grow. The largest one if several
        moves change. None if the knob has no cure.
    sentence : all of this in words.
    also : the other keys that change with it, e.g. the dwells beside a longer move.
    limit : for a length, the exact value [mm] at which the finding disappears.
    fault : the fault that it removes: "undercut", "radius ratio", "transmission angle" or
        "convexity".
    breaks : names of the findings that report limits which held, and which it breaks: empty unless
        the knob has no value that breaks none.
    """

    knob: str
    key: str
    old_value: Value
    new_value: Value | None
    unit: str
    cost: float | None
    sentence: str
    also: tuple[KeyChange, ...] = ()
    limit: float | None = None
    fault: str = ""
    breaks: tuple[str, ...] = ()

    @property
    def statement(self) -> str:
        """The sentence, preceded by the fault and by "no remedy" if the knob has none."""
        return f"{self.fault}: {'' if self.works else 'no remedy: '}{self.sentence}"

    @property
    def works(self) -> bool:
        """Whether the knob has a cure."""
        return self.new_value is not None


def length_cure(
    knob: str,
    key: str,
    old: float,
    length: CureLength | None,
    scale: float,
    none: str,
    unit: LengthUnit,
    bound: str = "",
) -> Cure:
    """The cure by the `length` of the follower at `key`, now `old` [mm], stated in `unit`.

    `bound` is "at least " or "at most " if all lengths beyond it cure as well. The cost is the
    change relative to `scale` [mm]. If `length` is None there is no cure, for the reason `none`.
    """
    present = old / MM_PER[unit]
    if length is None:
        return no_cure(knob, key, present, unit, none)
    cost = abs(length.limit - old) / scale
    sentence = (
        f"{knob} {bound}{length_text(length.stated)} {unit} instead of"
        f" {present:.{length.digits}g} {unit} ({key}, a change by {percent(cost)})"
    )
    return Cure(knob, key, present, length.stated, unit, cost, sentence, limit=length.limit)


def no_cure(knob: str, key: str, old: Value, unit: str, reason: str) -> Cure:
    """The statement that a knob has no cure, with the reason as a sentence."""
    return Cure(knob, key, old, None, unit, None, reason)


def length_text(value: float) -> str:
    """A rounded length as text, with the digits that it has and without an exponent."""
    return f"{Decimal(repr(value)).normalize():f}"


def percent(share: float) -> str:
    """A fraction in per cent, for a sentence."""
    return f"{100.0 * share:.3g} %"


# -- task -----------------------------------------------------------------------------------------
# What is to be cured: a fault of a design, the limits that held, and the verdict on changes.


Edits = Mapping[str, Value]
"""New values by key, in the unit of the scene or in degrees."""

Judge = Callable[[Discs, Edits], Excess]
"""Excess over limits of the changed discs that the edits make."""

CAUSES: Final = ("outline-", "curvature", "standstill")
"""Beginnings of the names of findings which leave it unknown whether there is undercut."""

NAMED: Final = 3
"""Most limits that a sentence names."""


@dataclass(frozen=True, slots=True, eq=False)
class CureTask:
    """A fault, and what a cure of it must not break.

    Attributes
    ----------
    fault : the fault in words, e.g. "undercut".
    condition : the condition that the fault breaks.
    held : the other conditions on places of the cam, which the design meets at present.
    discs : the discs as they are.
    unit : unit of lengths in sentences.
    already_broken : names of the limits that the design breaks at present.
    judged : returns the findings on the changed discs that the edits make, and those on their
        parts, which are looked at only if the discs break nothing; SceneError or GeometryError if
        the edits make no discs.
    """

    fault: str
    condition: Condition
    held: Conditions
    discs: Discs
    unit: LengthUnit
    already_broken: frozenset[str]
    judged: Callable[[Discs, Edits], tuple[Iterable[Finding], Iterable[Finding]]]

    @property
    def stages(self) -> Iterator[tuple[Conditions, Judge]]:
        """Conditions and verdicts of the search for a cure: at first it must break no other limit;
        if there is no such cure, it need only cure.
        """
        least = (self.condition, *(condition for condition in self.held if condition.vital))
        yield (self.condition, *self.held), self.breaking
        yield least, self.failing

    def breaking(self, discs: Discs, edits: Edits) -> Excess:
        """By how much a change exceeds the limits that held; see `failing` if it does not cure."""
        failing = self.failing(discs, edits)
        if not holds(failing):
            return failing
        on_discs, on_parts = self.judged(discs, edits)
        excess = self._excess(on_discs)
        return {**excess, **self._excess(on_parts)} if holds(excess) else excess

    def failing(self, discs: Discs, edits: Edits) -> Excess:
        """An unknown excess if a change does not cure, or leaves no disc; empty if it cures."""
        try:
            broken = [
                finding for finding in self.judged(discs, edits)[0] if finding.severity in BROKEN
            ]
        except (GeometryError, SceneError):
            return UNKNOWN
        fault = (*self.condition.names, *CAUSES)
        uncured = (finding.name.removeprefix(f"{RETURN}: ").startswith(fault) for finding in broken)
        new = (finding for finding in broken if finding.name not in self.already_broken)
        fatal = any(finding.severity in NO_OUTLINE for finding in new)
        return UNKNOWN if fatal or any(uncured) else {}

    def _excess(self, findings: Iterable[Finding]) -> Excess:
        """The excess of each finding that has a limit or breaks one that held: negative where the
        limit holds, so that the search can interpolate between both.
        """
        excess: dict[str, float] = {}
        for finding in findings:
            broken, beyond = finding.severity in BROKEN, math.inf
            if finding.value is not None and finding.limit is not None:
                beyond = abs(finding.value - finding.limit)
            if finding.name not in self.already_broken and (broken or beyond < math.inf):
                beyond = beyond if broken else -beyond
                excess[finding.name] = max(beyond, excess.get(finding.name, beyond))
        return excess

    def finished(self, cure: Cure, discs: Discs | None = None) -> Cure:
        """The cure with its fault, and with the limits that the `discs` that it makes break."""
        cure = replace(cure, fault=self.fault)
        every = () if discs is None else chain(*self.judged(discs, cure_edits(cure)))
        broken = [finding for finding in every if finding.severity in BROKEN]
        if not broken:
            return cure
        new = [finding for finding in broken if finding.name not in self.already_broken]
        old = dict.fromkeys(
            finding.name for finding in broken if finding.name in self.already_broken
        )
        words = (
            [f"breaks {listed([_stated(finding, self.unit) for finding in new], NAMED)}"]
            if new
            else []
        )
        words += [f"leaves {listed([*old], NAMED)} broken"] if old else []
        names = tuple(dict.fromkeys(finding.name for finding in new))
        return replace(cure, breaks=names, sentence=f"{cure.sentence}, but {' and '.join(words)}")


def _stated(finding: Finding, unit: LengthUnit) -> str:
    """A broken limit as text, with value and limit if it has both."""
    if finding.value is None or finding.limit is None:
        return f"{finding.name} ({finding.sentence})"
    value, limit = (
        f"{number:.4g} {finding.unit}".rstrip() for number in (finding.value, finding.limit)
    )
    return in_unit(f"{finding.name} ({value}, limit {limit})", unit, (finding.value, finding.limit))


def cure_edits(cure: Cure) -> dict[str, Value]:
    """The values that a working cure writes into the scene, by their keys."""
    assert cure.new_value is not None
    changes = (KeyChange(cure.key, cure.old_value, cure.new_value), *cure.also)
    return {change.key: change.new_value for change in changes}


# -- sizes ----------------------------------------------------------------------------------------
# Cures by one dimension of the follower: base radius, roller radius, offset or arm.


CHANGE_DIGITS = 3
"""Significant digits of a change that the lengths before and after it must show."""

MOST_DIGITS = 17
"""Significant digits that tell any two doubles apart."""


@dataclass(frozen=True, slots=True)
class CureLength:
    """A length that cures, and how messages show it.

    Attributes
    ----------
    limit : the length beyond which lengths cure [mm].
    stated : a length beyond the limit with few digits, which cures, in the unit of the scene.
    value : the stated length [mm].
    digits : number of significant digits that show the change to it.
    """

    limit: float
    stated: float
    value: float
    digits: int


def digits_for(old: float, new: float) -> int:
    """Significant digits that show the change from `old` to `new`."""
    change, size = abs(new - old), max(abs(old), abs(new))
    if change == 0.0:
        return DIGITS
    # The digits before the first one that changes, and those of the change itself.
    return min(max(DIGITS, CHANGE_DIGITS + math.ceil(math.log10(size / change))), MOST_DIGITS)


@dataclass(frozen=True, slots=True, eq=False)
class SizeKnob:
    """A dimension of the follower as a `Knob` of the search.

    Attributes
    ----------
    start, scale : present value, and the length with which a change is compared [mm].
    make : returns the discs with another value.
    """

    start: float
    scale: float
    make: Callable[[float], Discs]

    def worst(self, value: float, conditions: Conditions) -> MarginCurve | None:
        """See `Knob`."""
        breach = self.make(value).worst_place(conditions)
        if breach is None:
            return None
        condition, number, phi = breach

        def cam(other: float) -> Cam | None:
            try:
                return self.make(other)[number]
            except GeometryError:
                return None

        def along(values: FloatArray) -> FloatArray:
            return condition.cam_margins([cam(size) for size in values.tolist()], phi)

        return along

    def nearest(
        self,
        low: float,
        high: float,
        conditions: Conditions,
        judged: Callable[[float], Excess],
        unit: LengthUnit,
    ) -> CureLength | None:
        """The nearest length between `low` and `high` [mm] for which `judged` finds no excess.

        None if there is none, or none that 17 digits tell apart from its limit.
        """
        mm = MM_PER[unit]

        def rounded(value: float) -> float:
            upward = value > self.start
            digits = digits_for(self.start, value)
            return mm * float(rounded_beyond(value / mm, digits, upward=upward))

        larger = KnobSearch(self, max(high, self.start), conditions, judged, rounded).nearest()
        # A smaller length is of interest only if the change is less than that to the larger one.
        if larger is not None:
            low = max(low, self.start - (larger - self.start))
        way = KnobSearch(self, min(low, self.start), conditions, judged, rounded)
        smaller = way.nearest()
        limit = larger if smaller is None else smaller
        if limit is None:
            return None
        # The fewest digits that show the change and cure: rounding beyond the limit may leave the
        # window in which the design holds, and then more digits stay closer to the limit.
        for digits in range(digits_for(self.start, limit), MOST_DIGITS + 1):
            for steps in (0, 1):  # a rounded length may be the limit itself
                beyond = rounded_beyond(limit / mm, digits, upward=smaller is None, steps=steps)
                value = mm * float(beyond)
                if way.keeps(value) and holds(judged(value)):
                    return CureLength(limit, float(beyond), value, digits)
        return None


LARGEST_BASE: Final = 100.0
"""Largest base radius that is tried, as a multiple of the present one."""

KNOWN: Final = 64
"""Number of latest values of a size whose discs are cached, as conditions and checks share what has
been computed for them."""

INSIDE: Final = 1e-6
"""Fraction of the base radius by which an offset, arm or base radius stays clear of the value at
which the mechanism locks or is stretched out, or the roller covers the cam axis."""

TABLES: Final = ("follower", "follower.return")
"""The scene's table of each disc's roller."""


def base_radius(task: CureTask) -> Cure:
    """Cure by another base radius; an oscillating follower keeps its pivot and arm.

    The return roller of a pair moves with the main one.
    """
    main = task.discs[0]
    old = main.follower.base_radius
    high = min(LARGEST_BASE * old, max(main.follower.farthest * (1.0 - INSIDE), old))
    low = _knob(main.follower)[-1] + INSIDE * old
    if main.contact.runs_inside:
        low = max(low, main.disc.flank_distance * (1.0 + INSIDE))
    return _other(task, "base radius", 0, (min(low, old), high), old)


def offset_or_arm(task: CureTask) -> Cure:
    """Cure by another offset |e| < r_G of a guide, or another arm of a rocker with the same pivot
    and r_G.

    If the return disc of a pair alone is at fault, the dimension of the return roller changes.
    """
    number = 1 if len(task.discs) > 1 and _is_faultless(task, Discs(task.discs[:1])) else 0
    knob, low, high, scale, _ = _knob(task.discs[number].follower)
    return _other(task, knob, number, (low, high), scale)


def _other(
    task: CureTask, knob: str, number: int, bounds: tuple[float, float], scale: float
) -> Cure:
    """Cure by another value of one dimension, in whichever direction the change is smaller."""
    field = knob.replace(" ", "_")
    key, old = f"{TABLES[number]}.{field}", float(getattr(task.discs[number].follower, field))
    mm = MM_PER[task.unit]

    @lru_cache(KNOWN)
    def resized(value: float) -> Discs:
        # The same double as the scene makes of the edit, so that the discs are the same too.
        return task.discs.sized(number, **{field: mm * (value / mm)})

    size = SizeKnob(old, scale, resized)
    length = _nearest_length(task, size, bounds, lambda value: {key: value / mm})
    ends = f"{bounds[0] / mm:.6g} and {bounds[1] / mm:.6g} {task.unit}"
    none = f"no other {knob} between {ends} removes it"
    cure = length_cure(knob, key, old, length, scale, none, task.unit)
    return task.finished(cure, None if length is None else resized(length.value))


def _nearest_length(
    task: CureTask, size: SizeKnob, bounds: tuple[float, float], edits: Callable[[float], Edits]
) -> CureLength | None:
    for conditions, verdict in task.stages:

        def judged(value: float, verdict: Judge = verdict) -> Excess:
            return verdict(size.make(value), edits(value))

        length = size.nearest(*bounds, conditions, judged, task.unit)
        if length is not None:
            return length
    return None


def roller_radius(task: CureTask) -> Cure:
    """Cure by a smaller roller: its radius must be at most the smallest r_K that matters (Wirsig
    eq. 3.36), or r_K - c/2 in a groove with side clearance c, which is kept.

    If the flank of that roller still crosses itself, the search goes on to smaller rollers. Of a
    pair each roller becomes smaller that needs to be.
    """
    discs, cures = task.discs, list[Cure]()
    for number in reversed(range(len(discs))):  # the return roller may have the main one's size
        if len(discs) > 1 and _is_faultless(task, Discs([discs[number]])):
            continue
        key, old = f"{TABLES[number]}.roller_radius", discs[number].follower.roller_radius
        length = _smaller_roller(task, discs, number, key)
        none = (
            f"no smaller roller radius removes it ({key}){_no_roller_reason(task, discs[number])}"
        )
        cure = length_cure("roller radius", key, old, length, old, none, task.unit, "at most ")
        if length is None:
            return task.finished(cure)
        cures.append(cure)
        discs = discs.sized(number, roller_radius=length.value)
    return _joint_cure(task, cures, discs)


def _smaller_roller(task: CureTask, discs: Discs, number: int, key: str) -> CureLength | None:
    """The roller radius that cures one disc, whatever the state of the other disc of a pair."""
    old, mm = discs[number].follower.roller_radius, MM_PER[task.unit]
    size = SizeKnob(
        old, old, lambda value: Discs([discs.sized(number, roller_radius=value)[number]])
    )
    low = BEYOND * old
    if len(discs) == 1:
        return _nearest_length(task, size, (low, old), lambda value: {key: value / mm})
    conditions = (task.condition,)

    def judged(value: float) -> Excess:
        return UNKNOWN if _crosses(size.make(value)) else {}

    return size.nearest(low, old, conditions, judged, task.unit)


def _no_roller_reason(task: CureTask, cam: Cam) -> str:
    """Why no roller at all fits a disc, as the end of a sentence; empty if there is no reason."""
    if cam.follower.roller_radius == 0.0:
        return ": a knife edge has no roller to make smaller"
    bends = curvature_extremes(cam.disc.pitch_curve)
    extremes = bends.smallest()[0], bends.largest()[0]
    # The largest curvature that matters for a flank in use, at either extreme.
    kappa = max(-flank.sign * curvature for flank in cam.contact.flanks for curvature in extremes)
    if kappa <= 0.0:
        return ""
    mm = MM_PER[task.unit]
    play, radius = cam.clearance / mm, 1.0 / (kappa * mm)
    play_text = f", beside a play of {play:.6g} {task.unit}" if play > 0.0 else ""
    return f": the smallest radius of curvature is {radius:.3g} {task.unit}{play_text}"


def _is_faultless(task: CureTask, discs: Discs) -> bool:
    """Whether these discs do not have the fault."""
    try:
        crosses = task.condition.vital and _crosses(discs)
        return not crosses and discs.worst_place((task.condition,)) is None
    except GeometryError:
        return False


def _crosses(discs: Discs) -> bool:
    try:
        return bool(discs.crossings())
    except GeometryError:  # it cannot be decided
        return True


def _joint_cure(task: CureTask, cures: list[Cure], discs: Discs) -> Cure:
    """The cures of all discs as one, led by the most costly one; no cure unless it cures both."""
    leading = max(cures, key=lambda cure: cure.cost or 0.0)
    others = [cure for cure in cures if cure is not leading]
    sentence = " and ".join(cure.sentence for cure in (leading, *others))
    also = tuple(KeyChange(cure.key, cure.old_value, cure.new_value or 0.0) for cure in others)
    cure = replace(leading, sentence=sentence, also=also)
    if not holds(task.failing(discs, cure_edits(cure))):
        reason = "no smaller roller radii cure both discs"
        none = no_cure(leading.knob, leading.key, leading.old_value, leading.unit, reason)
        return task.finished(none)
    return task.finished(cure, discs)


def raised_face(task: CureTask) -> Cure:
    """Cure by the least base radius, on a rocker with as much more face offset, without undercut.

    A face moved out by D makes the parallel outline, all of whose radii are larger by D.
    """
    (cam,) = task.discs
    follower = flat_follower(cam.follower)
    old, mm = follower.base_radius, MM_PER[task.unit]
    present = {key: getattr(follower, _field(key)) / mm for key in follower.raising_keys}

    def raised(value: float) -> dict[str, float]:
        """The lengths that go with the base radius `value` [mm], in the unit and by their keys."""
        # In decimals as they are written, so that sums have no digits from rounding.
        more = Decimal(repr(value / mm)) - Decimal(repr(old / mm))
        return {key: float(Decimal(repr(length)) + more) for key, length in present.items()}

    def raised_discs(value: float) -> Discs:
        sizes = {_field(key): mm * length for key, length in raised(value).items()}
        return task.discs.sized(0, **sizes)

    length = _nearest_length(
        task, SizeKnob(old, old, raised_discs), (old, LARGEST_BASE * old), raised
    )
    first, *others = follower.raising_keys
    none = f"no larger {' and '.join(follower.raising_keys)} removes it"
    cure = length_cure("base radius", first, old, length, old, none, task.unit, "at least ")
    if length is None:
        return task.finished(cure)
    if others:
        lengths = raised(length.value)
        also = tuple(KeyChange(key, present[key], lengths[key]) for key in others)
        lengths_text = " and ".join(
            f"{key} {length_text(lengths[key])} {task.unit}" for key in others
        )
        cure = replace(cure, sentence=f"{cure.sentence}, with {lengths_text}", also=also)
    return task.finished(cure, raised_discs(length.value))


def _field(key: str) -> str:
    """The name of the follower's field that a key of the scene sets."""
    return key.removeprefix("follower.")


@singledispatch
def _knob(follower: Any) -> tuple[str, float, float, float, float]:
    """Name of the dimension to change besides the radii, its lower and upper bound, the length with
    which its change is compared, and the least base radius of a mechanism, all in mm.
    """
    raise TypeError(type(follower))


@_knob.register
def _(follower: TranslatingRoller) -> tuple[str, float, float, float, float]:
    high = (1.0 - INSIDE) * follower.base_radius
    return "offset", -high, high, follower.base_radius, abs(follower.offset)


@_knob.register
def _(follower: OscillatingRoller) -> tuple[str, float, float, float, float]:
    distance, base = follower.centre_distance, follower.base_radius
    low, high = abs(distance - base) + INSIDE * base, (distance + base) - INSIDE * base
    return "arm", low, high, follower.arm, abs(follower.excess)


# -- moves -----------------------------------------------------------------------------------------
# Moves whose span or law may change so that they still join, and how a scene names them.


def joins_neighbours(plan: MotionPlan, number: int, law: Law) -> bool:
    """Whether `law` can go from rest to rest in place of a segment and join its neighbours.

    Its velocity must be 0 at both ends, and at an end that is next to no dwell its acceleration
    too.
    """
    sides = zip((law.start, law.end), adjacent_dwells(plan, number), strict=True)
    return all(
        end.velocity == 0.0 and (end.acceleration == 0.0 or bool(dwells)) for end, dwells in sides
    )


def adjacent_dwells(plan: MotionPlan, number: int) -> tuple[list[int], list[int]]:
    """Indices of the dwells adjacent to a segment, before and after it, the nearest first.

    The plan closes after a turn. Dwells of length zero are skipped.
    """

    def run(step: int) -> list[int]:
        segments, dwells = plan.segments, []
        for away in range(1, len(segments)):
            place = (number + step * away) % len(segments)
            if not isinstance(segments[place], Dwell):
                break
            if segments[place].span:
                dwells.append(place)
        return dwells

    return run(-1), run(1)


def dwells_around(plan: MotionPlan, number: int) -> tuple[int, ...]:
    """Indices of the dwells adjacent to a segment on either side, each of them once."""
    preceding, following = adjacent_dwells(plan, number)
    return tuple(dict.fromkeys(preceding + following))


def segment_key(number: int, segment: Segment, what: str) -> str:
    """The scene's key of a segment, e.g. "motion[2].span"; for a dwell the key of its length."""
    return f"motion[{number + 1}].{'dwell' if isinstance(segment, Dwell) else what}"


def degrees(value: Value) -> str:
    """An angle as a scene would write it, for a sentence."""
    return f"{Decimal(value).normalize():f}" if value else "0"


# -- laws -----------------------------------------------------------------------------------------
# Cure by another law for the moves at fault, with sizes and spans unchanged.


OTHER_LAW = "other law"
"""Name of the knob."""

TASK = "R-R"
"""Motion task of the laws from rest to rest, the only ones that are exchanged."""


@dataclass(frozen=True, slots=True)
class Offer:
    """A law that could replace another, and what that would cost.

    Attributes
    ----------
    law : the law, with its default parameters.
    growth : relative increase of the peak acceleration; 0 if it does not grow.
    """

    law: Law
    growth: float


def other_law(task: CureTask) -> Cure:
    """Cure by laws of other families, with default parameters, for the moves at fault.

    These must go from rest to rest. Among the laws that cure, the one is chosen whose peak
    acceleration grows least; a law whose acceleration jumps only replaces one whose acceleration
    jumps too. Each move gets its own law; if the flank then crosses itself, all get the same.
    """
    discs = task.discs
    plan, places = discs.plan, discs.faulty_segments(task.condition)
    for number in places:
        move = plan.segments[number]
        if not (
            isinstance(move, Move) and move.law.task == TASK and _has_rest_ends(plan, number, move)
        ):
            key = segment_key(number, move, "law")
            reason = f"another law: {key} is at fault and is not a law from rest to rest"
            present = move.law.name if isinstance(move, Move) else ""
            return task.finished(no_cure(OTHER_LAW, key, present, "", reason))
    number = places[0]
    for conditions, verdict in task.stages:
        fitting = _fitting(discs, places, conditions)
        number = next((index for index, offers in fitting.items() if not offers), number)
        if not all(fitting.values()):
            continue
        first = {number: offers[0] for number, offers in fitting.items()}
        # The cheapest law for each move; if that does not do, as where flanks cross, one for all.
        for offers in (first, *_same_for_all(fitting)):
            cure, changed = _laws_cure(plan, offers), _discs_with_laws(discs, offers)
            if holds(verdict(changed, cure_edits(cure))):
                return task.finished(cure, changed)
    move = _move(plan, number)
    key = segment_key(number, move, "law")
    reason = f"no other {key} removes it at these sizes"
    return task.finished(no_cure(OTHER_LAW, key, move.law.name, "", reason))


def offers_for(plan: MotionPlan, number: int) -> list[Offer]:
    """The laws from rest to rest that could take the place of that of a move, cheapest first."""
    present, offers = _move(plan, number).law, []
    jerky, peak = _jerks(present), _peak(present)
    for family in FAMILIES.values():
        if TASK not in family.tasks:
            continue
        law = build_law(family.name, TASK, {})
        same = law.name == present.name and law.parameters == present.parameters
        jerks = _jerks(law)
        if not same and (jerky or not jerks) and joins_neighbours(plan, number, law):
            offers.append((Offer(law, max(0.0, _peak(law) / peak - 1.0)), jerks))
    return [offer for offer, _ in sorted(offers, key=lambda pair: (pair[0].growth, pair[1]))]


def _fitting(discs: Discs, places: Sequence[int], conditions: Conditions) -> dict[int, list[Offer]]:
    """For each move the offers that keep the conditions over it, the cheapest first.

    Over a move the conditions depend on its own law alone, so a law is tried in all places at once.
    """
    offers = {number: offers_for(discs.plan, number) for number in places}
    fit: set[tuple[int, str]] = set()
    for name in {offer.law.name for every in offers.values() for offer in every}:
        tried = {
            n: offer for n, every in offers.items() for offer in every if offer.law.name == name
        }
        fit |= {(number, name) for number in _fit(discs, tried, conditions)}
    return {
        number: [offer for offer in every if (number, offer.law.name) in fit]
        for number, every in offers.items()
    }


def _fit(discs: Discs, offers: Mapping[int, Offer], conditions: Conditions) -> list[int]:
    """Indices of the moves that keep the conditions with the laws of the `offers`."""
    changed = _discs_with_laws(discs, offers)
    try:
        return [n for n in offers if changed.worst_place(conditions, n) is None]
    except GeometryError:  # which may be for one of them alone
        if len(offers) == 1:
            return []
        singles = ({number: offer} for number, offer in offers.items())
        return [number for single in singles for number in _fit(discs, single, conditions)]


def _same_for_all(fitting: Mapping[int, list[Offer]]) -> list[dict[int, Offer]]:
    """Offers of one law to all moves, for each law that fits all of them, the cheapest first."""
    by_name = [{offer.law.name: offer for offer in offers} for offers in fitting.values()]
    names = [name for name in by_name[0] if all(name in offers for offers in by_name)]
    every = [
        {number: offers[name] for number, offers in zip(fitting, by_name, strict=True)}
        for name in names
    ]
    return sorted(every, key=lambda offers: max(offer.growth for offer in offers.values()))


def _discs_with_laws(discs: Discs, offers: Mapping[int, Offer]) -> Discs:
    segments = list(discs.plan.segments)
    for number, offer in offers.items():
        segments[number] = replace(_move(discs.plan, number), law=offer.law)
    return discs.moved(MotionPlan(tuple(segments)))


def _has_rest_ends(plan: MotionPlan, number: int, move: Move) -> bool:
    """Whether another law from rest to rest can replace that of the move: at both ends it must be
    next to a dwell, or start or end with zero velocity and acceleration.
    """
    sides = zip((move.law.start, move.law.end), adjacent_dwells(plan, number), strict=True)
    return all(dwells or end.velocity == end.acceleration == 0.0 for end, dwells in sides)


def _move(plan: MotionPlan, number: int) -> Move:
    """The segment of an index that is known to be a move."""
    move = plan.segments[number]
    assert isinstance(move, Move)
    return move


def _peak(law: Law) -> float:
    """Largest magnitude of f''; infinite for a law that starts or ends with a shock."""
    if law.start.velocity or law.end.velocity:
        return math.inf
    values = characteristic(law)
    return max(abs(values.largest_acceleration.value), abs(values.least_acceleration.value))


def _jerks(law: Law) -> bool:
    """Whether the acceleration of a law jumps anywhere if it goes from rest to rest."""
    ends = (law.start, law.end)
    return any(end.velocity or end.acceleration for end in ends) or bool(acceleration_jumps(law))


def _laws_cure(plan: MotionPlan, offers: Mapping[int, Offer]) -> Cure:
    changes = {}
    for number, offer in offers.items():
        move = _move(plan, number)
        changes[number] = KeyChange(segment_key(number, move, "law"), move.law.name, offer.law.name)
    leading = max(offers, key=lambda number: offers[number].growth)
    cost, first = offers[leading].growth, changes[leading]
    named = " and ".join(
        f'{change.key} "{change.new_value}" instead of "{change.old_value}"'
        for change in changes.values()
    )
    grows = f"grows by {percent(cost)}" if cost > 0.0 else "does not grow"
    sentence = f"{named}, with default parameters (the peak of the acceleration {grows})"
    also = tuple(change for number, change in changes.items() if number != leading)
    return Cure(OTHER_LAW, first.key, first.old_value, first.new_value, "", cost, sentence, also)


# -- spans ----------------------------------------------------------------------------------------
# Cure by longer segments: moves at fault take cam angle from the dwells next to them.


LONGER_SEGMENT: Final = "longer segment"

STEP: Final = Decimal("0.000001")
"""Spans are rounded to millionths of a degree, to the next one beyond the limit."""

MOST: Final = 1e-6
"""Accuracy, as a fraction, to which the largest growth is bisected for which the dwells have
room."""


@dataclass(frozen=True, slots=True, eq=False)
class StretchedMotion(Repeated):
    """A motion at one cam angle, for n other spans of the move there.

    Attributes
    ----------
    growth : (n,) ratio of each span to the present one.
    """

    growth: FloatArray

    def jet(self, phi: FloatArray, side: Side = "right", order: int = FULL_ORDER) -> Jet:
        """See `Motion.jet`: the k-th derivative is divided by the k-th power of the growth."""
        derivatives = self.motion.jet(phi, side, order)
        return np.asarray(derivatives / self.growth ** np.arange(len(derivatives))[:, np.newaxis])


@dataclass(frozen=True, slots=True, eq=False)
class SpanKnob:
    """The span of a move [deg] as a `Knob` of the search, in a motion of that move alone.

    The curvature and the transmission angle over a move depend on its own span only.

    Attributes
    ----------
    discs : the discs, with the whole motion.
    number : index of the move in the plan.
    """

    discs: Discs
    number: int

    @property
    def start(self) -> float:
        """See `Knob`."""
        return float(self.discs.plan.segments[self.number].span)

    @property
    def scale(self) -> float:
        """See `Knob`."""
        return self.start

    def make(self, value: float) -> Discs:
        """See `Knob`: auxiliary moves lead to the start of the move, and back to position 0."""
        plan = self.discs.plan
        move = plan.segments[self.number]
        assert isinstance(move, Move)
        positions = [
            segment.to for segment in plan.segments[: self.number] if not isinstance(segment, Dwell)
        ]
        first = positions[-1] if positions else 0.0
        with localcontext(EXACT):
            span = Decimal(value)
            # Half of the rest leads to the position where the move starts, half of it back to 0.
            rest = (360 - span) / 2
            there = Move(rest, first, move.law) if first else Dwell(rest)
            back = Move(rest, 0.0, move.law) if move.to else Dwell(rest)
        return self.discs.moved(MotionPlan((there, replace(move, span=span), back)))

    def worst(self, value: float, conditions: Conditions) -> MarginCurve | None:
        """See `Knob`."""
        discs = self.make(value)
        breach = discs.worst_place(conditions, 1)
        if breach is None:
            return None
        condition, number, phi = breach
        cam = discs[number]
        curve = cam.disc.pitch_curve

        def along(values: FloatArray) -> FloatArray:
            motion: Motion
            if isinstance(curve.motion, LinkedMotion):
                demanded = StretchedMotion(curve.motion.demanded, 1, values / value)
                motion = LinkedMotions(demanded, curve.motion.linkage)
            else:
                motion = StretchedMotion(curve.motion, 1, values / value)
            other = replace(curve, motion=motion)
            return condition.place_margins(other, (cam,), phi, len(values))

        return along


@dataclass(frozen=True, slots=True, eq=False)
class GrowthKnob:
    """The common growth of several moves, a factor less 1, as a `Knob` of the search.

    Attributes
    ----------
    discs : the discs as they are.
    spans : spans of the moves at growth 0, by their indices in the plan.
    """

    discs: Discs
    spans: Mapping[int, Decimal]
    start: float = 0.0
    scale: float = 1.0

    def plan(self, growth: float, *, rounded: bool = True) -> MotionPlan | None:
        """The plan with longer moves, their spans rounded up; None if the dwells are too short."""
        with localcontext(EXACT):
            factor = 1 + Decimal(growth)
            spans = {number: span * factor for number, span in self.spans.items()}
        if rounded:
            spans = {number: _next_step(span) for number, span in spans.items()}
        return longer_plan(self.discs.plan, spans)

    def make(self, value: float) -> Discs:
        """See `Knob`."""
        longer = self.plan(value, rounded=False)
        if longer is None:
            raise GeometryError("the dwells are too short", key="motion")
        return self.discs.moved(longer)

    def worst(self, value: float, conditions: Conditions) -> None:
        """See `Knob`: longer moves hardly break a condition, so no margin is given."""
        if self.make(value).worst_place(conditions) is not None:
            raise GeometryError("these moves are too short", key="motion")

    @property
    def most(self) -> float:
        """The largest growth for which the dwells have room, to the accuracy `MOST`."""
        # At the upper bound the shortest move alone would take more than the turn.
        most, too_much = 0.0, float(360 / min(self.spans.values()))
        while too_much - most > MOST * max(1.0, most):
            middle = 0.5 * (most + too_much)
            most, too_much = (most, middle) if self.plan(middle) is None else (middle, too_much)
        return most


def longer_segment(task: CureTask) -> Cure:
    """Cure by longer spans of the moves at fault, at the expense of the dwells next to them.

    Each move has its own limit. Against global undercut all of them grow by one factor. A move
    takes from the dwells before and after it in proportion to their length.
    """
    discs = task.discs
    plan, places = discs.plan, discs.faulty_segments(task.condition)
    for number in places:
        segment = plan.segments[number]
        if not (isinstance(segment, Move) and joins_neighbours(plan, number, segment.law)):
            key = segment_key(number, segment, "span")
            reason = f"the span of a segment: {key} is at fault and is not a move from rest to rest"
            return task.finished(no_cure(LONGER_SEGMENT, key, segment.span, "deg", reason))
    for conditions, verdict in task.stages:
        longer = _longer(task, places, conditions, verdict)
        if longer is not None:
            return task.finished(_spans_cure(plan, longer, places), discs.moved(longer))
    number = places[0]
    segment = plan.segments[number]
    key = segment_key(number, segment, "span")
    reason = f"no longer {key} removes it: the dwells next to it leave too little room"
    return task.finished(no_cure(LONGER_SEGMENT, key, segment.span, "deg", reason))


def _longer(
    task: CureTask,
    places: Sequence[int],
    conditions: Conditions,
    verdict: Judge,
) -> MotionPlan | None:
    """The plan with moves that are long enough to cure; None if there is no room for them."""
    discs, plan = task.discs, task.discs.plan

    def judged(longer: MotionPlan | None) -> Excess:
        if longer is None or longer == plan:
            return UNKNOWN
        return verdict(discs.moved(longer), cure_edits(_spans_cure(plan, longer, places)))

    spans = _least_spans(discs, places, conditions)
    longer = None if spans is None else longer_plan(plan, spans)
    if spans is None or longer is None:
        return None
    if holds(judged(longer)):
        return longer
    # Each move alone is long enough, but not all of them together.
    growth = GrowthKnob(discs, spans)
    way = KnobSearch(growth, growth.most, conditions, lambda value: judged(growth.plan(value)))
    limit = way.nearest()
    longer = None if limit is None else growth.plan(limit)
    return longer if holds(judged(longer)) else None


def _least_spans(
    discs: Discs, places: Sequence[int], conditions: Conditions
) -> dict[int, Decimal] | None:
    """The least span of each move that keeps the conditions; None if the dwells next to one of them
    are too short.
    """
    plan = discs.plan
    spans: dict[int, Decimal] = {}
    for number in places:
        present = plan.segments[number].span
        dwells = (plan.segments[place].span for place in dwells_around(plan, number))
        most = sum(dwells, present)
        knob = SpanKnob(discs, number)
        limit = KnobSearch(knob, float(most), conditions, lambda _: {}).nearest()
        if limit is None:
            return None
        spans[number] = present if limit == float(present) else _next_step(Decimal(limit))
        if spans[number] > most:
            return None
    return spans


def longer_plan(plan: MotionPlan, spans: Mapping[int, Decimal]) -> MotionPlan | None:
    """The plan with other spans of the moves at some indices; None if the dwells are too short.

    A move first takes from dwells that are next to none of the other moves.
    """
    segments = list(plan.segments)
    dwells = {number: dwells_around(plan, number) for number in spans}
    users = Counter(place for places in dwells.values() for place in places)
    with localcontext(EXACT):
        rests = {place: segments[place].span for place in users}
        for number, span in spans.items():
            missing = span - segments[number].span
            # Dwells between two of the moves are left for what no other dwell can give.
            for shared in (False, True):
                among = [place for place in dwells[number] if (users[place] > 1) == shared]
                missing = _take(rests, among, missing)
            if missing > 0:
                return None
            segments[number] = replace(segments[number], span=span)
    for place, rest in rests.items():
        segments[place] = replace(segments[place], span=rest)
    return MotionPlan(tuple(segments))


def _take(rests: dict[int, Decimal], among: list[int], wanted: Decimal) -> Decimal:
    """Take `wanted` degrees from the dwells `among` in proportion to their length, and return how
    many degrees are lacking.
    """
    there = sum((rests[place] for place in among), Decimal(0))
    part = min(wanted, there)
    if part <= 0:
        return wanted
    left = part
    # Shares are rounded down to whole steps, so that together they never exceed the part.
    for place in among:
        share = (rests[place] * part / there).quantize(STEP, rounding=ROUND_FLOOR)
        share = min(share, rests[place], left)
        rests[place] -= share
        left -= share
    for place in among:  # what the rounding left over
        share = min(left, rests[place])
        rests[place] -= share
        left -= share
    return wanted - part


def _next_step(span: Decimal) -> Decimal:
    """The next multiple of `STEP` above a span [deg], which is beyond the limit for certain."""
    with localcontext(EXACT):
        return span.quantize(STEP, rounding=ROUND_FLOOR) + STEP


def _spans_cure(old: MotionPlan, new: MotionPlan, places: Sequence[int]) -> Cure:
    changes = {
        number: KeyChange(
            segment_key(number, old_segment, "span"), old_segment.span, new_segment.span
        )
        for number, (old_segment, new_segment) in enumerate(
            zip(old.segments, new.segments, strict=True)
        )
        if old_segment.span != new_segment.span
    }
    shares = {
        number: float(new.segments[number].span / old.segments[number].span - 1)
        for number in places
    }
    # The move that grows most states the cost, and its key is the cure's.
    leading = max(shares, key=shares.__getitem__)
    also = [changes[number] for number in places if number != leading and number in changes]
    dwells = [change for number, change in changes.items() if number not in places]
    moves_text = " and ".join(
        _change_text(changes[number]) for number in places if number in changes
    )
    dwells_text = " and ".join(_change_text(change) for change in dwells)
    cost, first = shares[leading], changes[leading]
    sentence = f"longer: {moves_text} (a change by {percent(cost)}), taken from {dwells_text}"
    others = (*also, *dwells)
    return Cure(
        LONGER_SEGMENT, first.key, first.old_value, first.new_value, "deg", cost, sentence, others
    )


def _change_text(change: KeyChange) -> str:
    return f"{change.key} {degrees(change.new_value)} deg instead of {degrees(change.old_value)}"


# -- remedies -------------------------------------------------------------------------------------


MOTION_KNOBS: Final = (longer_segment, other_law)

KNOBS: Final = {
    ("roller", "undercut"): (base_radius, roller_radius, offset_or_arm, *MOTION_KNOBS),
    ("roller", "radius ratio"): (base_radius, roller_radius, offset_or_arm, *MOTION_KNOBS),
    ("roller", "transmission angle"): (base_radius, offset_or_arm, *MOTION_KNOBS),
    ("face", "convexity"): (raised_face,),
    ("face", "transmission angle"): MOTION_KNOBS,
}
"""The cures that are tried, by what touches the cam and by the fault."""


def remedies(
    cams: Iterable[Cam],
    angle: float,
    ratio: float,
    findings: Iterable[Finding],
    unit: LengthUnit,
    judged: Callable[[Discs, Edits], tuple[Iterable[Finding], Iterable[Finding]]],
) -> tuple[Cure, ...]:
    """The nearest cure of each fault by each knob, with all others unchanged.

    They are ordered fault by fault, the cheapest first; knobs without a cure come last and say why.
    Lengths are rounded in `unit`. Empty if there is nothing to cure, or if there is no mechanism.

    Parameters
    ----------
    angle, ratio : the least transmission angle [rad] and the largest r_R/r_K that are allowed.
    cams : the cam, or the main and the return cam of a pair.
    findings : the findings on the cams.
    judged : see `CureTask`.
    """
    discs, all_findings = Discs(cams), [*findings]
    bad = [finding for finding in all_findings if finding.severity in BROKEN]
    names = [finding.name.removeprefix(f"{RETURN}: ") for finding in bad]
    if any(finding.severity == "invalid" for finding in bad):
        return ()
    touching = discs[0].follower.touching
    conditions = CONDITIONS[touching](angle, ratio)
    broken = {
        fault: condition
        for fault, condition in conditions.items()
        if any(name.startswith(condition.names) for name in names)
    }
    free = [
        finding.name for finding in all_findings if finding.limit is None
    ]  # a limit that does not apply
    held = tuple(
        condition
        for fault, condition in conditions.items()
        if fault not in broken and not any(name.startswith(condition.names) for name in free)
    )
    if "undercut" in broken and ratio == 1.0:
        broken.pop("radius ratio", None)  # at a ratio of 1 it is undercut
    already_broken = frozenset(finding.name for finding in bad)
    cures: list[Cure] = []
    for fault, condition in broken.items():
        task = CureTask(fault, condition, held, discs, unit, already_broken, judged)
        fault_cures = [knob(task) for knob in KNOBS[touching, fault]]
        cures += sorted(fault_cures, key=lambda cure: math.inf if cure.cost is None else cure.cost)
    return tuple(cures)
