"""Cases of real outlines: vanishing swallow tails, necks, remaining area, lost stroke."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import Final

import numpy as np

from camgeo.geometry.outline.envelope import Node
from camgeo.geometry.outline.outline import find_crossings, real_outline
from camgeo.geometry.outline.path import area
from camgeo.geometry.outline.replay import Replay, replay_outline
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.stability.cams import STEEP, CamSpec
from tests.stability.exact_outline import ExactOutline
from tests.stability.measure import Case
from tests.stability.series import Number, Roots

GROUP: Final = "outlines"


LARGEST: Final = ("largest lost stroke", "place of largest lost stroke")

EXCESS: Final = (1e-2, 1e-4, 1e-6, 1e-9)
"""Excess of the roller radius over the smallest radius of curvature, as a fraction of that."""

SHARES: Final = (0.05, 0.3, 0.5, 0.8)
"""Places on a corner, as fractions of the missing range."""

MIDDLE: Final = SHARES[1:]
"""As `SHARES`, away from the ends. A lost stroke is the difference of two lifts and known to their
rounding: below a thousandth of the lift, as near the ends, few digits are left."""

MEASURED: Final = ("HC21c swallow tail", "HC22 neck of a lobe")
"""Flanks whose area and lost stroke are measured."""

REPLAYED: Final = (*MEASURED, "tail of a rocker", "tail of an outer flank")
"""Flanks on which the roller is rolled."""

GUESS: Final = 9
"""Decimals of a cam angle [rad] from which an exact root is sought: the narrowest swallow tail is
3e-5 wide."""

INNER, OUTER = -1, 1


def cases() -> tuple[Case, ...]:
    """All cases of this module."""
    named = {spec.name: (spec, side) for spec, side in flanks()}
    found = [_crossings(_tail(excess), INNER) for excess in EXCESS]
    found += [_crossings(*flank) for flank in named.values()]
    found += [_area(*named[name]) for name in MEASURED]
    found += [_lift(*named[name]) for name in REPLAYED]
    for name in MEASURED:
        found += _losses(*named[name])
    return tuple(found)


def flanks() -> tuple[tuple[CamSpec, int], ...]:
    """Undercut cams, each with the flank to examine; none has an edge at cam angle 0."""
    rocker = OscillatingRoller(-100.0 + 0j, 85.0, 30.0, 21.75, -1, 1)
    return (
        (CamSpec("HC21c swallow tail", STEEP, 20.0, TranslatingRoller(25.0, 14.843343627412837)),
         INNER),
        (CamSpec("HC22 neck of a lobe", ("10", "40", "0", "40", "270"), 130.0,
                 TranslatingRoller(22.0, 16.0)), INNER),
        (CamSpec("HC22b neck of a lobe", ("10", "40", "2", "40", "268"), 120.0,
                 TranslatingRoller(16.0, 11.0)), INNER),
        (CamSpec("neck and tail, offset", ("10", "40", "1", "50", "259"), 120.0,
                 TranslatingRoller(24.0, 17.0, 3.0), rotation=-1, law="modified-sine"), INNER),
        (CamSpec("tail of a rocker", STEEP, 0.5, rocker), INNER),
        (CamSpec("tail of an outer flank", STEEP, 20.0, TranslatingRoller(25.0, 11.8)), OUTER),
    )  # fmt: skip


def _tail(excess: float) -> CamSpec:
    follower = TranslatingRoller(25.0, 8.0)
    base = CamSpec(f"roller {excess:.0e} too large", STEEP, 20.0, follower)
    smallest = 1.0 / curvature_extremes(base.curve).largest()[0]
    return replace(base, follower=replace(follower, roller_radius=smallest * (1.0 + excess)))


def _flank(spec: CamSpec, side: int) -> WorkingCurve:
    return WorkingCurve(spec.curve, side * spec.follower.roller_radius)


def _crossings(spec: CamSpec, side: int) -> Case:
    engine = find_crossings(_flank(spec, side))
    exact_outline = ExactOutline(spec, side)

    def at(guess: float) -> Node:
        return min(engine, key=lambda crossing: abs(crossing.first - guess))

    def found(guesses: FloatArray) -> tuple[FloatArray | ComplexArray, ...]:
        them = [at(float(guess)) for guess in guesses]
        return (
            np.array([crossing.first for crossing in them]),
            np.array([crossing.second for crossing in them]),
            np.array([crossing.point for crossing in them]),
        )

    roots = Roots(GUESS)

    def exact(guess: Number, *numbers: Number) -> tuple[Number, ...]:
        known = roots.near(guess)
        start = _guesses(at(float(guess))) if known is guess else known
        crossing = exact_outline.crossing(start, numbers)
        roots.keep(guess, crossing[:2])
        return crossing

    places = tuple(_guesses(crossing)[0] for crossing in engine)
    return Case(
        GROUP,
        spec.name,
        ("crossing, first cam angle", "crossing, second cam angle", "crossing point"),
        places,
        exact_outline.parameters,
        found,
        exact,
    )


def _area(spec: CamSpec, side: int) -> Case:
    flank, exact_outline = _flank(spec, side), ExactOutline(spec, side)
    guesses = _guesses(_cut(spec, side))

    def found(places: FloatArray) -> tuple[FloatArray, ...]:
        return (np.full(len(places), abs(area(real_outline(flank).path))),)

    def exact(_: Number, *numbers: Number) -> tuple[Number, ...]:
        x, y, _ = exact_outline.crossing(guesses, numbers)
        return (exact_outline.area(x, y, numbers),)

    return Case(
        GROUP, spec.name, ("area of the disc",), guesses[:1], exact_outline.parameters, found, exact
    )


class _Rolled:
    """A replay, and the exact corner of the outline on which the roller rests."""

    def __init__(self, spec: CamSpec, side: int) -> None:
        flank = _flank(spec, side)
        self.exact = ExactOutline(spec, side)
        self.cut = _cut(spec, side)
        self.replay = replay_outline(spec.curve, real_outline(flank).path)
        self.corner = cache(self._corner)

    def _corner(self, numbers: tuple[Number, ...]) -> Number:
        return self.exact.crossing(_guesses(self.cut), numbers)[2]

    def places(self, shares: tuple[float, ...]) -> tuple[float, ...]:
        """Cam angles [rad] at fractions of the missing range."""
        wide = self.cut.second - self.cut.first
        return tuple(self.cut.first + share * wide for share in shares)


def _lift(spec: CamSpec, side: int) -> Case:
    """The actual lift of the follower."""
    rolled = _Rolled(spec, side)

    def found(places: FloatArray) -> tuple[FloatArray, ...]:
        return (rolled.replay.lift.displacement(places),)

    def exact(phi: Number, *numbers: Number) -> tuple[Number, ...]:
        return (rolled.exact.actual(phi, rolled.corner(numbers), numbers, 1).terms[0],)

    places, parameters = rolled.places(SHARES), rolled.exact.parameters
    return Case(GROUP, spec.name, ("lift on the outline",), places, parameters, found, exact)


def _losses(spec: CamSpec, side: int) -> Iterator[Case]:
    """Lost stroke at several places, and the largest."""
    rolled = _Rolled(spec, side)
    largest, parameters = rolled.replay.largest_loss, rolled.exact.parameters

    def found(places: FloatArray) -> tuple[FloatArray, ...]:
        return (_lost(rolled.replay, places),)

    def exact(phi: Number, *numbers: Number) -> tuple[Number, ...]:
        return (rolled.exact.loss(phi, rolled.corner(numbers), numbers, 1).terms[0],)

    def found_largest(places: FloatArray) -> tuple[FloatArray, ...]:
        return np.full(len(places), largest.value), np.full(len(places), largest.place)

    def exact_largest(guess: Number, *numbers: Number) -> tuple[Number, ...]:
        corner = rolled.corner(numbers)
        place = rolled.exact.place_of_largest_loss(guess, corner, numbers)
        return rolled.exact.loss(place, corner, numbers, 1).terms[0], place

    places = rolled.places(MIDDLE)
    yield Case(GROUP, spec.name, ("lost stroke",), places, parameters, found, exact)
    guess = (round(largest.place, GUESS),)
    yield Case(GROUP, spec.name, LARGEST, guess, parameters, found_largest, exact_largest)


def _lost(replay: Replay, phi: FloatArray) -> FloatArray:
    """Lost stroke (n,) [mm or rad] at `phi` (n,) [rad], as `Replay.lost` has it at its samples."""
    lift = replay.lift
    difference = lift.displacement(phi) - lift.motion.jet(phi, "right", 1)[0]
    return np.asarray(replay.press * lift.outward * difference)


def _cut(spec: CamSpec, side: int) -> Node:
    """The crossing at which the disc ends: the one with the widest range between its cam angles."""
    return max(find_crossings(_flank(spec, side)), key=lambda each: each.second - each.first)


def _guesses(crossing: Node) -> tuple[float, float]:
    return round(crossing.first, GUESS), round(crossing.second, GUESS)
