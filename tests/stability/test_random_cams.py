"""Cams that are not in the suite: no digits are lost there either."""

from __future__ import annotations

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from camgeo.errors import GeometryError
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.linkages import SliderDrivenCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from tests.long_form import examples
from tests.mechanism.flat_faces import oscillating_flats, translating_flats
from tests.motion.exact_laws import HALVES
from tests.stability import faces
from tests.stability.cams import CamSpec, cases_of
from tests.stability.exact_cam import AnyLinkage
from tests.stability.measure import measure
from tests.stability.suite import LIMIT
from tests.strategies import (
    attack,
    four_bars,
    oscillating_rollers,
    signs,
    slider_cranks,
    slider_driven_cranks,
    translating_rollers,
)

few = settings(attack, max_examples=examples(4, long=6))

SPANS = (
    ("30", "100", "40", "120", "70"),
    ("0", "20", "0", "330", "10"),
    ("90", "90", "1", "1", "178"),
)


@st.composite
def specs(draw: st.DrawFn) -> CamSpec:
    """A cam with a stroke from next to nothing to 20 mm or 0.3 rad, and two places in each move."""
    share = 10.0 ** -draw(st.floats(0.0, 8.0))
    sliding = draw(st.booleans())
    name = draw(st.sampled_from(tuple(HALVES)))
    # Behind lambda the lift is the stroke less what is left: it keeps the stroke's digits only.
    inflection = draw(st.floats(0.1, 0.9))
    borders = np.array([inflection, *make_law(name, "R-R", inflection=inflection).borders])
    shares = [draw(places()) for _ in range(4)]
    # At a border itself a rounded place may lie on either side of the jump.
    assume(all(np.min(np.abs(borders - share)) > 1e-9 for share in shares))
    return CamSpec(
        name="random",
        spans=draw(st.sampled_from(SPANS)),
        stroke=share * (20.0 if sliding else 0.3),
        follower=draw(translating_rollers(20.0)) if sliding else draw(oscillating_rollers(0.3)),
        rotation=draw(signs()),
        law=name,
        inflection=inflection,
        rise=tuple(shares[:2]),
        back=tuple(shares[2:]),
    )


def places() -> st.SearchStrategy[float]:
    """A share of a move; 1e-6 rad off its ends at least."""
    near = st.floats(1.0, 5.0).map(lambda exponent: 10.0**-exponent)
    return st.one_of(st.floats(0.01, 0.99), near, near.map(lambda share: 1.0 - share))


@settings(attack, max_examples=examples(8, long=60))
@given(spec=specs())
def test_random_cams_are_as_good_as_doubles_allow(spec: CamSpec) -> None:
    for case in cases_of(spec):
        poor = [each for each in measure(case) if each.ratio > LIMIT]
        assert poor == []


@st.composite
def flat_specs(draw: st.DrawFn) -> CamSpec:
    """A cam under a flat face, convex or not."""
    share = 10.0 ** -draw(st.floats(0.0, 8.0))
    sliding = draw(st.booleans())
    return CamSpec(
        name="random",
        spans=draw(st.sampled_from(SPANS[:2])),
        stroke=share * (20.0 if sliding else 0.3),
        follower=draw(translating_flats()) if sliding else draw(oscillating_flats()),
        rotation=draw(signs()),
        rise=(draw(places()), draw(places())),
    )


@few
@given(spec=flat_specs())
def test_random_flat_faces_are_as_good_as_doubles_allow(spec: CamSpec) -> None:
    for case in faces.cases_of(spec):
        poor = [each for each in measure(case) if each.ratio > LIMIT]
        assert poor == []


@settings(attack, max_examples=examples(6, long=12))
@given(
    linkage=st.one_of(slider_cranks(), four_bars(), slider_driven_cranks()),
    share=st.floats(0.0, 8.0),
    rise=st.tuples(places(), places()),
    rotation=signs(),
)
def test_random_linkages_are_as_good_as_doubles_allow(
    linkage: AnyLinkage, share: float, rise: tuple[float, float], rotation: int
) -> None:
    """Behind a guide that is long enough, or a rocker."""
    follower = (
        TranslatingRoller(400.0, 10.0, 12.0)
        if isinstance(linkage, SliderDrivenCrank)
        else OscillatingRoller(-100.0 + 0j, 80.0, 120.0, 5.0, 1, None)
    )
    spec = CamSpec("random", SPANS[0], 0.6 * 10.0**-share, follower, linkage, rotation, rise=rise)
    try:
        (case,) = cases_of(spec)
    except GeometryError:
        assume(False)
    poor = [each for each in measure(case) if each.ratio > LIMIT]
    assert poor == []
