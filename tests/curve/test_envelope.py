"""The real outline is the envelope of the roller: none covers a point of it, and one touches each.

Pairs of cam angles: a point of the outline, and the roller centre at any other angle, by nothing
but Z and Z'.
"""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.outline.outline import real_outline
from camgeo.geometry.outline.path import Pivot, Stretch
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN
from tests.strategies import (
    BENT,
    attack,
    linked_pitch_curves,
    pitch_curves,
    signs,
    wild_pitch_curves,
    with_roller,
)

ROUNDING = 1e-12
"""As a share of the size, as in the tests of the outline: a few thousand ulp. Cam angles of a
crossing are known to some ulp of a turn, and the roller passes a few times its distance a turn."""

COUNT = 150
"""Points of each stretch, and of roller centres ten times as many."""


@st.composite
def mechanisms(draw: st.DrawFn) -> PitchCurve:
    """Any mechanism, with a roller that may be far too large."""
    curve = draw(st.one_of(wild_pitch_curves(), pitch_curves(BENT), linked_pitch_curves(BENT)))
    if draw(st.booleans()):
        radius = draw(st.one_of(st.just(0.0), st.floats(1e-12, 0.9))) * curve.follower.base_radius
        return with_roller(curve, radius)
    return curve


def any_angles(rng: np.random.Generator, low: float, high: float, count: int) -> FloatArray:
    """Random ones, and the ends."""
    return np.concatenate(([low], np.sort(rng.uniform(low, high, count)), [high]))


@attack
@given(curve=mechanisms(), side=signs(), seed=st.integers(0, 2**32 - 1))
def test_no_roller_covers_the_outline_and_one_touches_each_point(
    curve: PitchCurve, side: int, seed: int
) -> None:
    radius = curve.follower.roller_radius
    try:
        outline = real_outline(WorkingCurve(curve, side * radius))
    except GeometryError as error:
        if isinstance(error, UndercutError) or "stands still" in error.message:
            return
        raise
    rng = np.random.default_rng(seed)
    centres = curve.point(any_angles(rng, 0.0, TURN, 10 * COUNT))
    rounding = ROUNDING * (float(np.max(np.abs(centres))) + 2.0 * radius)
    for path in (outline.path, *outline.lobes):
        for element in path.elements:
            loose = 1.0
            if isinstance(element, Stretch):
                phi = any_angles(rng, element.start, element.end, COUNT)[1:-1] % TURN
                points = element.curve.point(phi)
                z, z1 = curve.jet(phi)[:2]
                # Touched by the roller of its own cam angle, at right angles to its way.
                assert np.all(np.abs(np.abs(points - z) - radius) <= rounding)
                along = ((points - z) * np.conj(z1)).real / np.abs(z1)
                assert np.all(np.abs(along) <= rounding * np.max(np.abs(z1)) / np.abs(z1))
            else:
                assert isinstance(element, Pivot)
                shares = rng.uniform(0.0, 1.0, 5)
                turned = element.normal * np.exp(1j * element.sweep * shares)
                points = element.centre + element.distance * turned
                touching = [
                    np.abs(points - curve.point(np.array([angle % TURN])))
                    for angle in (element.before, element.after)
                ]
                # The more the branches differ, the better a crossing is known.
                loose = 16.0 / max(abs(float(np.sin(element.sweep))), 1e-3)
                assert np.all(np.abs(np.array(touching) - radius) <= loose * rounding)
            away = np.abs(points[:, None] - centres)
            assert np.min(away) >= radius - loose * rounding
