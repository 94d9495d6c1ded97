"""The exact outlines of the suite against the reference collection, closed forms and geometry."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest
from mpmath import mp, mpf

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from tests.reference import hard_case
from tests.stability.cam_case import CamSpec
from tests.stability.exact_outline import ROLLER, ExactOutline
from tests.stability.outlines import INNER, OUTER, flanks

DIGITS = 60

PRINTED = mpf(10) ** -25
"""The reference prints 30 digits of angles up to 100 degrees, its last ones rounded."""

GUESSES = {
    "HC21c swallow tail": (73.07, 84.28),
    "HC22 neck of a lobe": (11.606, 88.394),
    "HC22b neck of a lobe": (11.722, 90.278),
    "neck and tail, offset": (12.2, 97.0),
    "tail of a rocker": (78.5776, 82.9008),
    "tail of an outer flank": (36.8388, 38.9379),
}
"""First digits of the cam angles [degrees] of the crossing at which the disc ends."""


def exact(name: str) -> tuple[ExactOutline, list[Any]]:
    spec, side = next(each for each in flanks() if each[0].name == name)
    outline = ExactOutline(spec, side)
    return outline, [mpf(number) for number in outline.parameters]


def crossing(name: str, numbers: list[Any] | None = None) -> tuple[Any, Any, Any]:
    outline, own = exact(name)
    first, second = GUESSES[name]
    return outline.crossing(
        (mp.radians(mpf(first)), mp.radians(mpf(second))), own if numbers is None else numbers
    )


def decimal(name: str) -> list[Any]:
    """The numbers of a hard case of a vertical guide, exactly as their decimals state."""
    params, _ = hard_case(name)
    spans = [mpf(span) for span in params["phi_H"]]
    joints = [mp.radians(sum(spans[:count])) for count in (1, 2, 3, 4)]
    lengths = [mpf(params[key]) for key in ("r_R", "r_G", "e")]
    return [*joints, mpf(params["s_H"]), mpf("0.5"), *lengths, mp.pi / 2]


def test_hc21c() -> None:
    _, expected = hard_case("HC21c")
    with mp.workdps(DIGITS):
        x, y, point = crossing("HC21c swallow tail", decimal("HC21c"))
        assert abs(mp.degrees(x) - mpf(expected["crossing_phi1_deg"])) < PRINTED
        assert abs(mp.degrees(y) - mpf(expected["crossing_phi2_deg"])) < PRINTED
        assert abs(point - mp.mpc(*map(mpf, expected["crossing_point"]))) < PRINTED


@pytest.mark.parametrize("name", ["HC22", "HC22b"])
def test_necks(name: str) -> None:
    _, expected = hard_case(name)
    with mp.workdps(DIGITS):
        x, y, point = crossing(f"{name} neck of a lobe", decimal(name))
        assert abs(mp.degrees(x) - mpf(expected["self_intersections_on_axis_phi_deg"][0])) < PRINTED
        assert abs(mp.degrees(y) - mpf(expected["mirror_phi_deg"][0])) < PRINTED
        assert abs(abs(point) - mpf(expected["radial_position_mm"][0])) < PRINTED


@pytest.mark.parametrize("name", GUESSES)
def test_a_crossing_is_passed_twice(name: str) -> None:
    outline, numbers = exact(name)
    with mp.workdps(DIGITS):
        x, y, point = crossing(name)
        assert y - x > 1e-2
        for phi in (x, y):
            assert abs(outline.flank(phi, numbers)[0] - point) < mpf(10) ** -(DIGITS - 10)


def test_where_a_flank_does_not_cross_itself_there_is_no_crossing() -> None:
    """Without undercut Newton's steps lead nowhere, or to one place twice."""
    spec, _ = flanks()[0]
    small = replace(spec, follower=TranslatingRoller(25.0, 8.0))
    outline = ExactOutline(small, INNER)
    with mp.workdps(DIGITS), pytest.raises(GeometryError, match="does not cross itself there"):
        outline.crossing((mpf("1.27"), mpf("1.47")), [mpf(v) for v in outline.parameters])


# Areas --------------------------------------------------------------------------------------------

CIRCLES = (
    TranslatingRoller(50.0, 10.0, 12.0),
    OscillatingRoller(complex(70.0, -55.0), 64.0, 45.0, 6.0, -1, 1),
)


@pytest.mark.parametrize("follower", CIRCLES)
@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize("side", [INNER, OUTER])
def test_without_a_stroke_the_disc_is_a_circle(follower: Any, rotation: int, side: int) -> None:
    """In the rest it is cut nowhere: from a cam angle to itself nothing is missing."""
    spec = CamSpec("", ("30", "60", "40", "80", "150"), 0.0, follower, rotation=rotation)
    outline = ExactOutline(spec, side)
    with mp.workdps(DIGITS):
        numbers = [mpf(number) for number in outline.parameters]
        found = outline.area(mpf(2), mpf(2), numbers)
        radius = mpf(follower.base_radius) + side * mpf(follower.roller_radius)
        assert abs(found - mp.pi * radius**2) < mpf(10) ** -(DIGITS - 10) * found


@pytest.mark.parametrize(
    "name",
    [
        "HC21c swallow tail",
        "tail of a rocker",
        pytest.param("HC22 neck of a lobe", marks=pytest.mark.long),  # a guide, as HC21c
        pytest.param("tail of an outer flank", marks=pytest.mark.long),
    ],
)
def test_an_area_is_the_integral_over_its_border(name: str) -> None:
    """Green's integral of the flank itself, by quadrature in short steps; to 1/100 of an ulp."""
    outline, numbers = exact(name)

    def across(phi: Any) -> Any:
        point, pace = outline.flank(phi, numbers)
        return mp.im(mp.conj(point) * pace) / 2

    with mp.workdps(30):
        x, y, _ = crossing(name)
        total = mpf(0)
        joints = (mpf(0), *numbers[:4], 2 * mp.pi)
        for number, (start, end) in enumerate(pairwise(joints)):
            for low, high in ((start, min(end, x)), (max(start, y), end)):
                if low < high and number % 2 == 0:
                    total += (high - low) * across((low + high) / 2)
                elif low < high:
                    marks = mp.linspace(low, high, 5)
                    total += mp.quad(across, marks, maxdegree=4, method="gauss-legendre")
        assert abs(abs(total) - outline.area(x, y, numbers)) < mpf(10) ** -18 * abs(total)


# The roller on a corner ---------------------------------------------------------------------------


@pytest.mark.parametrize("name", GUESSES)
def test_a_roller_on_a_corner_touches_it(name: str) -> None:
    """The follower at its actual lift has the roller's radius between its centre and the corner."""
    outline, numbers = exact(name)
    with mp.workdps(DIGITS):
        x, y, corner = crossing(name)
        for share in (0.05, 0.4, 0.9):
            phi = x + share * (y - x)
            lift = outline.actual(phi, corner, numbers, 1).terms[0]
            demanded = outline.jet(phi, numbers, 1).lift.terms[0]
            loss = outline.loss(phi, corner, numbers, 1).terms[0]
            assert loss > 0
            assert abs(abs(lift - demanded) - loss) < mpf(10) ** -(DIGITS - 10)
            # A rest at the actual lift.
            at = (numbers[0], numbers[1], lift, lift, *numbers[5:])
            centre = outline.spec.stage.jet(phi, at, 2).centre.terms[0]
            gap = abs(centre - corner) - numbers[ROLLER]
            assert abs(gap) < mpf(10) ** -(DIGITS - 10)


@pytest.mark.parametrize("name", GUESSES)
def test_nothing_is_lost_at_the_ends_of_what_is_missing(name: str) -> None:
    """There the roller that touches the corner is the demanded one, and rolls on to it smoothly."""
    outline, numbers = exact(name)
    with mp.workdps(DIGITS):
        x, y, corner = crossing(name)
        for phi in (x, y):
            loss = outline.loss(phi, corner, numbers, 3)
            assert abs(loss.terms[0]) < mpf(10) ** -(DIGITS - 12)
            assert abs(loss.terms[1]) < mpf(10) ** -(DIGITS - 12)
            assert loss.terms[2] > 0


@pytest.mark.parametrize("name", GUESSES)
def test_the_largest_loss_is_larger_than_its_neighbours(name: str) -> None:
    outline, numbers = exact(name)
    with mp.workdps(DIGITS):
        x, y, corner = crossing(name)
        losses: list[Any] = []
        guess, reach = (x + y) / 2, (y - x) / 2
        for _ in range(3):  # each time about the best place so far, in a twentieth of the range
            samples = [guess + reach * k / 20 for k in range(-19, 20)]
            losses = [outline.loss(phi, corner, numbers, 1).terms[0] for phi in samples]
            guess, reach = samples[losses.index(max(losses))], reach / 10
        place = outline.place_of_largest_loss(guess, corner, numbers)
        assert x < place < y
        top = outline.loss(place, corner, numbers, 1).terms[0]
        assert top >= max(losses)
        assert abs(place - guess) < reach
