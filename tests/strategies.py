"""Hypothesis: how many examples, and the values that the tests of several modules draw."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace
from decimal import Decimal
from functools import cache
from typing import TypeVar

import numpy as np
from hypothesis import HealthCheck, assume, reject, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.laws import FAMILIES, make_law
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.mechanism.linkage import LinkedMotion, clear_range
from camgeo.kinematics.mechanism.linkages import FourBar, SliderCrank, SliderDrivenCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from tests.laws import LAWS
from tests.long_form import examples
from tests.reference import shift

attack = settings(
    max_examples=examples(10, long=60),
    deadline=None,  # the speed of a shared machine is no property of the code
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)

BENT = tuple(name for name, law in LAWS.items() if law.start.velocity == 0.0)
"""The laws from rest to rest without a shock."""

SMOOTH = tuple(name for name in BENT if LAWS[name].start.acceleration == 0.0)
"""The laws whose acceleration has no jump either."""

FAMILY_TASKS = [(name, task) for name, family in FAMILIES.items() for task in family.tasks]
"""All laws there are, each for each motion task that it is made for."""


# Strategies that are drawn from often are made once: hypothesis checks a new one before drawing
# from it, which takes longer than drawing.


Value = TypeVar("Value")


@cache
def among(values: tuple[Value, ...]) -> st.SearchStrategy[Value]:
    """One of the values."""
    return st.sampled_from(values)


@cache
def inflections() -> st.SearchStrategy[float]:
    """lambda anywhere in (0, 1), also very near its ends."""
    near = st.floats(1.0, 6.0).map(lambda exponent: 10.0**-exponent)
    return st.one_of(st.just(0.5), st.floats(0.01, 0.99), near, near.map(lambda lam: 1.0 - lam))


@cache
def shares() -> st.SearchStrategy[float]:
    """A share in (0, 1], also very near its ends."""
    return st.one_of(st.just(1.0), inflections())


@st.composite
def laws(draw: st.DrawFn, names: tuple[str, ...] = tuple(LAWS)) -> Law:
    """A law from rest to rest, often shifted."""
    return shift(LAWS[draw(among(names))], draw(inflections()))


@st.composite
def parameters_of(draw: st.DrawFn, name: str, task: str) -> dict[str, float]:
    """Parameters of a family for a task, all of them but those that stand in for lambda."""
    taken = FAMILIES[name].parameters[task]
    given: dict[str, float] = {}
    for key in taken:
        if key == "inflection":
            given[key] = draw(inflections())
        elif key == "curved":
            given[key] = draw(shares())
        elif key in ("sine", "cosine"):
            # 64ths: shares that are to add up to 1 do so exactly.
            left = 64 - round(64 * given.get("sine", 0.0))
            given[key] = draw(st.integers(0, left)) / 64
        elif key[0] in "vj" or "inflection" not in taken:
            value = draw(boundary_values(50.0 if key[0] == "j" else 5.0))
            if name != "polynomial" or draw(st.booleans()):
                given[key] = value
    return given


@cache
def boundary_values(most: float) -> st.SearchStrategy[float]:
    """0, or a value that is not so small that no one has it."""
    size = st.floats(1e-6, most)
    return st.one_of(st.just(0.0), size, size.map(lambda value: -value))


@st.composite
def family_terms(draw: st.DrawFn, name: str) -> tuple[str, dict[str, float]]:
    """A motion task that a family is made for, and parameters for it."""
    task = draw(among(FAMILIES[name].tasks))
    return task, draw(parameters_of(name, task))


@st.composite
def family_laws(draw: st.DrawFn, name: str) -> Law:
    """A law of a family for any of its motion tasks, with any parameters that it takes for it."""
    task, given = draw(family_terms(name))
    try:
        return make_law(name, task, **given)
    except GeometryError:
        # Any values make a law, but not any set of them: the jerks alone, for instance.
        assert name == "polynomial"
        reject()


@cache
def distances() -> st.SearchStrategy[float]:
    """From 0.1 down to 1e-16, evenly over the magnitudes."""
    return st.floats(1.0, 16.0).map(lambda exponent: 10.0**-exponent)


@st.composite
def places(draw: st.DrawFn, law: Law) -> float:
    """A z in [0, 1]: anywhere, or as near as 1e-16 to an end, a border or the inflection."""
    z: float
    if draw(st.booleans()):
        inner = law.borders if law.inflection is None else (law.inflection, *law.borders)
        corner = draw(st.sampled_from((0.0, *inner, 1.0)))
        z = min(max(corner + draw(among((-1.0, 0.0, 1.0))) * draw(distances()), 0.0), 1.0)
    else:
        z = draw(st.floats(0.0, 1.0))
    return z if z >= 1e-16 else 0.0


@st.composite
def plans(
    draw: st.DrawFn, names: tuple[str, ...] = BENT, stroke: float = 20.0, shift_laws: bool = True
) -> MotionPlan:
    """A plan of rests and moves between lifts 0 and `stroke`, each move 20 degrees at least."""
    count = draw(st.integers(2, 5))
    weights = [draw(st.integers(1, 20)) for _ in range(count)]
    rests = [draw(st.booleans()) for _ in range(count)]
    free = 360 - 25 * count
    total = sum(weights)
    spans = [25 + Decimal(free * weight // total) for weight in weights]
    spans[-1] += 360 - sum(spans)
    segments: list[Dwell | Move] = []
    position = 0.0
    for number, (span, rest) in enumerate(zip(spans, rests, strict=True)):
        last = number == count - 1
        if rest and not (last and position != 0.0):
            segments.append(Dwell(span))
            continue
        to = 0.0 if last else draw(st.floats(0.0, stroke))
        if shift_laws:
            lam = draw(st.floats(0.2, 0.8))
            law = shift(LAWS[draw(among(names))], lam)
        else:
            law = LAWS[draw(among(names))]
        segments.append(Move(span, to, law))
        position = to
    return MotionPlan(tuple(segments))


@cache
def cam_angles() -> st.SearchStrategy[float]:
    """A cam angle of one turn."""
    return st.floats(0.0, 2.0 * math.pi, exclude_max=True)


# Mechanisms -----------------------------------------------------------------------------------


@cache
def signs() -> st.SearchStrategy[int]:
    """+1 or -1."""
    return st.sampled_from([1, -1])


@st.composite
def translating_rollers(draw: st.DrawFn, stroke: float) -> TranslatingRoller:
    """A translating roller follower whose roller stays beyond the cam axis over `stroke` [mm]."""
    direction = draw(signs())
    base = draw(st.floats(40.0, 90.0)) + (stroke if direction < 0 else 0.0)
    return TranslatingRoller(
        base_radius=base,
        roller_radius=draw(st.floats(2.0, 12.0)),
        offset=draw(st.floats(-25.0, 25.0)),
        guide_angle=draw(st.one_of(st.just(math.pi / 2.0), st.floats(-math.pi, math.pi))),
        direction=direction,
    )


@st.composite
def rockers(
    draw: st.DrawFn,
    start: float,
    distance: float,
    arm: float,
    *,
    direction: int | None = 1,
    share: float | None = None,
    side: int | None = None,
) -> OscillatingRoller:
    """A rocker about a pivot anywhere round the cam axis, `start` [rad] off the line of centres at
    cam angle 0. The roller has 2 to 12 mm, or that `share` of the base circle.
    """
    base = math.sqrt(distance**2 + arm**2 - 2.0 * distance * arm * math.cos(start))
    pivot = cmath.rect(distance, draw(st.floats(-math.pi, math.pi)))
    radius = draw(st.floats(2.0, 12.0)) if share is None else share * base
    return OscillatingRoller(pivot, arm, base, radius, side or draw(signs()), direction)


@st.composite
def oscillating_rollers(draw: st.DrawFn, swing: float) -> OscillatingRoller:
    """An oscillating roller follower that stays off the line of centres over `swing` [rad]."""
    distance, arm = draw(st.floats(80.0, 160.0)), draw(st.floats(50.0, 75.0))
    low, high = math.radians(20.0), math.radians(150.0)
    direction = draw(signs())
    start = draw(
        st.floats(low + (swing if direction < 0 else 0.0), high - max(direction, 0) * swing)
    )
    return draw(rockers(start, distance, arm, direction=direction))


@st.composite
def pitch_curves(draw: st.DrawFn, names: tuple[str, ...] = SMOOTH) -> PitchCurve:
    """A pitch curve of either follower; moves of at most 20 mm or 0.3 rad."""
    sense = draw(signs())
    if draw(st.booleans()):
        return PitchCurve(draw(plans(names, 20.0)), draw(translating_rollers(20.0)), sense)
    return PitchCurve(draw(plans(names, 0.3)), draw(oscillating_rollers(0.3)), sense)


@st.composite
def wild_pitch_curves(draw: st.DrawFn) -> PitchCurve:
    """A pitch curve with a roller that may be far too large, by any law, shocks among them.

    The follower stays on one side of the cam axis, and the cam axis free of the roller at lift 0.
    """
    swings = draw(st.booleans())
    plan = draw(plans(tuple(LAWS), 0.6 if swings else 60.0))
    sense, share = draw(signs()), draw(st.floats(0.05, 0.95))
    if swings:
        distance, arm = draw(st.floats(80.0, 140.0)), draw(st.floats(50.0, 90.0))
        start = math.radians(draw(st.floats(15.0, 110.0)))
        return PitchCurve(plan, draw(rockers(start, distance, arm, share=share)), sense)
    base = draw(st.floats(10.0, 60.0))
    offset = base * draw(st.floats(-0.6, 0.6))
    guide = draw(st.floats(-math.pi, math.pi))
    return PitchCurve(plan, TranslatingRoller(base, share * base, offset, guide), sense)


@st.composite
def slider_cranks(draw: st.DrawFn, stroke: float = 8.0) -> SliderCrank:
    """A linkage that closes over the stroke from 0 to `stroke` [mm] with 2 mm to spare."""
    lengths = st.floats(30.0, 150.0)
    try:
        linkage = SliderCrank(
            crank=draw(lengths),
            coupler=draw(lengths),
            deflection=math.radians(draw(st.floats(-50.0, 50.0))),
            leans_away=draw(st.booleans()),
            slider_side=draw(signs()),
            stroke_direction=draw(signs()),
            branch=draw(signs()),
            mirrored=draw(st.booleans()),
        )
    except GeometryError:
        reject()
    strokes = np.linspace(0.0, stroke, 17)
    assume(np.max(linkage.missing_length(strokes)) < -2.0)
    return linkage


@st.composite
def linked_pitch_curves(draw: st.DrawFn, names: tuple[str, ...] = SMOOTH) -> PitchCurve:
    """A pitch curve of a rocker behind a slider-crank; strokes of at most 8 mm.

    The rocker keeps 10 degrees off the line of centres all over the stroke.
    """
    linkage = draw(slider_cranks(8.0))
    swing = linkage.crank_angle(np.linspace(0.0, 8.0, 17)) - linkage.crank_angle(np.zeros(1))
    swing *= -1.0 if linkage.mirrored else 1.0
    side = draw(signs())
    low, high = float(np.min(side * swing)), float(np.max(side * swing))
    margin = math.radians(10.0)
    assume(high - low < math.pi - 3.0 * margin)
    start = draw(st.floats(margin - low, math.pi - margin - high))
    distance, arm = draw(st.floats(80.0, 160.0)), draw(st.floats(50.0, 75.0))
    follower = draw(rockers(start, distance, arm, direction=None, side=side))
    motion = LinkedMotion(draw(plans(names, 8.0)), linkage)
    return PitchCurve(motion, follower, draw(signs()))


def with_roller(curve: PitchCurve, radius: float) -> PitchCurve:
    """The same mechanism with a roller of another radius [mm], or 0 for a knife edge."""
    follower = curve.follower
    assert isinstance(follower, TranslatingRoller | OscillatingRoller)
    return replace(curve, follower=replace(follower, roller_radius=radius))


@st.composite
def four_bars(draw: st.DrawFn, motion: float = 0.6) -> FourBar:
    """A four-bar that closes over the motion from 0 to `motion` [rad] with 2 mm to spare."""
    lengths, angles = st.floats(30.0, 150.0), st.floats(-math.pi, math.pi)
    try:
        linkage = FourBar(
            crank=draw(lengths),
            coupler=draw(lengths),
            lever=draw(lengths),
            shaft=cmath.rect(draw(st.floats(20.0, 200.0)), draw(angles)),
            lever_angle=draw(angles),
            lever_sense=draw(signs()),
            branch=draw(signs()),
        )
    except GeometryError:
        reject()
    assume(np.max(linkage.missing_length(np.linspace(0.0, motion, 17))) < -2.0)
    return linkage


@st.composite
def slider_driven_cranks(draw: st.DrawFn, motion: float = 0.6) -> SliderDrivenCrank:
    """A slider-crank whose crank turns from 0 to `motion` [rad] with 2 mm to spare."""
    try:
        linkage = SliderDrivenCrank(draw(slider_cranks(0.0)))
    except GeometryError:
        reject()
    assume(np.max(linkage.missing_length(np.linspace(0.0, motion, 17))) < -2.0)
    return linkage


@st.composite
def near_dead_pitch_curves(draw: st.DrawFn) -> PitchCurve:
    """A pitch curve behind a linkage that moves to within a share of 1e-5 to 1 of its way to a dead
    centre; the follower may pass the foot of its guide, or the line of centres.
    """
    linkage = draw(st.one_of(slider_cranks(0.0), four_bars(0.0), slider_driven_cranks(0.0)))
    far = 150.0 if linkage.unit == "mm" else 2.0
    end = clear_range(linkage)[draw(st.integers(0, 1))]
    assume(1e-3 * far < abs(end) < far)
    to = end * (1.0 - 10.0 ** -draw(st.floats(0.0, 5.0)))
    law = make_law(draw(st.sampled_from(("polynomial-345", "modified-sine"))), "R-R")
    spans = Decimal(draw(st.integers(20, 120))), Decimal(draw(st.integers(20, 120)))
    rest = (360 - spans[0] - spans[1]) / 2
    moves = Move(spans[0], to, law), Dwell(rest), Move(spans[1], 0.0, law), Dwell(rest)
    motion = LinkedMotion(MotionPlan(moves), linkage)
    rotation = draw(signs())
    if linkage.member == "crank":
        base, share = draw(st.floats(20.0, 200.0)), draw(st.floats(0.05, 0.3))
        return PitchCurve(motion, TranslatingRoller(base, share * base), rotation)
    distance, arm = draw(st.floats(80.0, 160.0)), draw(st.floats(50.0, 75.0))
    follower = draw(rockers(draw(st.floats(0.2, 2.9)), distance, arm, direction=None))
    return PitchCurve(motion, follower, rotation)
