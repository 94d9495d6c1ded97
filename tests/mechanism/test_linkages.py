"""What holds for every linkage, over random valid ones; each has a module of its own, too."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf

from camgeo.kinematics.mechanism.four_bar import FourBar
from camgeo.kinematics.mechanism.linked_motion import LinkedMotion
from camgeo.kinematics.mechanism.slider_crank import SliderCrank
from camgeo.kinematics.mechanism.slider_driven_crank import SliderDrivenCrank
from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN
from tests.integrals import cells, integrals
from tests.long_form import examples
from tests.stability.exact_cam import exact_linkage, numbers_of
from tests.stability.series import Series
from tests.strategies import SMOOTH, attack, four_bars, plans, slider_cranks, slider_driven_cranks

ROUNDING: Final = 1e-11
"""As a share of the largest value. With 2 mm to spare the sines by which up to five times is
divided are 0.1 at least; lengths are up to 450 mm."""

few = settings(attack, max_examples=examples(8, long=25))


@dataclass(frozen=True)
class Kind:
    """A linkage as it is drawn, which closes from position 0 to `motion` [mm or rad].

    Attributes
    ----------
    drawn : the strategy.
    motion : as far as it closes.
    least : a derivative of which less is a matter of rounding.
    mirrored, scaled : what else is the same linkage, in a mirror and in another unit.
    """

    drawn: st.SearchStrategy[Any]
    motion: float
    least: float
    mirrored: Callable[[Any], Any]
    scaled: Callable[[Any, float], Any]


def with_lengths(linkage: SliderCrank, scale: float) -> SliderCrank:
    return replace(linkage, crank=scale * linkage.crank, coupler=scale * linkage.coupler)


KINDS: Final = {
    "slider-crank": Kind(
        slider_cranks(8.0),
        8.0,
        0.01,
        lambda linkage: replace(linkage, mirrored=not linkage.mirrored),
        with_lengths,
    ),
    "four-bar": Kind(
        four_bars(0.6),
        0.6,
        0.01,
        lambda linkage: replace(
            linkage,
            shaft=linkage.shaft.conjugate(),
            lever_angle=-linkage.lever_angle,
            lever_sense=-linkage.lever_sense,
            branch=-linkage.branch,
        ),
        lambda linkage, scale: replace(
            linkage,
            crank=scale * linkage.crank,
            coupler=scale * linkage.coupler,
            lever=scale * linkage.lever,
            shaft=scale * linkage.shaft,
        ),
    ),
    "slider-driven-crank": Kind(
        slider_driven_cranks(0.6),
        0.6,
        1.0,
        lambda linkage: SliderDrivenCrank(
            replace(linkage.inner, mirrored=not linkage.inner.mirrored)
        ),
        lambda linkage, scale: SliderDrivenCrank(with_lengths(linkage.inner, scale)),
    ),
}

by_kind = pytest.mark.parametrize("name", KINDS)


def jets(kind: Kind) -> st.SearchStrategy[FloatArray]:
    """(4, 1) a demanded position in its range and derivatives."""
    values = st.tuples(st.floats(0.0, kind.motion), *[st.floats(-2.0, 2.0)] * 3)
    return values.map(lambda jet: np.array(jet)[:, np.newaxis])


def size(values: FloatArray) -> float:
    return float(np.max(np.abs(values)))


@by_kind
@few
@given(data=st.data())
def test_it_is_the_exact_linkage(name: str, data: st.DataObject) -> None:
    """The follower's motion and three derivatives, by circles that cross in a joint, 50 digits."""
    kind = KINDS[name]
    linkage, jet = data.draw(kind.drawn), data.draw(jets(kind))
    with mp.workdps(50):
        motion, _ = exact_linkage(linkage, *map(mpf, numbers_of(linkage)))
        demanded = [mpf(float(value)) / math.factorial(k) for k, value in enumerate(jet[:, 0])]
        moved = motion(Series(tuple(demanded)))
        expected = np.array([float(moved.derivative(order)) for order in range(4)])
    found = linkage.transform(jet)[:, 0]
    assert found == pytest.approx(expected, rel=ROUNDING, abs=ROUNDING * size(expected))


@by_kind
@attack
@given(data=st.data())
def test_the_joints_of_the_drawing_are_a_loop_that_closes(name: str, data: st.DataObject) -> None:
    """Rods keep their lengths, the tip turns with the crank, the pin is where it is driven to."""
    kind = KINDS[name]
    linkage, count = data.draw(kind.drawn), 65
    position = np.linspace(0.0, kind.motion, count)
    pin, tip = linkage.joints(position)
    assert np.abs(pin - tip) == pytest.approx(np.full(count, linkage.coupler), rel=1e-13)
    assert np.abs(tip) == pytest.approx(np.full(count, linkage.crank), rel=1e-13)
    jet = np.zeros((4, count))
    jet[0], jet[1] = position, 1.0
    moved, rate = linkage.transform(jet)[:2]
    assert moved[0] == 0.0
    # The mean value theorem excludes a turn; a crank that rests, of a kite, rests to rounding.
    assert size(np.diff(moved)) < 2.0 * size(rate) * position[1] + 1e-14 * max(1.0, size(moved))
    driven = isinstance(linkage, SliderDrivenCrank)
    turned = tip[0] * np.exp(1j * (position if driven else moved))
    assert tip == pytest.approx(turned, abs=1e-11)
    if isinstance(linkage, FourBar):
        lever = (pin - linkage.shaft) / (pin[0] - linkage.shaft)
        assert lever == pytest.approx(np.exp(1j * linkage.lever_sense * position), abs=1e-12)
        assert np.all(np.sign(np.imag(np.conj(pin) * tip)) == -linkage.branch)
        return
    inner = linkage.inner if driven else linkage
    stroke = moved if driven else position
    assert pin - pin[0] == pytest.approx(inner.slider_sense * stroke, abs=1e-12 * linkage.coupler)
    if driven:
        assert len(set(np.sign((pin - tip).real))) == 1
    else:
        # +1: the tip lies clockwise of the pin seen from the shaft, the front of the linkage.
        side = np.sign(np.imag(np.conj(pin) * tip)) * (-1.0 if linkage.mirrored else 1.0)
        assert np.all(side == -linkage.branch)


@by_kind
@few
@given(data=st.data())
def test_the_mirror_image_goes_the_other_way(name: str, data: st.DataObject) -> None:
    kind = KINDS[name]
    linkage, jet = data.draw(kind.drawn), data.draw(jets(kind))
    one, other = linkage.transform(jet), kind.mirrored(linkage)
    # A crank that is driven turns the other way; else the crank that follows does.
    image = other.transform(-jet) if name == "slider-driven-crank" else -other.transform(jet)
    assert image == pytest.approx(one, rel=ROUNDING, abs=ROUNDING * size(one))


@by_kind
@pytest.mark.parametrize("scale", [1e-3, 1e3])
@few
@given(data=st.data())
def test_the_unit_does_not_matter(scale: float, name: str, data: st.DataObject) -> None:
    kind = KINDS[name]
    linkage, jet = data.draw(kind.drawn), data.draw(jets(kind))
    slides, driven = name == "slider-crank", name == "slider-driven-crank"
    one = linkage.transform(jet) * (scale if driven else 1.0)
    other = kind.scaled(linkage, scale).transform(scale * jet if slides else jet)
    allowed = ROUNDING * max(size(one), scale * linkage.coupler if driven else 0.0)
    assert other == pytest.approx(one, rel=ROUNDING, abs=allowed)


@by_kind
@few
@given(data=st.data())
def test_each_derivative_is_the_derivative_of_the_one_before(
    name: str, data: st.DataObject
) -> None:
    kind = KINDS[name]
    motion = LinkedMotion(data.draw(plans(SMOOTH, kind.motion)), data.draw(kind.drawn))
    low, high = cells(motion.borders, 6)
    change = motion.jet(high, "left")[:3] - motion.jet(low, "right")[:3]
    found = integrals(lambda phi: motion.jet(phi)[1:], low, high)
    sizes = np.max(np.abs(motion.jet(np.linspace(0.0, TURN, 241))), axis=1)[:3, np.newaxis]
    assert np.all(np.abs(found - change) <= ROUNDING * np.maximum(sizes, kind.least))


@by_kind
@few
@given(data=st.data(), count=st.integers(1, 6))
def test_bounds_hold_all_over_their_cells_and_close_on_small_ones(
    name: str, data: st.DataObject, count: int
) -> None:
    kind = KINDS[name]
    motion = LinkedMotion(data.draw(plans(SMOOTH, kind.motion)), data.draw(kind.drawn))
    low, high = cells(motion.borders, count)
    bounds = motion.jet_and_bounds(low, high)[1]
    middle = motion.jet(0.5 * (low + high))[0]
    sizes = np.max(np.abs(motion.jet(np.linspace(0.0, TURN, 241))), axis=1)[:, np.newaxis]
    for share in np.linspace(0.0, 1.0, 25):
        phi = np.clip(low + share * (high - low), low, high)
        values = motion.jet(phi, "left" if share == 1.0 else "right").copy()
        values[0] -= middle
        assert np.all(np.abs(values) <= bounds + ROUNDING * np.maximum(sizes, kind.least))
    coarse, fine = (motion.jet_and_bounds(*cells(motion.borders, n))[1] for n in (64, 128))
    assert np.all(np.isfinite(coarse))
    assert np.max(fine[0]) <= 0.7 * np.max(coarse[0]) + 1e-15


LEVER: Final = FourBar(40.0, 70.0, 50.0, 90.0 + 10.0j, math.radians(95.0), -1, 1)
SLIDER: Final = SliderCrank(40.0, 60.0, math.radians(30.0), True, 1, 1, 1)
CRANK: Final = SliderDrivenCrank(SliderCrank(60.0, 50.0, math.radians(-25.0), True, 1, -1, 1))

DEAD: Final[tuple[tuple[Any, float, int, int], ...]] = (
    (LEVER, 4.0, 0, 1),
    (LEVER, 4.0, 1, -1),
    (LEVER, 4.0, 2, 1),
    (SLIDER, 150.0, 0, 1),
    (SLIDER, 150.0, 1, -1),
    (CRANK, 2.0, 0, 1),
    (CRANK, 2.0, 1, -1),
)
"""A linkage, how far to look for dead centres, which of them, and the side on which it closes."""


@pytest.mark.parametrize(("linkage", "reach", "number", "side"), DEAD)
def test_bounds_are_close_next_to_a_dead_centre(
    linkage: Any, reach: float, number: int, side: int
) -> None:
    """They exceed the values by at most a factor of 2.

    The width of a cell is a fiftieth of its distance from the dead centre. Values change with that
    distance, so bounds are compared with the largest one nearby.
    """
    dead = sorted(linkage.dead_positions(-reach, reach))[number]
    for distance in (1e-1, 1e-2, 1e-3, 1e-4):
        places = dead + side * distance * np.linspace(0.5, 1.5, 41)
        jet = np.zeros((4, len(places)))
        jet[0], jet[1] = places, 1.0
        largest = np.max(np.abs(linkage.transform(jet)), axis=1)
        bounds = np.array([[0.01 * distance], [1.0], [0.0], [0.0]])
        found = linkage.transform_bounds(jet[:, 20:21], bounds)[:, 0]
        assert np.all(found[1:] <= 2.0 * np.maximum(largest[1:], 0.1))
