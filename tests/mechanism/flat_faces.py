"""Random flat-faced followers for tests."""

from __future__ import annotations

import cmath
import math

from hypothesis import assume
from hypothesis import strategies as st

from camgeo.geometry.pieces import convexity
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
from tests.strategies import BENT, plans, signs


@st.composite
def translating_flats(draw: st.DrawFn) -> TranslatingFlat:
    """A translating flat face 20 to 120 mm from the cam axis."""
    return TranslatingFlat(
        base_radius=draw(st.floats(20.0, 120.0)),
        guide_angle=draw(st.one_of(st.just(math.pi / 2.0), st.floats(-math.pi, math.pi))),
        direction=draw(signs()),
    )


@st.composite
def oscillating_flats(draw: st.DrawFn) -> OscillatingFlat:
    """An oscillating flat face; chi at cam angle 0 lies between -30 and 60 degrees."""
    distance, offset = draw(st.floats(60.0, 160.0)), draw(st.floats(-20.0, 60.0))
    base = distance * math.sin(math.radians(draw(st.floats(-30.0, 60.0)))) + offset
    assume(base > 15.0)
    pivot = cmath.rect(distance, draw(st.floats(-math.pi, math.pi)))
    side, direction = draw(signs()), draw(st.sampled_from([1, -1, None]))
    return OscillatingFlat(pivot, base, offset, side, direction)


@st.composite
def flat_curves(draw: st.DrawFn, names: tuple[str, ...] = BENT) -> PitchCurve:
    """The contact curve of either follower, convex or not; moves of at most 20 mm or 0.3 rad."""
    sense = draw(signs())
    if draw(st.booleans()):
        return PitchCurve(draw(plans(names, 20.0)), draw(translating_flats()), sense)
    return PitchCurve(draw(plans(names, 0.3)), draw(oscillating_flats()), sense)


@st.composite
def convex_curves(draw: st.DrawFn) -> PitchCurve:
    """One that is convex."""
    curve = draw(flat_curves())
    assume(convexity(curve).is_convex)
    return curve
