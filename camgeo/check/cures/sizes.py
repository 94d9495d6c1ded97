"""Cures by one dimension of the follower: base radius, roller radius, offset or arm."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import lru_cache, singledispatch
from typing import Any, Final

from camgeo.cam.cam import Cam
from camgeo.check.cures.conditions import (
    Conditions,
    Discs,
    margins_of_each,
    sized,
    worst_place,
)
from camgeo.check.cures.cure import (
    Change,
    Cure,
    Length,
    digits_for,
    length_cure,
    no_cure,
    rounded_beyond,
    shown,
)
from camgeo.check.cures.neck import crossings
from camgeo.check.cures.search import BEYOND, UNKNOWN, Along, Excess, Way, holds
from camgeo.check.cures.task import Edits, Judge, Task, edits_of
from camgeo.curve.extremes import curvature_extremes
from camgeo.errors import GeometryError
from camgeo.mechanism.face import flat_follower
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.numeric.arrays import FloatArray
from camgeo.units import MM_PER, LengthUnit

MOST: Final = 100.0
"""Largest base radius tried, as a multiple of the present one."""

KNOWN: Final = 64
"""Latest values of a size of which the discs are kept: conditions and checks share what they find
in them."""

INSIDE: Final = 1e-6
"""Fraction of the base radius by which an offset, arm or base radius stays clear of the value at
which the mechanism locks or is stretched out, or the roller covers the cam axis."""

TABLES: Final = ("follower", "follower.return")
"""The scene's table of each disc's roller."""


@dataclass(frozen=True, slots=True, eq=False)
class Size:
    """A dimension of the follower, a `Knob` of the search.

    Attributes
    ----------
    start, scale : its present value, and what a change is compared with [mm].
    made : the discs with another value.
    """

    start: float
    scale: float
    made: Callable[[float], Discs]

    def make(self, value: float) -> Discs:
        """See `Knob`."""
        return self.made(value)

    def worst(self, value: float, conditions: Conditions) -> Along | None:
        """See `Knob`."""
        found = worst_place(self.made(value), conditions)
        if found is None:
            return None
        condition, number, phi = found

        def cam(other: float) -> Cam | None:
            try:
                return self.made(other)[number]
            except GeometryError:
                return None

        def along(values: FloatArray) -> FloatArray:
            return margins_of_each(condition, [cam(each) for each in values.tolist()], phi)

        return along

    def nearest(
        self,
        low: float,
        high: float,
        conditions: Conditions,
        judged: Callable[[float], Excess],
        unit: LengthUnit,
    ) -> Length | None:
        """The nearest length between `low` and `high` [mm] at which what is `judged` holds."""

        def rounded(value: float) -> float:
            upward, mm = value > self.start, MM_PER[unit]
            digits = digits_for(self.start, value)
            return mm * float(rounded_beyond(value / mm, digits, upward=upward))

        up = Way(self, max(high, self.start), conditions, judged, rounded).nearest()
        if up is not None:
            low = max(low, self.start - (up - self.start))
        way = Way(self, min(low, self.start), conditions, judged, rounded)
        down = way.nearest()
        limit = up if down is None else down
        if limit is None:
            return None

        def cures(value: float) -> bool:
            return way.keeps(value) and holds(judged(value))

        return Length.beyond(self.start, limit, cures, unit, upward=down is None)


def base_radius(task: Task) -> Cure:
    """Another base circle; an oscillating follower keeps its pivot and arm.

    The return roller of a pair moves with the main one.
    """
    main = task.discs[0]
    old = main.follower.base_radius
    high = min(MOST * old, max(main.follower.farthest * (1.0 - INSIDE), old))
    low = _knob(main.follower)[-1] + INSIDE * old
    if main.contact.runs_inside:
        low = max(low, main.disc.flank_distance * (1.0 + INSIDE))
    return _other(task, "base radius", 0, (min(low, old), high), old)


def offset_or_arm(task: Task) -> Cure:
    """Another offset |e| < r_G of a guide, or another arm of a rocker with the same pivot and r_G.

    Of a pair whose return disc alone is at fault, that of the return roller.
    """
    number = 1 if len(task.discs) > 1 and _is_kept(task, task.discs[:1]) else 0
    knob, low, high, scale, _ = _knob(task.discs[number].follower)
    return _other(task, knob, number, (low, high), scale)


def _other(task: Task, knob: str, number: int, within: tuple[float, float], scale: float) -> Cure:
    """Another value of one dimension, in whichever direction the change is smaller."""
    field = knob.replace(" ", "_")
    key, old = f"{TABLES[number]}.{field}", float(getattr(task.discs[number].follower, field))
    mm = MM_PER[task.unit]

    @lru_cache(KNOWN)
    def made(value: float) -> Discs:
        return sized(task.discs, number, **{field: mm * (value / mm)})

    size = Size(old, scale, made)
    length = _sought(task, size, within, lambda value: {key: value / mm})
    ends = f"{within[0] / mm:.6g} and {within[1] / mm:.6g} {task.unit}"
    none = f"no other {knob} between {ends} cures it"
    cure = length_cure(knob, key, old, length, scale, none, task.unit)
    return task.finished(cure, None if length is None else size.made(length.value))


def _sought(
    task: Task, size: Size, within: tuple[float, float], edits: Callable[[float], Edits]
) -> Length | None:
    for conditions, verdict in task.stages:

        def judged(value: float, verdict: Judge = verdict) -> Excess:
            return verdict(size.made(value), edits(value))

        length = size.nearest(*within, conditions, judged, task.unit)
        if length is not None:
            return length
    return None


def roller_radius(task: Task) -> Cure:
    """A smaller roller: at most the smallest r_K that matters, in closed form (Wirsig eq. 3.36).

    In a groove with side clearance c at most r_K - c/2; the clearance is kept. Smaller still, by a
    search, if the flank of that roller crosses itself. Of a pair each roller that needs it.
    """
    made, found = task.discs, list[Cure]()
    for number in reversed(range(len(made))):  # the return roller may have the main one's size
        if len(made) > 1 and _is_kept(task, (made[number],)):
            continue
        key, old = f"{TABLES[number]}.roller_radius", made[number].follower.roller_radius
        length = _smaller_roller(task, made, number, key)
        none = f"no smaller roller radius cures it ({key}){_why(task, made[number])}"
        cure = length_cure("roller radius", key, old, length, old, none, task.unit, "at most ")
        if length is None:
            return task.finished(cure)
        found.append(cure)
        made = sized(made, number, roller_radius=length.value)
    return _together(task, found, made)


def _smaller_roller(task: Task, discs: Discs, number: int, key: str) -> Length | None:
    """That of one disc: of a pair the other one may be at fault too."""
    old, mm = discs[number].follower.roller_radius, MM_PER[task.unit]
    size = Size(old, old, lambda value: (sized(discs, number, roller_radius=value)[number],))
    low = BEYOND * old
    if len(discs) == 1:
        return _sought(task, size, (low, old), lambda value: {key: value / mm})
    conditions = (task.condition,)

    def judged(value: float) -> Excess:
        return UNKNOWN if _crosses(size.made(value)) else {}

    return size.nearest(low, old, conditions, judged, task.unit)


def _why(task: Task, cam: Cam) -> str:
    """Why no roller at all fits a disc."""
    if cam.follower.roller_radius == 0.0:
        return ": a knife edge has no roller to make smaller"
    bends = curvature_extremes(cam.disc.pitch_curve)
    extremes = bends.smallest()[0], bends.largest()[0]
    kappa = max(-flank.sign * each for flank in cam.contact.flanks for each in extremes)
    if kappa <= 0.0:
        return ""
    mm = MM_PER[task.unit]
    play, radius = cam.clearance / mm, 1.0 / (kappa * mm)
    beside = f", beside a play of {play:.6g} {task.unit}" if play > 0.0 else ""
    return f": the smallest radius of curvature is {radius:.3g} {task.unit}{beside}"


def _is_kept(task: Task, discs: Discs) -> bool:
    """Whether the fault is not that of these discs."""
    try:
        crosses = task.condition.vital and _crosses(discs)
        return not crosses and worst_place(discs, (task.condition,)) is None
    except GeometryError:
        return False


def _crosses(discs: Discs) -> bool:
    try:
        return bool(crossings(discs))
    except GeometryError:  # it cannot be decided
        return True


def _together(task: Task, found: list[Cure], made: Discs) -> Cure:
    """The cures of all discs as one, led by the most costly; no cure unless it cures both."""
    leading = max(found, key=lambda cure: cure.cost or 0.0)
    others = [cure for cure in found if cure is not leading]
    sentence = " and ".join(cure.sentence for cure in (leading, *others))
    also = tuple(Change(each.key, each.value_from, each.value_to or 0.0) for each in others)
    cure = replace(leading, sentence=sentence, also=also)
    if not holds(task.failing(made, edits_of(cure))):
        reason = "no smaller roller radii cure both discs"
        none = no_cure(leading.knob, leading.key, leading.value_from, leading.unit, reason)
        return task.finished(none)
    return task.finished(cure, made)


def face_out(task: Task) -> Cure:
    """The least base radius, on a rocker with as much more face offset, that leaves no undercut.

    Moved out by D, a face has the parallel outline, all of whose radii are larger by D.
    """
    (cam,) = task.discs
    follower = flat_follower(cam.follower)
    old, mm = follower.base_radius, MM_PER[task.unit]
    present = {key: getattr(follower, _field(key)) / mm for key in follower.raised_by}

    def raised(value: float) -> dict[str, float]:
        """Each length in the unit that goes with the base radius `value` [mm], by its key."""
        more = Decimal(repr(value / mm)) - Decimal(repr(old / mm))
        return {key: float(Decimal(repr(each)) + more) for key, each in present.items()}

    def made(value: float) -> Discs:
        return (cam.sized(**{_field(key): mm * each for key, each in raised(value).items()}),)

    length = _sought(task, Size(old, old, made), (old, MOST * old), raised)
    first, *others = follower.raised_by
    none = f"no larger {' and '.join(follower.raised_by)} cures it"
    cure = length_cure("base radius", first, old, length, old, none, task.unit, "at least ")
    if length is None:
        return task.finished(cure)
    if others:
        lengths = raised(length.value)
        also = tuple(Change(key, present[key], lengths[key]) for key in others)
        beside = " and ".join(f"{key} {shown(lengths[key])} {task.unit}" for key in others)
        cure = replace(cure, sentence=f"{cure.sentence}, with {beside}", also=also)
    return task.finished(cure, made(length.value))


def _field(key: str) -> str:
    """The field of a key of the scene."""
    return key.removeprefix("follower.")


@singledispatch
def _knob(follower: Any) -> tuple[str, float, float, float, float]:
    """The dimension to change besides the radii: its name, bounds, and a scale for it; and the base
    radius down to which there is a mechanism [mm].
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
