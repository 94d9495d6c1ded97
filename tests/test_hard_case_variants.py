"""Variants of the hard cases with other numbers, held to mpmath at 60 digits.

The oracle below knows the engine's inputs and none of its formulas: laws by their textbook
polynomials, W in the fixed frame, Z = W exp(-i sigma phi) by the product rule, curvature from Z'
and Z''. Joints are taken as the engine takes them, degrees rounded to radians once.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cached_property, partial
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from mpmath import mp, mpc, mpf

from camgeo.check.disc import check_standstill, check_undercut
from camgeo.check.finding import Finding
from camgeo.check.machine import check_follower, check_linkage
from camgeo.design.design import Design
from camgeo.design.value_table import radius_of_curvature
from camgeo.errors import GeometryError
from camgeo.geometry.outline.outline import find_crossings, undercut_ranges
from camgeo.geometry.pieces import curvature_extremes
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.linkage import LinkedMotion
from camgeo.kinematics.mechanism.linkages import SliderCrank
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import roots_on_grid
from camgeo.scene.scene import parse_scene
from camgeo.units import TURN
from tests.findings import known
from tests.reference import POLYNOMIAL, inner_of, shift
from tests.strategies import attack, signs, with_roller

Number = Any
"""mpmath's numbers have no types."""


EPS = 2.0**-53


DIGITS = 60


ROUNDINGS = 64.0
"""Roundings of half an ulp of the largest term on the way to any quantity: a law's 15, the sine and
cosine of the axis, four products a derivative; some enter cubed. What a cam angle and the joints
lose is counted apart."""


ANGLE = 4.0 * math.ulp(TURN)
"""Error of a cam angle counted from a joint: rounding of the joint and of the difference."""


# The oracle -------------------------------------------------------------------------------------


def polynomial_345(z: Number) -> list[Number]:
    """f to f''' by VDI 2143-1 (33) to (35)."""
    return [
        10 * z**3 - 15 * z**4 + 6 * z**5,
        30 * z**2 - 60 * z**3 + 30 * z**4,
        60 * z - 180 * z**2 + 120 * z**3,
        60 - 360 * z + 360 * z**2,
    ]


def skew(z: Number, lam: Number) -> list[Number]:
    """The law with its inflection at lambda, by mechanisms.md section 2 in z alone."""
    if z < lam:
        inner, stretch, f0 = z / (2 * lam), 2 * lam, mpf(0)
        f = polynomial_345(inner)
        first = f0 + stretch * f[0]
    else:
        stretch = 2 * (1 - lam)
        f = polynomial_345(mpf(1) / 2 + (z - lam) / stretch)
        first = lam + stretch * (f[0] - mpf(1) / 2)
    return [first, f[1], f[2] / stretch, f[3] / stretch**2]


@dataclass(frozen=True)
class Oracle:
    """A pitch curve with polynomials 3-4-5 and either follower, in mpmath."""

    curve: PitchCurve

    @cached_property
    def spans(self) -> list[tuple[Number, Number, Number, Number, Number]]:
        """Start, end, position before, stroke and lambda of every segment."""
        plan = self.curve.motion
        assert isinstance(plan, MotionPlan)
        found, position = [], 0.0
        for number, segment in enumerate(plan.segments):
            start, end = (math.radians(float(plan.joints_deg[number + k])) for k in (0, 1))
            if isinstance(segment, Dwell):
                found.append((mpf(start), mpf(end), mpf(position), mpf(0), mpf(0.5)))
                continue
            assert isinstance(segment, Move)
            assert segment.law.name == "polynomial-345"
            lam = mpf(segment.law.inflection)
            stroke = mpf(segment.to) - mpf(position)
            found.append((mpf(start), mpf(end), mpf(position), stroke, lam))
            position = segment.to
        return found

    def lift(self, phi: Number) -> list[Number]:
        """s to s''' from the right."""
        for start, end, position, stroke, lam in reversed(self.spans):
            if phi >= start and end > start:
                if stroke == 0:
                    return [position, mpf(0), mpf(0), mpf(0)]
                span = end - start
                law = skew((phi - start) / span, lam)
                jet = [stroke * f / span**k for k, f in enumerate(law)]
                return [position + jet[0], *jet[1:]]
        raise AssertionError("no segment")

    @cached_property
    def start_angle(self) -> Number:
        follower = self.curve.follower
        assert isinstance(follower, OscillatingRoller)
        l1 = mp.hypot(mpf(follower.pivot.real), mpf(follower.pivot.imag))
        l3, base = mpf(follower.arm), mpf(follower.base_radius)
        return mp.acos((l1**2 + l3**2 - base**2) / (2 * l1 * l3))

    def fixed(self, phi: Number) -> tuple[list[Number], float]:
        """W to W''' in the fixed frame, and the largest term in W."""
        s = self.lift(phi)
        follower = self.curve.follower
        if isinstance(follower, TranslatingRoller):
            e, base = mpf(follower.offset), mpf(follower.base_radius)
            turn = mp.expj(mpf(follower.guide_angle) - mp.pi / 2)
            height = mp.sqrt(base**2 - e**2) + follower.direction * s[0]
            w = [e + 1j * height, *(1j * follower.direction * each for each in s[1:])]
            size = float(base + abs(s[0]))
            return [turn * each for each in w], size
        assert isinstance(follower, OscillatingRoller)
        pivot = mpc(follower.pivot)
        l1, l3 = abs(pivot), mpf(follower.arm)
        sense = follower.swing_sense
        chi = follower.arm_side * self.start_angle + sense * s[0]
        c1, c2, c3 = (sense * each for each in s[1:])
        tip = -pivot / l1 * l3 * mp.expj(chi)
        w = [
            tip + pivot,
            1j * c1 * tip,
            (1j * c2 - c1**2) * tip,
            (1j * c3 - 3 * c1 * c2 - 1j * c1**3) * tip,
        ]
        return w, float(l1 + l3)

    def jet(self, phi: Number) -> tuple[list[Number], list[float]]:
        """Z to Z''' and the sums of the magnitudes of their terms."""
        w, size = self.fixed(phi)
        turn = -1j * self.curve.rotation
        powers = [turn**k for k in range(4)]  # exact: they are 1, i, -1 and -i
        phase = mp.exp(turn * phi)
        z = [
            phase * sum(math.comb(k, j) * powers[k - j] * w[j] for j in range(k + 1))
            for k in range(4)
        ]
        sizes = [size, *(float(abs(each)) for each in w[1:])]
        terms = [sum(math.comb(k, j) * sizes[j] for j in range(k + 1)) for k in range(4)]
        return z, terms

    def curvature(self, phi: Number) -> Number:
        """kappa, positive where convex."""
        (_, z1, z2, _), _ = self.jet(phi)
        return -self.curve.rotation * (mp.conj(z1) * z2).imag / abs(z1) ** 3

    def inner(self, phi: Number) -> Number:
        """The point of the inner flank."""
        return self.quantities(phi)["inner"][0]

    def quantities(self, phi: Number) -> dict[str, tuple[Number, float]]:
        """All quantities with the size of the terms that they are made of."""
        z, terms = self.jet(phi)
        speed = abs(z[1])
        normal = -1j * self.curve.rotation * z[1] / speed
        roller = mpf(self.curve.follower.roller_radius)
        kappa = -self.curve.rotation * (mp.conj(z[1]) * z[2]).imag / speed**3
        # tan mu = |u|/|v|: v along the rocker, or across the guide, as it lies in the cam.
        w, _ = self.fixed(phi)
        follower = self.curve.follower
        if isinstance(follower, TranslatingRoller):
            along = mp.expj(mpf(follower.guide_angle))
        else:
            assert isinstance(follower, OscillatingRoller)
            along = 1j * (w[0] - mpc(follower.pivot))
            along /= abs(along)
        path = z[1] * mp.conj(along * mp.exp(-1j * self.curve.rotation * phi))
        mu = mp.atan2(abs(path.imag), abs(path.real))
        lost = terms[1] / float(speed)  # the digits that Z' has lost
        return {
            **{f"Z{k}": (z[k], terms[k]) for k in range(4)},
            "inner": (z[0] + normal * roller, terms[0] + lost * float(roller)),
            "outer": (z[0] - normal * roller, terms[0] + lost * float(roller)),
            "curvature": (
                kappa,
                (terms[1] * float(abs(z[2])) / float(speed) + terms[2]) / float(speed) ** 2
                + 3.0 * float(abs(kappa)) * lost,
            ),
            "mu": (mu, lost),
            "pressure": (mp.pi / 2 - mu, lost),
        }


def found(curve: PitchCurve, phi: FloatArray) -> dict[str, Any]:
    """The engine's quantities."""
    jets = curve.jet(phi)
    return {
        **{f"Z{k}": jets[k] for k in range(4)},
        "inner": inner_of(curve).point(phi),
        "outer": WorkingCurve(curve, curve.follower.roller_radius).point(phi),
        "curvature": curve.curvature(phi),
        "mu": curve.transmission_angle(phi),
        "pressure": curve.pressure_angle(phi),
    }


def finite_or_refused(quantity: Callable[[], Any], words: str = "") -> None:
    """Request a quantity: either all of it is finite, or an error states why there is none."""
    try:
        values = quantity()
    except GeometryError as error:
        refusal: str | None = error.message
    else:
        refusal = None
        assert np.all(np.isfinite(values))
    if refusal is not None:
        assert refusal
        assert words in refusal


def hold(curve: PitchCurve, phi: FloatArray) -> None:
    """Hold all quantities at `phi` to the oracle: within ROUNDINGS of half an ulp of their terms,
    and within what a cam angle and the lengths that the triangle is made of have been rounded by.
    """
    values = found(curve, phi)
    oracle = Oracle(curve)
    with mp.workdps(DIGITS):
        for number, place in enumerate(phi):
            exact = oracle.quantities(mpf(float(place)))
            near = [oracle.quantities(mpf(float(place)) + sign * mpf(ANGLE)) for sign in (1, -1)]
            for name, (true, terms) in exact.items():
                value = values[name][number]
                assert np.isfinite(value), (name, place)
                moved = max(float(abs(each[name][0] - true)) for each in near)
                error = float(abs(mpc(complex(value)) - true))
                limit = ROUNDINGS * EPS * terms + moved
                assert error <= limit, (name, float(place), error, limit)


def assert_finite(findings: Any) -> None:
    """No number of a finding is NaN or infinite."""
    for finding in findings:
        assert isinstance(finding, Finding)
        numbers = [finding.value, finding.limit, finding.cam_angle, *(finding.cam_range or ())]
        assert all(math.isfinite(n) for n in numbers if n is not None), finding
        assert "nan" not in finding.sentence.split()
        assert "inf" not in finding.sentence.split()


# Cams -------------------------------------------------------------------------------------------


def polynomials(
    spans: tuple[int | str | Decimal, ...], stroke: float, rise: float = 0.5, back: float = 0.5
) -> MotionPlan:
    """Rest, rise, rest, return, rest by 3-4-5 polynomials with these inflections."""
    first, up, second, down, last = (Decimal(str(span)) for span in spans)
    return MotionPlan(
        (
            Dwell(first),
            Move(up, stroke, shift(POLYNOMIAL, rise)),
            Dwell(second),
            Move(down, 0.0, shift(POLYNOMIAL, back)),
            Dwell(last),
        )
    )


@st.composite
def five_spans(draw: st.DrawFn) -> tuple[int, ...]:
    """Spans of rest, rise, rest, return, rest; rests may have length zero."""
    up, down = draw(st.integers(30, 130)), draw(st.integers(30, 130))
    left = 360 - up - down
    first = draw(st.integers(0, left))
    second = draw(st.one_of(st.just(0), st.integers(0, left - first)))
    return first, up, second, down, left - first - second


@st.composite
def cams(draw: st.DrawFn, part: float = 0.5, translating: bool | None = None) -> PitchCurve:
    """A cam of a base radius of 20 to 80 mm and a stroke up to `part` of it."""
    base = draw(st.floats(20.0, 80.0))
    share = part * draw(st.floats(0.05, 1.0))
    spans, sigma = draw(five_spans()), draw(signs())
    roller = base * draw(st.floats(0.05, 0.3))
    if translating if translating is not None else draw(st.booleans()):
        follower = TranslatingRoller(base, roller, offset=base * draw(st.floats(-0.4, 0.4)))
        return PitchCurve(polynomials(spans, share * base), follower, sigma)
    distance, arm = base * draw(st.floats(1.5, 2.0)), base * draw(st.floats(1.2, 1.5))
    rocker = OscillatingRoller(complex(-distance, 0.1 * base), arm, base, roller, draw(signs()), 1)
    return PitchCurve(polynomials(spans, share * base / arm), rocker, sigma)


def spread(count: int) -> FloatArray:
    """Cam angles that are no joints."""
    return np.array([(k + 0.37) * TURN / count for k in range(count)])


# Ordinary cams, so that the oracle itself is known to be one ------------------------------------


@attack
@given(curve=cams())
def test_ordinary_cams(curve: PitchCurve) -> None:
    hold(curve, spread(5))


def test_the_oracle_sees_what_is_wrong() -> None:
    """A stroke 1e-12 of itself too large, and the other sense."""
    follower = TranslatingRoller(50.0, 10.0, offset=10.0)
    spans = (30, 100, 40, 120, 70)
    curve = PitchCurve(polynomials(spans, 20.0), follower, 1)
    wrong = PitchCurve(polynomials(spans, 20.0 * (1.0 + 1e-12)), follower, 1)
    phi = np.radians([80.0])
    hold(curve, phi)
    values = found(wrong, phi)
    with mp.workdps(DIGITS):
        exact = Oracle(curve).quantities(mpf(phi[0]))
        for name in ("Z0", "Z1", "inner", "curvature"):
            true, terms = exact[name]
            assert abs(mpc(complex(values[name][0])) - true) > ROUNDINGS * EPS * terms


# HC21: rollers at the cusp limit and next to it -------------------------------------------------


def tightest(curve: PitchCurve) -> tuple[Number, Number]:
    """Largest curvature and its cam angle, by mpmath from the engine's place."""
    oracle = Oracle(curve)
    _, phi = curvature_extremes(curve).largest()

    def slope(angle: Number) -> Number:
        return mp.diff(oracle.curvature, angle, h=mpf(10) ** -20)

    place = mp.findroot(slope, (mpf(phi) - mpf(10) ** -7, mpf(phi) + mpf(10) ** -7), tol=1e-30)
    return oracle.curvature(place), place


TIGHT = [
    (25.0, 0.0, 20.0, (30, 60, 40, 80, 150), 1),
    (25.0, 0.0, 20.0, (30, 60, 40, 80, 150), -1),
    (40.0, 12.0, 31.0, (20, 70, 25, 95, 150), 1),
    (18.0, -7.5, 14.0, (10, 55, 5, 60, 230), -1),
    (60.0, 20.0, 55.0, (0, 75, 0, 130, 155), 1),
]
"""Base radius, offset, stroke, spans and sense of cams whose tightest place is within a rise or a
return, not on a rest and not at a joint."""


def each_with(sizes: list[float]) -> list[Any]:
    """Each cam with each size; in the usual form each cam with two of them and each size with two
    cams or more.
    """
    pairs = [(cam, size) for cam in range(len(TIGHT)) for size in range(len(sizes))]
    return [
        pytest.param(
            TIGHT[cam],
            sizes[size],
            marks=[] if (size - cam) % len(sizes) < 2 else pytest.mark.long,
            id=f"{cam}-{sizes[size]}",
        )
        for cam, size in pairs
    ]


def tight_cam(cam: tuple[float, float, float, tuple[int, ...], int], roller: float) -> PitchCurve:
    base, offset, stroke, spans, sigma = cam
    return PitchCurve(polynomials(spans, stroke), TranslatingRoller(base, roller, offset), sigma)


@pytest.mark.parametrize(("cam", "excess"), each_with([0.0, 1e-3, 1e-6, 1e-9]))
def test_hc21_rollers_above_the_cusp_limit(
    cam: tuple[float, float, float, tuple[int, ...], int], excess: float
) -> None:
    curve = tight_cam(cam, 1.0)
    with mp.workdps(50):
        kappa, place = tightest(curve)
        roller = float((1 + mpf(excess)) / kappa)
        curve = with_roller(curve, roller)
        flank, bends = inner_of(curve), curvature_extremes(curve)
        margin = 1 - mpf(roller) * kappa
        findings = check_undercut(flank, "inner", bends)
        assert all(finding.severity == "no-disc" for finding in findings)
        # A second place as tight as the first would make these two.
        (finding,) = findings
        assert abs(known(finding.value) - margin) <= ROUNDINGS * EPS
        if excess == 0.0:
            assert finding.name == "cusp-inner"
            # Where |kappa - kappa_max| is lost in its rounding.
            bend = abs(mp.diff(Oracle(curve).curvature, place, 2)) * mpf(roller)
            flat = mp.sqrt(2 * ROUNDINGS * EPS / bend)
            assert abs(known(finding.cam_angle) - place) <= flat
            return
        assert finding.name == "undercut-inner"
        ((start, end),) = undercut_ranges(flank, bends)
        assert finding.cam_range == (start, end)
        oracle = Oracle(curve)
        for found_at, side in ((start, -1), (end, 1)):
            bend = abs(mp.diff(oracle.curvature, place, 2)) * mpf(roller)
            guess = place + side * mp.sqrt(2 * mpf(excess) / bend)
            cusp = mp.findroot(lambda angle: 1 - mpf(roller) * oracle.curvature(angle), guess)
            slope = abs(mp.diff(oracle.curvature, cusp)) * mpf(roller)
            # 1 + d kappa is a rounding of 1, and only the slope there gives the angle.
            assert abs(found_at - cusp) <= ROUNDINGS * EPS / slope + ANGLE


@pytest.mark.parametrize(("cam", "deficit"), each_with([1e-3, 1e-6, 1e-9]))
def test_hc21_rollers_below_the_cusp_limit_fit(
    cam: tuple[float, float, float, tuple[int, ...], int], deficit: float
) -> None:
    curve = tight_cam(cam, 1.0)
    with mp.workdps(50):
        kappa, _ = tightest(curve)
        roller = float((1 - mpf(deficit)) / kappa)
    curve = with_roller(curve, roller)
    (finding,) = check_undercut(inner_of(curve), "inner", curvature_extremes(curve))
    assert finding.severity == "ok"
    assert finding.value == pytest.approx(deficit, abs=ROUNDINGS * EPS)
    assert undercut_ranges(inner_of(curve), curvature_extremes(curve)) == []


# HC11, HC12: strokes far below the base radius --------------------------------------------------


@pytest.mark.parametrize(("base", "sigma"), [(100.0, -1), (37.5, 1), (1e-3, -1), (1e6, 1)])
@pytest.mark.parametrize("share", [1e-8, 1e-12])
def test_hc11_tiny_strokes(base: float, share: float, sigma: int) -> None:
    stroke = share * base
    spans = (90, 90, 0, 90, 90)
    phi = np.radians([100.0, 112.5, 135.0, 171.3, 200.0, 259.9])
    for offset in (0.0, 0.3 * base):
        cam = TranslatingRoller(base, 0.2 * base, offset)
        hold(PitchCurve(polynomials(spans, stroke), cam, sigma), phi)
    rocker = OscillatingRoller(complex(-1.5 * base, base), 1.2 * base, base, 0.2 * base)
    hold(PitchCurve(polynomials(spans, share), rocker, sigma), phi)


@attack
@given(
    share=st.floats(-12.0, -3.0).map(lambda exponent: 10.0**exponent),
    place=st.floats(91.0, 179.0),
)
def test_hc11_what_depends_on_a_tiny_stroke_alone_keeps_all_digits(
    share: float, place: float
) -> None:
    """Without offset the pressure angle is arctan(s'/(r_G + s)): as exact as the stroke."""
    curve = PitchCurve(
        polynomials((90, 90, 0, 90, 90), 100.0 * share), TranslatingRoller(100.0, 10.0), 1
    )
    phi = np.radians([place])
    with mp.workdps(DIGITS):
        s = Oracle(curve).lift(mpf(phi[0]))
        exact = float(mp.atan(s[1] / (100 + s[0])))
        lift = [float(each) for each in s]
    # z has lost what phi - phi_1 has: an ulp of pi of 1 degree at least, and a power of z has five
    # times that.
    lost = 5.0 * math.ulp(math.pi) / math.radians(1.0)
    assert curve.pressure_angle(phi)[0] == pytest.approx(exact, rel=ROUNDINGS * EPS + lost)
    assert curve.motion.jet(phi)[0, 0] == pytest.approx(lift[0], rel=ROUNDINGS * EPS + lost)
    assert curve.motion.jet(phi)[1, 0] == pytest.approx(lift[1], rel=ROUNDINGS * EPS + lost)


# HC13: inflections within a millionth of their limits -------------------------------------------


@pytest.mark.parametrize(
    ("lam", "sigma"), [(1e-6, 1), (3e-6, -1), (1e-4, 1), (1.0 - 1e-6, -1), (1.0 - 3e-6, 1)]
)
def test_hc13_inflections_near_their_limits_in_whole_cams(lam: float, sigma: int) -> None:
    spans = (30, 100, 40, 120, 70)
    rise, back = math.radians(30.0), math.radians(290.0)
    near = [share * lam * math.radians(100.0) for share in (0.25, 0.5, 0.99, 1.01, 2.0)]
    if lam > 0.5:
        near = [math.radians(100.0) * (1.0 - (1.0 - lam) * s) for s in (0.25, 0.5, 0.99, 1.01)]
    phi = np.array([*(rise + each for each in near), 1.0, 2.2, 3.5, 4.9, back - 1e-3])
    for stroke in (20.0, 1e-3):
        curve = PitchCurve(
            polynomials(spans, stroke, lam, 1.0 - lam), TranslatingRoller(50.0, 10.0, 12.0), sigma
        )
        hold(curve, phi)
        rocker = OscillatingRoller(complex(-90.0, 20.0), 70.0, 50.0, 8.0)
        hold(PitchCurve(polynomials(spans, 0.02 * stroke, lam, lam), rocker, sigma), phi)


def test_hc13_findings_of_a_cam_with_such_a_law() -> None:
    """f'' = 2.9 10^6: curvature and undercut are reported, over a range of some 1e-5 degrees."""
    curve = PitchCurve(
        polynomials((30, 100, 40, 120, 70), 20.0, 1e-6, 0.5), TranslatingRoller(50.0, 10.0), 1
    )
    assert_finite(check_undercut(inner_of(curve), "inner", curvature_extremes(curve)))
    outer = WorkingCurve(curve, 10.0)
    findings = check_undercut(outer, "outer", curvature_extremes(curve))
    assert_finite(findings)
    start, end = findings[0].cam_range or (0.0, 0.0)
    # f'' is 60 u (1 - u)(1 - 2 u)/(2 lambda), u = z/(2 lambda): concave from near the joint on.
    assert math.radians(30.0) <= start < end <= math.radians(30.0 + 1.01e-4)


# HC09: rests of zero length ---------------------------------------------------------------------


@attack
@given(curve=cams(), places=st.lists(st.integers(0, 5), min_size=1, max_size=4))
def test_hc09_rests_of_zero_length_change_nothing(curve: PitchCurve, places: list[int]) -> None:
    plan = curve.motion
    assert isinstance(plan, MotionPlan)
    segments = list(plan.segments)
    for place in places:
        segments.insert(place, Dwell(Decimal(0)))
    padded = replace(curve, motion=MotionPlan(tuple(segments)))
    phi = np.concatenate((spread(40), np.radians([float(joint) for joint in plan.joints_deg])))
    sides: tuple[Side, ...] = ("left", "right")
    for side in sides:
        assert np.array_equal(curve.jet(phi, side), padded.jet(phi, side))
    bends, others = curvature_extremes(curve), curvature_extremes(padded)
    assert np.array_equal(bends.phi, others.phi)
    assert check_undercut(inner_of(curve), "inner", bends) == check_undercut(
        inner_of(padded), "inner", others
    )


# Scales -----------------------------------------------------------------------------------------


SCALES = [1e-6, 1e-3, 1e3, 1e6]


def scaled(curve: PitchCurve, factor: float) -> PitchCurve:
    """The same cam, all lengths times `factor`."""
    follower, plan = curve.follower, curve.motion
    assert isinstance(plan, MotionPlan)
    if isinstance(follower, TranslatingRoller):
        segments = [
            replace(segment, to=factor * segment.to) if isinstance(segment, Move) else segment
            for segment in plan.segments
        ]
        other = replace(
            follower,
            base_radius=factor * follower.base_radius,
            roller_radius=factor * follower.roller_radius,
            offset=factor * follower.offset,
        )
        return PitchCurve(MotionPlan(tuple(segments)), other, curve.rotation)
    assert isinstance(follower, OscillatingRoller)
    rocker = replace(
        follower,
        pivot=factor * follower.pivot,
        arm=factor * follower.arm,
        base_radius=factor * follower.base_radius,
        roller_radius=factor * follower.roller_radius,
    )
    return replace(curve, follower=rocker)


@attack
@given(curve=cams(), factor=st.sampled_from(SCALES))
def test_points_scale_and_findings_do_not(curve: PitchCurve, factor: float) -> None:
    other, phi = scaled(curve, factor), spread(40)
    # The inputs are rounded once more; psi_G and s_G have the digits of a root near the ends of the
    # triangle, which these cams keep away from.
    rounding = 4.0 * ROUNDINGS * EPS
    jets, jets_there = curve.jet(phi), other.jet(phi)
    for one, two in zip(jets, jets_there, strict=True):
        assert np.max(np.abs(factor * one - two)) <= rounding * factor * np.max(np.abs(one))
    for distance in (-1.0, 1.0):
        reach = distance * curve.follower.roller_radius
        one = WorkingCurve(curve, reach).point(phi)
        two = WorkingCurve(other, factor * reach).point(phi)
        assert np.max(np.abs(factor * one - two)) <= rounding * factor * np.max(np.abs(one))
    bend = np.max(np.abs(curve.curvature(phi)))
    there = factor * other.curvature(phi)
    assert np.max(np.abs(there - curve.curvature(phi))) <= 8.0 * rounding * bend
    mu = curve.transmission_angle(phi)
    assert other.transmission_angle(phi) == pytest.approx(mu, rel=rounding, abs=rounding)
    stated = [
        [(finding.name, finding.severity) for finding in check_undercut(flank, "inner", bends)]
        for flank, bends in ((inner_of(each), curvature_extremes(each)) for each in (curve, other))
    ]
    assert stated[0] == stated[1]
    assert check_standstill(curve) == check_standstill(other) == ()


SCENE = """camgeo = 1
name = "scale"
[cam]
rotation = "{sense}"
[follower]
kind = "{kind}"
base_radius = {base}
roller_radius = {roller}
{own}
[[motion]]
dwell = 30
[[motion]]
law = "polynomial-345"
span = 60
to = {stroke}
[[motion]]
dwell = 40
[[motion]]
law = "modified-sine"
span = 80
to = 0
[[motion]]
dwell = 150
[output]
tolerance = {tolerance}
"""


def scene(kind: str, factor: float, roller: float, sense: str = "ccw") -> Design:
    """A cam with a base radius of 40 times `factor` [mm], read from text."""
    translating = kind == "translating-roller"
    pivot = f"pivot = [{-60.0 * factor!r}, {-50.0 * factor!r}]\narm = {70.0 * factor!r}"
    text = SCENE.format(
        sense=sense,
        kind=kind,
        base=repr(40.0 * factor),
        roller=repr(roller * factor),
        own=f"offset = {5.0 * factor!r}" if translating else pivot,
        stroke=repr(20.0 * factor) if translating else "20",
        # The format's own limits: 1e-7 to 1 mm.
        tolerance=repr(min(1.0, max(1e-7, 1e-4 * factor))),
    )
    return Design(parse_scene(text))


ROUNDED = ("closure", "tangent-closure")
"""Findings whose value is a rounding, and its place that of the largest one."""


def place_of(finding: Finding) -> tuple[str, float | None]:
    """What distinguishes a finding from others of the same design."""
    if finding.cam_angle is None or finding.name in ROUNDED:
        return finding.name, None
    return finding.name, round(finding.cam_angle, 6)


@pytest.mark.parametrize("factor", SCALES)
@pytest.mark.parametrize(
    ("kind", "roller"),
    [("translating-roller", 41.0), ("oscillating-roller", 8.0)],
)
def test_scenes_at_all_scales_give_the_same_findings(
    kind: str, roller: float, factor: float
) -> None:
    one, two = scene(kind, 1.0, roller), scene(kind, factor, roller)
    stated, there = ({place_of(f): f for f in each.findings} for each in (one, two))
    assert stated.keys() == there.keys()
    assert_finite(two.findings)
    for key, finding in stated.items():
        other = there[key]
        assert finding.severity == other.severity
        if finding.name in ROUNDED:
            continue
        if finding.value is None or other.value is None:
            assert finding.value == other.value
            continue
        size = factor if finding.unit.startswith("mm") else 1.0
        assert other.value == pytest.approx(size * finding.value, rel=1e-12, abs=1e-12 * size)
    phi = spread(200)
    assert two.disc.pictured.curve("pitch", phi) == pytest.approx(
        factor * one.disc.pictured.curve("pitch", phi), rel=1e-12, abs=1e-13 * factor
    )


# HC15 to HC17: rollers larger than the base circle ----------------------------------------------


@attack
@given(curve=cams(), over=st.floats(1.0, 3.0))
def test_hc17_rollers_larger_than_the_base_circle(curve: PitchCurve, over: float) -> None:
    base = curve.follower.base_radius
    curve = with_roller(curve, over * base)
    assert isinstance(curve.motion, MotionPlan)
    first = float(curve.motion.joints_deg[1])
    assume(first > 1.0)
    (finding,) = check_follower(curve.follower, runs_on_inner=True)
    assert (finding.name, finding.severity) == ("roller-over-axis", "invalid")
    inner, rest = inner_of(curve), np.radians(first) * np.array([0.2, 0.5, 0.8])
    # In the rest the pitch curve is the base circle, its inner flank one on the other side.
    centre = curve.point(rest)
    assert inner.point(rest) == pytest.approx(
        centre * (1.0 - over), rel=0.0, abs=ROUNDINGS * EPS * over * base
    )
    margin = inner.regularity(rest)
    assert margin == pytest.approx(np.full(3, 1.0 - over), abs=ROUNDINGS * EPS * over)
    findings = check_undercut(inner, "inner", curvature_extremes(curve))
    assert_finite(findings)
    if over > 1.0 + 1e-9:
        assert {each.name for each in findings} == {"undercut-inner"}
        assert {each.severity for each in findings} == {"no-disc"}
        within = [
            start <= rest[1] <= end or (end < start and not end < rest[1] < start)
            for start, end in undercut_ranges(inner, curvature_extremes(curve))
        ]
        assert any(within)
    hold(curve, rest)


# HC18: the roller centre stands still in the cam -----------------------------------------------


@st.composite
def standing_still(draw: st.DrawFn) -> tuple[PitchCurve, float]:
    """A cam with Z' = 0 in the middle of its rise, whose cam angle comes with it.

    The rocker swings inward to the line of centres, psi_G = psi_H/2, and l_1 is made to be
    l_3 (1 - sigma psi') there.
    """
    span = draw(st.integers(40, 150))
    swing = math.radians(draw(st.floats(4.0, 0.4 * span)))
    first = draw(st.integers(5, 40))
    arm = draw(st.floats(1.0, 500.0))
    top = 15.0 / 8.0 * swing / math.radians(span)
    # Inward: psi' = -top in the rise, so that sigma = +1 makes 1 + top.
    distance = arm * (1.0 + top)
    half = 0.5 * swing
    base = math.sqrt((distance - arm) ** 2 + 4.0 * distance * arm * math.sin(0.5 * half) ** 2)
    rocker = OscillatingRoller(complex(-distance, 0.0), arm, base, 0.1 * base, 1, -1)
    plan = polynomials((first, span, 0, 150, 210 - span - first), swing)
    return PitchCurve(plan, rocker, 1), math.radians(first) + 0.5 * math.radians(span)


@attack
@given(case=standing_still())
def test_hc18_pitch_curves_with_a_real_cusp(case: tuple[PitchCurve, float]) -> None:
    curve, phi = case
    place = np.array([phi])
    follower = curve.follower
    assert isinstance(follower, OscillatingRoller)
    size = follower.arm + follower.centre_distance
    # psi_G is a root that has lost digits where the triangle is nearly flat.
    flat = size / follower.base_radius
    assert abs(curve.jet(place)[1, 0]) <= ROUNDINGS * EPS * size * flat
    (finding,) = check_standstill(curve)
    assert finding.severity == "no-disc"
    assert finding.cam_angle == pytest.approx(phi, abs=1e-6)
    assert_finite([finding])
    # Exactly there an error, or, where rounding has moved the cusp between two doubles, a number.
    for quantity in (curve.curvature, curve.transmission_angle, inner_of(curve).point):
        finite_or_refused(partial(quantity, place), "stands still")
    around = np.array([phi - 1e-2, phi - 1e-4, phi + 1e-4, phi + 1e-2])
    hold(curve, around)


# HC19: the velocity pole at infinity ------------------------------------------------------------


@attack
@given(
    span=st.integers(30, 100),
    start=st.floats(20.0, 60.0),
    arm=st.floats(20.0, 200.0),
    distance=st.floats(20.0, 300.0),
    sigma=signs(),
    side=signs(),
)
def test_hc19_common_normals_through_the_pivot(
    span: int, start: float, arm: float, distance: float, sigma: int, side: int
) -> None:
    """sigma psi' = 1 in the middle of a stroke: |Z'| = l_1 and mu the acute angle of the rocker."""
    swing = 8.0 / 15.0 * math.radians(span)
    psi = math.radians(start)
    base = math.sqrt((distance - arm) ** 2 + 4.0 * distance * arm * math.sin(0.5 * psi) ** 2)
    assume(base > 1e-3 * (distance + arm))
    rocker = OscillatingRoller(complex(distance, 0.0), arm, base, 0.1 * base, side, 1)
    curve = PitchCurve(polynomials((50, span, 10, span, 300 - 2 * span), swing), rocker, sigma)
    # chi' is sigma in the rise if the arm's side is the sense, else in the return.
    first = 50.0 + 0.5 * span
    place = np.radians([first if side == sigma else first + 10.0 + span])
    middle = rocker.start_angle + 0.5 * swing
    mu = min(middle, math.pi - middle)
    rel = ROUNDINGS * EPS * (1.0 + (distance + arm) / base)
    assert abs(curve.motion.jet(place)[1, 0]) == pytest.approx(1.0, rel=rel)
    assert abs(curve.jet(place)[1, 0]) == pytest.approx(distance, rel=rel * (1.0 + arm / distance))
    assert curve.transmission_angle(place)[0] == pytest.approx(mu, abs=rel * (1.0 + arm / distance))
    hold(curve, np.append(place, place + 0.01))


# HC20: inflections ------------------------------------------------------------------------------


@pytest.mark.parametrize("cam", TIGHT)
def test_hc20_inflections_are_passed_steadily(
    cam: tuple[float, float, float, tuple[int, ...], int],
) -> None:
    curve = tight_cam(cam, 2.0)
    grid = np.unique(np.concatenate((curvature_extremes(curve).phi % TURN, spread(180))))
    angles = roots_on_grid(curve.curvature, grid)
    assert len(angles) >= 2
    oracle = Oracle(curve)
    with mp.workdps(40):
        for angle in angles:
            true = mp.findroot(oracle.curvature, mpf(angle))
            slope = abs(mp.diff(oracle.curvature, true))
            scale = oracle.quantities(true)["curvature"][1]
            assert abs(angle - true) <= ROUNDINGS * EPS * scale / slope + ANGLE
    for angle in angles:
        around = angle + np.array([-1e-9, 0.0, 1e-9])
        kappa = curve.curvature(around)
        assert np.all(np.isfinite(kappa))
        assert kappa[0] * kappa[2] < 0.0
    # The flank is a straight line there for a moment, and as smooth as elsewhere.
    hold(curve, angles)


def test_hc20_the_radius_of_curvature_alone_may_be_infinite() -> None:
    kappa = np.array([-2.0, -(2.0**-900), -0.0, 0.0, 0.5])
    assert radius_of_curvature(kappa).tolist() == [-0.5, -(2.0**900), math.inf, math.inf, 2.0]


# HC23: pitch curves that run back ---------------------------------------------------------------


@attack
@given(
    base=st.floats(20.0, 100.0),
    share=st.floats(0.6, 0.95),
    stroke=st.floats(0.8, 2.0),
    span=st.integers(25, 50),
    sigma=signs(),
)
def test_hc23_pitch_curves_that_run_back(
    base: float, share: float, stroke: float, span: int, sigma: int
) -> None:
    offset, lift = sigma * share * base, stroke * base
    plan = polynomials((30, span, 40, 120, 170 - span), lift)
    curve = PitchCurve(plan, TranslatingRoller(base, 0.1 * base, offset), sigma)

    def turning(phi: FloatArray) -> FloatArray:
        z, z1 = curve.jet(phi)[:2]
        return np.asarray(sigma * np.imag(np.conj(z) * z1))

    grid = np.linspace(0.0, TURN, 1441)
    assume(np.max(turning(grid)) > 1e-3 * base**2)
    angles = roots_on_grid(turning, grid)
    assert len(angles) == 2
    oracle = Oracle(curve)
    with mp.workdps(40):

        def exact(phi: Number) -> Number:
            w, _ = oracle.fixed(phi)
            return sigma * offset * w[1].imag - abs(w[0]) ** 2

        for angle in angles:
            true = mp.findroot(exact, mpf(angle))
            slope = abs(mp.diff(exact, true))
            limit = ROUNDINGS * EPS * float(base + lift) ** 2 * 8.0 / slope
            assert abs(angle - true) <= limit + ANGLE
    hold(curve, np.array([*angles, 0.5 * float(np.sum(angles)), 1.5, 4.0]))


# HC05, HC07: dead centres, and linkages that just fail to close --------------------------------


def linkage_motion(linkage: SliderCrank, stroke: float) -> LinkedMotion:
    return LinkedMotion(polynomials((60, 100, 40, 100, 60), stroke), linkage)


def stretched(crank: float, coupler: float) -> SliderCrank:
    """Crank and coupler in one line with the guide through the shaft at stroke 0."""
    return SliderCrank(crank, coupler, 0.5 * math.pi, False, 1, -1, 1)


@pytest.mark.parametrize(("crank", "coupler"), [(40.0, 60.0), (17.3, 101.7), (1e-3, 2e-3)])
def test_hc05_dead_centres_at_the_start(crank: float, coupler: float) -> None:
    linkage = stretched(crank, coupler)
    motion = linkage_motion(linkage, 0.3 * crank)
    (fatal,) = (f for f in check_linkage(motion) if f.name == "dead-centre")
    assert fatal.severity == "no-disc"
    rest = np.radians([0.0, 30.0, 59.0, 310.0])
    assert np.all(motion.jet(rest)[1:] == 0.0)
    assert np.all(np.isfinite(motion.jet(rest)))
    # Behind the joint psi'' grows without bound; up to there every value is one.
    behind = math.radians(60.0) + np.array([1e-3, 1e-2, 0.1, 1.0])
    assert np.all(np.isfinite(motion.jet(behind)))
    with pytest.raises(GeometryError, match="dead centre"):
        motion.jet(np.radians([60.0]))
    # theta by the law of cosines, in mpmath, from the lengths as they are.
    with mp.workdps(40):
        k, c = mpf(crank), mpf(coupler)
        for place in behind[1:]:
            s = Oracle(PitchCurve(motion.demanded, TranslatingRoller(1.0, 0.1), 1)).lift(mpf(place))
            height = mpf(linkage.guide_height)  # cos(pi/2), rounded
            x = k * mp.sin(mpf(linkage.deflection)) + c - s[0]
            d = mp.hypot(x, height)
            theta = mp.atan2(height, -x) - mp.acos((k**2 + d**2 - c**2) / (2 * k * d))
            found_theta = linkage.start_angle + motion.jet(np.array([place]))[0, 0]
            # sqrt of d + ... - l_4: half the digits of what x has left of its own.
            within = ROUNDINGS * EPS * (k + c) / mp.sqrt(abs(s[0]) * (k + c)) + ROUNDINGS * EPS * 4
            assert abs(found_theta - theta) <= within


@pytest.mark.parametrize("gap", [1e-1, 1e-4, 1e-7, 1e-10])
def test_hc07_linkages_that_just_fail_to_close(gap: float) -> None:
    linkage = SliderCrank(40.0, 60.0, math.radians(20.0), False, 1, 1, 1)
    reach = max(linkage.dead_strokes)
    linkage_motion(linkage, reach * (1.0 - 1e-9))
    stroke = reach + gap
    with pytest.raises(GeometryError, match="does not close between cam angles") as raised:
        linkage_motion(linkage, stroke)
    words = raised.value.message.split()
    first, last = float(words[words.index("angles") + 1]), float(words[words.index("degrees:") - 1])
    missing = float(words[words.index("to", words.index("degrees:")) + 1])
    with mp.workdps(40):
        deflection = mpf(linkage.deflection)
        height, lean = 40 * mp.cos(deflection), 40 * mp.sin(deflection)
        start = 60 + lean
        dead = mp.sqrt(100**2 - height**2) - start
        share = mp.findroot(
            lambda z: polynomial_345(z)[0] - dead / mpf(stroke), (0.5, 1), solver="illinois"
        )
        short = mp.hypot(start + mpf(stroke), height) - 100
        slope = polynomial_345(share)[1]
    # The angle is where the stroke passes its dead one: near the top, where it is flat.
    lost = math.degrees(ROUNDINGS * EPS / float(slope)) * math.radians(100.0) + 1e-7
    assert first == pytest.approx(60.0 + 100.0 * float(share), abs=lost)
    assert last == pytest.approx(300.0 - 100.0 * float(share), abs=lost)
    # Printed with six digits, of a difference of lengths of 100 mm.
    assert missing == pytest.approx(float(short), rel=1e-5, abs=ROUNDINGS * EPS * 100.0)


# HC22: other lobes ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("base", "stroke", "span", "rest", "roller", "sigma"),
    [
        (22.0, 130.0, 40, 0, 16.0, 1),
        (22.0, 130.0, 40, 0, 16.0, -1),
        (2.2e-5, 1.3e-4, 40, 0, 1.6e-5, 1),
        (16.0, 120.0, 40, 2, 11.0, -1),
        (30.0, 160.0, 42, 1, 20.0, 1),
    ],
)
def test_hc22_lobes_whose_neck_is_cut_through(
    base: float, stroke: float, span: int, rest: int, roller: float, sigma: int
) -> None:
    """A lobe symmetric about its top: its flanks cross on the axis, where the angle of the inner
    curve's point is that of the axis."""
    plan = polynomials((10, span, rest, span, 350 - 2 * span - rest), stroke)
    curve = PitchCurve(plan, TranslatingRoller(base, roller), sigma)
    flank, oracle = inner_of(curve), Oracle(curve)
    top = math.radians(10.0 + span + 0.5 * rest)
    crossings = find_crossings(flank)
    assert len(crossings) == 2
    with mp.workdps(40):
        axis = 1j * mp.expj(-sigma * mpf(top))

        def across(phi: Number) -> Number:
            return (oracle.quantities(phi)["inner"][0] * mp.conj(axis)).imag

        for crossing in crossings:
            true = mp.findroot(across, mpf(crossing.first))
            slope = abs(mp.diff(across, true))
            lost = ROUNDINGS * EPS * (base + stroke) / slope + 4.0 * ANGLE
            assert abs(crossing.first - true) <= lost
            assert abs(crossing.second - (2 * mpf(top) - true)) <= lost
            point = complex(oracle.quantities(true)["inner"][0])
            assert crossing.point == pytest.approx(point, abs=ROUNDINGS * EPS * (base + stroke))


@pytest.mark.parametrize(("cam", "excess"), each_with([1e-2, 1e-3, 1e-6, 1e-9, 1e-11]))
def test_hc21_swallow_tails_cross_themselves(
    cam: tuple[float, float, float, tuple[int, ...], int], excess: float
) -> None:
    curve = tight_cam(cam, 1.0)
    with mp.workdps(50):
        kappa, _ = tightest(curve)
        roller = float((1 + mpf(excess)) / kappa)
    curve = with_roller(curve, roller)
    flank = inner_of(curve)
    ((start, end),) = undercut_ranges(flank, curvature_extremes(curve))
    around = [c for c in find_crossings(flank) if c.first < start and c.second > end]
    assert len(around) == 1
    oracle = Oracle(curve)
    with mp.workdps(DIGITS):
        first, second = mpf(around[0].first), mpf(around[0].second)
        for _ in range(8):  # Newton's method on the two points
            (one, pace), (two, other) = (moving(oracle, angle) for angle in (first, second))
            gap, cross = one - two, (mp.conj(pace) * other).imag
            first -= (mp.conj(other) * gap).imag / -cross
            second -= (mp.conj(pace) * gap).imag / -cross
        assert abs(oracle.inner(first) - oracle.inner(second)) <= mpf(10) ** -40
        width = float(second - first)
        assert width > 0.0
        # The tail's ends are known to a part in a million of its width, and to 1e-8 degrees.
        within = max(1e-6 * width, math.radians(1e-8))
        assert abs(around[0].first - first) <= within
        assert abs(around[0].second - second) <= within


def moving(oracle: Oracle, phi: Number) -> tuple[Number, Number]:
    """Point of the inner flank and its derivative, Z' (1 - r_R kappa)."""
    (_, z1, _, _), _ = oracle.jet(phi)
    roller = mpf(oracle.curve.follower.roller_radius)
    return oracle.inner(phi), z1 * (1 - roller * oracle.curvature(phi))
