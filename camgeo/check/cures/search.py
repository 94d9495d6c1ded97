"""The nearest size or span at which a fault is gone: what must hold, and the search for it."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Final, Protocol

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.check.disc import transmission_angle_extremes
from camgeo.check.finding import CONVEXITY, UNDERCUT
from camgeo.check.machine import check_follower
from camgeo.errors import GeometryError
from camgeo.geometry.outline.outline import CUSP, find_crossings
from camgeo.geometry.pieces import SMALLEST, Extremes, convexity, curvature_extremes, touch
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.together import alike, one_curve
from camgeo.kinematics.plan import SNAP, Dwell, MotionPlan
from camgeo.lazy import Ledger
from camgeo.numeric.arrays import SIDES, FloatArray, Side
from camgeo.numeric.extremes import bracketed_roots
from camgeo.units import TURN

# -- search ---------------------------------------------------------------------------------------
# The nearest value of a size at which a fault is gone, for any size and any fault.
#
# Where a condition is broken, the cam angle at which it is worst proves it broken for all values up
# to the one at which the margin at that angle vanishes. There another place may be the worst, from
# which the search goes on. So it arrives step by step, from the broken side, at the nearest value
# at which no place breaks anything, and passes over no window. Each step solves an equation in one
# unknown.
#
# What no single place decides is left to the verdict on that value. If a flank crosses itself
# there, the search goes on at the value at which the neck is as wide as the roller; otherwise it
# goes on in growing steps, between which the limit is enclosed.


FIRST: Final = 0.005
"""First step, as a fraction of the scale, where no place of the cam tells how far to go."""

GROWTH: Final = 1.5
"""Ratio of such a step to the previous one."""

SPREAD: Final = 1.3
"""Ratio of the distances of consecutive cell ends from the present value."""

LOST: Final = 1e-6
"""First step, as a fraction of the scale, across values without a mechanism, which are few: at one
of them the roller centre stands still."""

BEYOND: Final = 1e-7
"""A window narrower than this fraction of the scale does not count: in its middle the cam has a
cusp up to rounding. Crossings are tested this far beyond the limit, at which the flank touches
itself."""

NARROW: Final = 5e-7
"""Width, as a fraction of the scale, to which a limit that is not a root is enclosed."""

ROUNDING: Final = 1e-13
"""A step that is no longer than this fraction of the scale ends at the limit."""

HOPS: Final = 200
"""Most places of the cam that are visited on the way to a window; five are usual."""

TRIALS: Final = 60
"""Most values of the knob that are judged."""

EDGE: Final = 1e-3
"""First cell of a place's margin, as a fraction of the scale; its neighbours grow with the
distance, as the margin becomes smoother."""

CURVED: Final = 3.0
"""A cell is halved unless the parabola through its ends and its middle stays below 0 even if this
many times as curved."""

Excess = Mapping[str, float]
"""By how much limits are exceeded, by their names: positive where one is broken, infinite where the
amount is unknown."""

UNKNOWN: Final[Excess] = {"": math.inf}
"""Something is broken, by an unknown amount."""

STRAIGHT: Final = 0.03
"""Error of a secant's root as a share of its distance from the nearer end, as an excess is not
quite linear."""

MarginCurve = Callable[[FloatArray], FloatArray]
"""(n,) values of a size -> (n,) margins at one place of the cam."""


def holds(excess: Excess) -> bool:
    """Whether no limit is exceeded."""
    return all(value <= 0.0 for value in excess.values())


class Knob(Protocol):
    """A dimension or span that may change."""

    @property
    def start(self) -> float:
        """The present value."""

    @property
    def scale(self) -> float:
        """The length or span with which a change is compared."""

    def make(self, value: float, /) -> Discs:
        """The discs with another value; GeometryError where there are none."""

    def worst(self, value: float, conditions: Conditions) -> MarginCurve | None:
        """The margins where one of the `conditions` is worst at `value`; None if all are kept.

        GeometryError where there is no mechanism.
        """


@dataclass(frozen=True, slots=True)
class KnobSearch:
    """The search from a knob's present value to an `end`, with all that must hold at the result.

    Attributes
    ----------
    knob : the dimension or span that changes.
    end : the last value that is tried.
    conditions : the conditions at each place of the cam.
    judged : returns the excess at a value that keeps the conditions.
    rounded : rounds a value as a designer would; the rounded value is judged in place of the exact
        one if it keeps the conditions.
    """

    knob: Knob
    end: float
    conditions: Conditions
    judged: Callable[[float], Excess]
    rounded: Callable[[float], float] | None = None

    @property
    def _away(self) -> float:
        return math.copysign(self.knob.scale, self.end - self.knob.start)

    def nearest(self) -> float | None:
        """The limit nearest to the present value beyond which everything holds; None if there is
        none.
        """
        knob, away = self.knob, self._away
        if self.end == knob.start:
            return None
        bad: float | None = None
        x, step, crossed = knob.start, FIRST, False
        # x: where the search goes on; bad: the last value that was judged and failed. Once a flank
        # has crossed itself, its neck is examined first, which spares the verdict as long as the
        # neck is too narrow.
        for _ in range(TRIALS):
            limit = self.border(x)
            if limit is None:
                return None
            # At the limit itself a margin is 0; just beyond it all of them should be positive.
            inside = limit + away * min(BEYOND, abs((self.end - limit) / away))
            wide = self._past_neck(inside) if crossed else None
            if not self.keeps(inside):
                x = inside
            elif wide is None and holds(self.judged(self._rounded(inside))):
                return limit if bad is None or limit != x else self._enclosed(bad, limit)
            elif wide is not None or (wide := self._past_neck(inside)) is not None:
                x, bad, crossed = wide, None, True
            else:
                x, bad, step = inside + away * step, inside, step * GROWTH
            if (x - self.end) * away >= 0.0:
                return None
        return None

    def _rounded(self, value: float) -> float:
        if self.rounded is None:
            return value
        rounded = self.rounded(value)
        return rounded if self.keeps(rounded) else value

    def border(self, x: float) -> float | None:
        """The first value from `x` on at which the conditions hold, up to rounding."""
        knob, lost = self.knob, LOST
        for _ in range(HOPS):
            if (x - self.end) * self._away > 0.0:
                return None
            try:
                along = knob.worst(x, self.conditions)
            except GeometryError:
                # No mechanism at this value: in growing steps to the next one that makes one.
                x, lost = x + self._away * lost, lost * GROWTH
                continue
            if along is None:
                return x
            root = first_root(along, x, self.end, knob.scale)
            if root is None or abs(root - x) <= ROUNDING * knob.scale:
                return root
            x = root
        return None

    def keeps(self, value: float) -> bool:
        """Whether the conditions hold at `value`."""
        try:
            return self.knob.worst(value, self.conditions) is None
        except GeometryError:
            return False

    def _enclosed(self, bad: float, good: float) -> float:
        """The limit between a value that is not accepted and one that is.

        The secant of the excess gives the next value, moved a little towards the farther end, so
        that both ends move; where that does not shorten the range enough it is bisected.
        """
        bad_excess, good_excess = self.judged(bad), self.judged(good)
        narrow, halve = NARROW * self.knob.scale, False
        while (width := abs(good - bad)) > narrow:
            exceeded = {name: value for name, value in bad_excess.items() if value > 0.0}
            share = 0.5
            # A limit broken at the bad end must be known at the good one, or there is no secant.
            # The largest share is the root of the limit that is kept last.
            known = all(
                value < math.inf and name in good_excess for name, value in exceeded.items()
            )
            if known and not halve:
                share = max(value / (value - good_excess[name]) for name, value in exceeded.items())
                nearer = min(share, 1.0 - share)
                aside = max(narrow / (3.0 * width), STRAIGHT * nearer)
                share += math.copysign(aside, 0.5 - share)
            x = bad + share * (good - bad)
            excess = self.judged(x) if self.keeps(x) else UNKNOWN
            if holds(excess):
                good, good_excess = x, excess
            else:
                bad, bad_excess = x, excess
            halve = abs(good - bad) > 0.5 * width
        return good

    def _past_neck(self, value: float) -> float | None:
        """The value at which the narrowest neck becomes as wide as the roller, or up to which it is
        known to be narrower; None if the discs do not cross themselves, or nothing is known.
        """
        try:
            neck = self.knob.make(value).narrowest()
        except GeometryError:
            return None
        if neck is None or neck.clearance >= 0.0:
            return None
        begun: Neck = neck

        def clearance(x: float) -> float:
            try:
                here = self.knob.make(x).followed(begun)
            except GeometryError:
                here = None
            return math.nan if here is None else here.clearance

        previous, step = value, FIRST
        while (self.end - previous) * self._away > 0.0:
            x = previous + self._away * step
            if (x - self.end) * self._away > 0.0:
                x = self.end
            gap = clearance(x)
            if gap > 0.0:
                return _bracketed(np.vectorize(clearance, otypes=[float]), previous, x)
            if math.isnan(gap):
                return None if previous == value else previous
            previous, step = x, step * GROWTH
        return previous


def first_root(along: MarginCurve, start: float, end: float, scale: float) -> float | None:
    """The first value from `start` to `end` at which a margin, negative at first, vanishes.

    Cells in which the margin might reach 0 are halved: those in which the parabola through three
    values reaches it after its curvature has been multiplied by `CURVED`.
    """
    edges = _edges(start, end, scale)
    values = along(edges)
    settled = np.abs(np.diff(edges)) <= BEYOND * scale
    if values[0] >= 0.0:
        return start
    while True:
        # Only cells before the first change of sign can contain the first root.
        across = np.flatnonzero(values >= 0.0)
        left = int(across[0]) - 1 if len(across) else len(settled)
        cells = np.flatnonzero(~settled[:left])
        if not len(cells):
            return _bracketed(along, edges[left], edges[left + 1]) if len(across) else None
        # A cell is settled if its margin cannot reach 0, or if it is too narrow to be a window.
        middles = 0.5 * (edges[cells] + edges[cells + 1])
        middle_values = along(middles)
        split = _highest(values[cells], middle_values, values[cells + 1]) >= 0.0
        settled[cells] = ~split | (np.abs(middles - edges[cells]) <= BEYOND * scale)
        places = cells[split] + 1
        edges, values = (
            np.insert(edges, places, middles[split]),
            np.insert(values, places, middle_values[split]),
        )
        settled = np.insert(settled, places, settled[cells[split]])


def _bracketed(along: MarginCurve, low: float, high: float) -> float:
    """The root of `along` between `low` and `high`, where it has opposite signs."""
    return float(bracketed_roots(along, np.array([low]), np.array([high]))[0])


def _edges(start: float, end: float, scale: float) -> FloatArray:
    """(n,) ends of cells from `start` to `end`, whose lengths grow with their distance."""
    reach = abs(end - start)
    first = min(EDGE * scale, reach)
    if first == 0.0:
        return np.array([start])
    count = 1 + math.ceil(math.log(reach / first) / math.log(SPREAD))
    away = math.copysign(1.0, end - start) * np.geomspace(first, reach, count)
    edges: FloatArray = np.append(start, start + away)
    edges[-1] = end  # exactly, without the rounding of the geometric sequence
    return edges


def _highest(low: FloatArray, middle: FloatArray, high: FloatArray) -> FloatArray:
    """(n,) largest value in each cell of the parabola through its three values, if it were `CURVED`
    times as curved.
    """
    # In t from -1 to 1 the parabola through both ends that is raised by `most` in the middle is
    # top + slope t - fall t^2.
    bend, slope = 0.5 * (low + high) - middle, 0.5 * (high - low)
    most = CURVED * np.abs(bend)
    with np.errstate(divide="ignore", invalid="ignore"):
        top, fall = middle + most, most - bend
        inside = top + 0.25 * slope * slope / fall
        inside = np.where(np.abs(slope) < 2.0 * fall, inside, -np.inf)
    return np.maximum(np.maximum(low, high), np.maximum(middle, inside))


# -- conditions -----------------------------------------------------------------------------------
# What a cam must hold, as margins over the cam angle: positive where a limit is kept.
#
# Each is a function of the place alone, so that the place where it is worst proves for which other
# values of a size it is broken too. What no single place decides, such as whether a flank crosses
# itself, is left to the checks.


Range = tuple[float, float]
"""Cam angles [rad] of two breaks, or the ends of a dwell."""


@dataclass(frozen=True, slots=True)
class Condition(ABC):
    """A limit that must hold at each cam angle.

    Attributes
    ----------
    names : beginnings of the names of the findings that report where it is broken.
    vital : whether there is no disc where it is broken.
    """

    names: ClassVar[tuple[str, ...]]
    vital: ClassVar[bool] = False

    @abstractmethod
    def margin_extremes(self, cam: Cam) -> Extremes:
        """All local extremes of the margin. GeometryError if the pitch curve stands still."""

    @abstractmethod
    def margins(
        self, curve: PitchCurve, cams: Sequence[Cam], phi: FloatArray, side: Side
    ) -> FloatArray:
        """(n,) numbers with the signs of the margins at `phi` (n,) [rad], but without poles.

        `curve` is the pitch curve of the `cams`, of which there is one for each place or one for
        all.
        """

    def place_margins(
        self, curve: PitchCurve, cams: Sequence[Cam], phi: float, count: int
    ) -> FloatArray:
        """(count,) margins at one place `phi` [rad], see `margins`; at a break the smaller one."""
        places = np.full(count, phi)
        both = [self.margins(curve, cams, places, side) for side in SIDES]
        return np.asarray(np.minimum(*both))

    def cam_margins(self, cams: Sequence[Cam | None], phi: float) -> FloatArray:
        """(n,) margins at `phi` [rad] of `cams` with one motion; -1 where there is no mechanism."""
        margins = np.full(len(cams), -1.0)
        kinds: dict[Hashable, list[int]] = {}
        # Cams whose followers are alike are computed at once.
        for k, cam in enumerate(cams):
            if cam is not None:
                kinds.setdefault(alike(cam.follower), []).append(k)
        for places in kinds.values():
            some = [cam for k in places if (cam := cams[k]) is not None]
            curves = [cam.disc.pitch_curve for cam in some]
            curve = one_curve(curves, np.arange(len(some)), 1) if len(some) > 1 else curves[0]
            margins[places] = self.place_margins(curve, some, phi, len(some))
        return margins


@dataclass(frozen=True, slots=True)
class Bend(Condition):
    """1 + d kappa > 0 on the flanks in use: neither cusp nor local undercut, with the play of a
    groove.

    With `ratio` it is the rule r_R <= ratio r_K, which is the same for a roller of radius r_R/ratio
    without play.
    """

    names: ClassVar[tuple[str, ...]] = UNDERCUT
    vital = True

    ratio: float | None = None

    def _distances(self, cam: Cam) -> tuple[float, ...]:
        if self.ratio is None:
            return cam.distances
        radius = cam.follower.roller_radius / self.ratio
        return tuple(math.copysign(radius, distance) for distance in cam.distances)

    def margin_extremes(self, cam: Cam) -> Extremes:
        bends = curvature_extremes(cam.disc.pitch_curve)
        every = [1.0 + distance * bends.values for distance in self._distances(cam)]
        return Extremes(bends.phi, np.min(every, axis=0))

    def margins(
        self, curve: PitchCurve, cams: Sequence[Cam], phi: FloatArray, side: Side
    ) -> FloatArray:
        relative = curve.relative_jet(phi, side, order=2)
        bend = curve.follower.curvature(relative, np.ones_like(phi), curve.rotation)
        speed = np.hypot(relative.u, relative.v)
        # 1 + d kappa has a pole where the speed |Z'| vanishes, |Z'|^3 + d |Z'|^3 kappa has none;
        # the base radius makes it a number.
        distances = np.array([self._distances(cam) for cam in cams]).T
        size = np.array([cam.follower.base_radius for cam in cams])
        return np.asarray(np.min(speed**3 + distances * bend, axis=0) / size**3)


@dataclass(frozen=True, slots=True)
class Ratio(Bend):
    """The rule of thumb r_R <= ratio r_K, see `Bend`."""

    names = ("radius-ratio",)
    vital = False


@dataclass(frozen=True, slots=True)
class Angle(Condition):
    """The transmission angle is at least its `limit` [rad]."""

    names = ("transmission-angle",)

    limit: float

    def margin_extremes(self, cam: Cam) -> Extremes:
        angles = transmission_angle_extremes(cam.disc.pitch_curve)
        return Extremes(angles.phi, angles.values - self.limit)

    def margins(
        self, curve: PitchCurve, _: Sequence[Cam], phi: FloatArray, side: Side
    ) -> FloatArray:
        relative = curve.relative_jet(phi, side, order=1)
        # tan mu = |u| / |v|, so mu > limit where |u| cos(limit) > |v| sin(limit).
        u, v = np.abs(relative.u), np.abs(relative.v)
        return np.asarray(u * math.cos(self.limit) - v * math.sin(self.limit))


@dataclass(frozen=True, slots=True)
class Convex(Condition):
    """The radius of curvature under a flat face is positive; margins are fractions of r_G."""

    names = (CONVEXITY,)
    vital = True

    def margin_extremes(self, cam: Cam) -> Extremes:

        radius, phi = convexity(cam.disc.pitch_curve).radius
        margin = radius / cam.follower.base_radius - SMALLEST
        return Extremes(np.array([phi]), np.array([margin]))

    def margins(
        self, curve: PitchCurve, _: Sequence[Cam], phi: FloatArray, side: Side
    ) -> FloatArray:

        contact, size = touch(curve, phi, side), curve.follower.base_radius
        return np.asarray(contact.pace[0] - SMALLEST * size * contact.turn[0])


Conditions = tuple[Condition, ...]


CONDITIONS: Final[Mapping[str, Callable[[float, float], dict[str, Condition]]]] = {
    "roller": lambda angle, ratio: {
        "undercut": Bend(),
        "radius ratio": Ratio(ratio),
        "transmission angle": Angle(angle),
    },
    "face": lambda angle, _: {"convexity": Convex(), "transmission angle": Angle(angle)},
}
"""The conditions by the name of the fault that breaks them, by what touches the cam; made for the
least transmission angle [rad] and the largest r_R/r_K that are allowed."""


def place_range(extremes: Extremes, angles: Range) -> tuple[int, int]:
    """Slice bounds of the `extremes` between two cam angles, which are approached from inside.

    The first index is included, the second is not. If the extremes begin behind the angles, these
    are taken a turn later.
    """
    shift = TURN if angles[0] < extremes.phi[0] - SNAP else 0.0
    start, end = angles[0] + shift + SNAP, angles[1] + shift - SNAP
    first = max(int(np.searchsorted(extremes.phi, start, side="right")) - 1, 0)
    return first, min(int(np.searchsorted(extremes.phi, end)) + 1, len(extremes.phi))


# -- neck -----------------------------------------------------------------------------------------
# Necks: chords of the pitch curve at right angles to it at both ends, where two flanks touch.
#
# A flank at the distance d touches itself where such a chord is 2 |d| long and d points into it,
# and crosses itself where it is shorter. So global undercut is measured by a smooth number, whose
# root is the limit, which need not be enclosed by trial.


STEPS = 40
"""Most Newton steps; from a nearby crossing ten are plenty."""

LONGEST = 0.1
"""Longest Newton step [rad]: 6 degrees, so that it stays in the moves where it began."""

SQUARE = 1e-10
"""Largest cosine between chord and tangent that counts as a right angle; its square is rounding."""

TOGETHER = 1e-3
"""Ends closer than this [rad] are converging to one point: between the ends of a neck the curve
makes half a turn, and where they meet their two equations become one."""

Pair = tuple[int, float, float]
"""A crossing of a flank in use: the number of its disc, and its two cam angles [rad] in
[0, 2 pi)."""

Place = tuple[int, float]
"""A cam angle as the index of its segment in the plan and the fraction of the segment's span."""


@dataclass(frozen=True, slots=True)
class Neck:
    """A chord of the pitch curve at right angles to it at both ends.

    Attributes
    ----------
    disc : number of its disc.
    first, second : ends of the chord; as fractions of segments they survive a change of the spans.
    clearance : length of the chord minus twice the distance of the flanks from the pitch curve
        [mm].
    """

    disc: int
    first: Place
    second: Place
    clearance: float


def _square_chord(pitch: PitchCurve, first: float, second: float) -> tuple[float, float] | None:
    """Ends [rad] of a shortest chord near the cam angles `first` and `second`, by Newton's method;
    None if it does not converge.
    """
    angles = np.array([first, second])
    for _ in range(STEPS):
        if abs(math.remainder(float(angles[1] - angles[0]), math.tau)) < TOGETHER:
            return None
        point, slope, bend = pitch.jet(angles)[:3]
        chord = np.conj(complex(point[1] - point[0]))
        # Half the square of the chord's length is minimised; gradient and Hessian by the two
        # angles.
        sign = np.array([-1.0, 1.0])
        gradient = sign * (chord * slope).real
        speed = np.abs(slope)
        if np.all(np.abs(gradient) <= SQUARE * speed * abs(chord)):
            return float(angles[0]), float(angles[1])
        diagonal = speed**2 + sign * (chord * bend).real
        mixed = -float((np.conj(slope[0]) * slope[1]).real)
        if min(diagonal) <= 0.0 or diagonal[0] * diagonal[1] <= mixed**2:  # no minimum: go downhill
            diagonal, mixed = speed**2, 0.0
        crosswise = diagonal[::-1] * gradient - mixed * gradient[::-1]
        # Cramer's rule for the two unknowns.
        step = crosswise / (diagonal[0] * diagonal[1] - mixed**2)
        longest = float(np.max(np.abs(step)))
        if longest == 0.0:
            return None
        angles = angles - step * min(1.0, LONGEST / longest)
    return None


# -- discs ----------------------------------------------------------------------------------------


class Discs(tuple[Cam, ...]):
    """The cam, or the main and the return cam of a pair. Both have one drive."""

    __slots__ = ()

    @property
    def plan(self) -> MotionPlan:
        """The motion plan of their drive."""
        return self[0].drive.plan

    def sized(self, number: int = 0, **sizes: float) -> Discs:
        """The discs with other dimensions of the follower of disc `number`, named as in its table.

        A return roller takes from the main one what is not stated for it. GeometryError if the
        dimensions are impossible.
        """
        main, *others = self
        if number == 0:
            main = main.sized(**sizes)
        changed = [main]
        for place, cam in enumerate(others, start=1):
            mount = cam.mount
            assert mount is not None  # what makes it the second disc of a pair
            mount = mount.sized(**sizes) if place == number else mount
            follower = mount.roller(main.follower)
            changed.append(replace(cam, follower=follower, mount=mount, ledger=Ledger()))
        return Discs(changed)

    def moved(self, plan: MotionPlan) -> Discs:
        """The discs with another motion plan."""
        main, *others = self
        main = main.moved(plan)
        return Discs((main, *(replace(cam, drive=main.drive, ledger=Ledger()) for cam in others)))

    def segment_angles(self, number: int) -> Range:
        """Cam angles [rad] at which a segment starts and ends."""
        first, last = self.plan.joints_deg[number : number + 2]
        return math.radians(float(first)), math.radians(float(last))

    def segment_index(self, angle: float) -> int:
        """Index of the segment that contains the cam angle [rad]; if rounding leaves it in none, of
        the last segment with a length.
        """
        last = 0
        for number, segment in enumerate(self.plan.segments):
            if not segment.span:
                continue
            start, end = self.segment_angles(number)
            if start <= angle < end:
                return number
            last = number
        return last

    def worst_place(
        self, conditions: Conditions, segment: int | None = None
    ) -> tuple[Condition, int, float] | None:
        """The first of the `conditions` that a disc breaks, the number of the disc, and the cam
        angle [rad] where it is worst; None if all are kept. With `segment` only that is looked at.

        GeometryError if there is no such mechanism: it does not close, its roller covers the cam
        axis, its guide touches the base circle, or its roller centre stands still.
        """
        for number, cam in enumerate(self):
            inside = cam.contact.runs_inside
            for wrong in check_follower(
                cam.follower, runs_on_inner=inside, clearance=cam.clearance
            ):
                raise GeometryError(wrong.sentence, key="follower")
            for condition in conditions:
                extremes = condition.margin_extremes(cam)
                places = (0, len(extremes.phi))
                if segment is not None:
                    places = place_range(extremes, self.segment_angles(segment))
                worst = places[0] + int(np.argmin(extremes.values[slice(*places)]))
                # A margin that is 0 up to rounding is that of a cusp, which is broken too.
                if extremes.values[worst] <= CUSP:
                    return condition, number, float(extremes.phi[worst])
        return None

    def crossings(self) -> tuple[Pair, ...]:
        """The crossings of each flank with itself, see `find_crossings`."""
        return tuple(
            (number, crossing.first, crossing.second)
            for number, cam in enumerate(self)
            for _, flank in cam.disc.flanks
            for crossing in find_crossings(flank)
        )

    def narrowest(self) -> Neck | None:
        """The neck with the smallest clearance near a crossing; None if there is no neck."""
        necks = [neck for pair in self.crossings() if (neck := self._neck(*pair)) is not None]
        return min(necks, key=lambda neck: neck.clearance, default=None)

    def followed(self, neck: Neck) -> Neck | None:
        """The neck of these discs that corresponds to `neck`; None if it cannot be followed."""
        return self._neck(neck.disc, self._angle(neck.first), self._angle(neck.second))

    def _neck(self, number: int, first: float, second: float) -> Neck | None:
        cam = self[number]
        try:
            pitch = cam.disc.pitch_curve
            ends = _square_chord(pitch, first, second)
        except GeometryError:
            return None
        if ends is None:
            return None
        point, slope = pitch.jet(np.array(ends))[:2]
        chord = complex(point[1] - point[0])
        # The normals towards the inside of the curve, those at the second end reversed, so that
        # both have a positive part along the chord where it lies inside.
        inward = 1j * pitch.rotation * slope / np.abs(slope) * np.array([1.0, -1.0])
        facing = (np.conj(chord) * inward).real
        # The flank lies in the chord at both its ends, or at neither.
        if not any(np.all(distance * facing > 0.0) for distance in cam.distances):
            return None
        clearance = abs(chord) - 2.0 * cam.disc.flank_distance
        return Neck(number, self._place(ends[0]), self._place(ends[1]), clearance)

    def _place(self, angle: float) -> Place:
        number = self.segment_index(angle % math.tau)
        start, end = self.segment_angles(number)
        return number, (angle % math.tau - start) / (end - start)

    def _angle(self, place: Place) -> float:
        start, end = self.segment_angles(place[0])
        return start + place[1] * (end - start)

    def faulty_segments(self, condition: Condition) -> tuple[int, ...]:
        """Indices in the plan of the segments that are at fault.

        These are the segments in which the condition is broken. If there are none, they are those
        whose flanks cross each other, without the dwells if there is a move among them: the move
        next to a dwell is what can change.
        """
        extremes = [condition.margin_extremes(cam) for cam in self]

        def broken(ends: Range) -> bool:
            parts = ((margins.values, place_range(margins, ends)) for margins in extremes)
            return any(np.min(values[slice(*ends)]) <= CUSP for values, ends in parts)

        segments = self.plan.segments
        numbers = [number for number, segment in enumerate(segments) if segment.span]
        local = [number for number in numbers if broken(self.segment_angles(number))]
        if local:
            return tuple(local)
        angles = [angle for _, *both in self.crossings() for angle in both]
        places = sorted({self.segment_index(angle) for angle in angles})
        moves = [place for place in places if not isinstance(segments[place], Dwell)]
        return tuple(moves or places or numbers)
