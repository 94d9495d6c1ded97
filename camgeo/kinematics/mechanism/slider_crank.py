"""Slider-crank between the slider, whose stroke is demanded, and the rocker that follows the cam.

Frame of the formulas (as in the thesis's program): the rocker shaft B_0 at the origin, the
slider's guide horizontal at height e_sk above it. The pin on the slider is P = -X + i e_sk with
X = s_0 + eps_s s, positive X to the left; the crank tip is T = l_sk exp(i theta), |P - T| = l_4.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Annotated, ClassVar, Literal

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.sketch import Guide, MechanismSketch, Places
from camgeo.kinematics.mechanism.triangle import (
    ROUNDING,
    RockerCrank,
    Size,
    drawn,
    level,
    passed_at_rest,
    turning,
)
from camgeo.kinematics.mechanism.values import Branch, Sense, angle
from camgeo.kinematics.motion import FULL_ORDER, Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.numeric.checked import Truth, check_fields
from camgeo.numeric.interval import Angles
from camgeo.units import TURN

AcuteAngle = Annotated[float, partial(angle, low=-0.5 * math.pi, high=0.5 * math.pi)]


@dataclass(frozen=True)
class SliderCrank(RockerCrank):
    """Slider-crank on the rocker shaft (Wirsig section 3.3.1, corrected as docs/sources.md says).

    Attributes
    ----------
    crank : l_sk, crank on the rocker shaft [mm].
    coupler : l_4 [mm].
    deflection : alpha_sk, angle of the crank from the perpendicular to the guide at stroke 0 [rad],
        -pi/2 to pi/2.
    leans_away : True if at stroke 0 the crank leans away from the slider (Q21 "ja"),
        s_0 = l_4 - l_sk sin alpha_sk; False if towards it, s_0 = l_4 + l_sk sin alpha_sk.
    slider_side : +1 if at stroke 0 the slider is to the left of the rocker shaft, -1 to the right
        (Q25; the thesis's program ignores it for a crank that leans towards the slider).
    stroke_direction : eps_s, +1 if a positive stroke moves the slider to the left, -1 to the right
        (Q22).
    branch : eps_b, +1 if the crank tip lies clockwise of the pin seen from the rocker shaft, -1
        counter-clockwise (Q23, "erster" and "zweiter Quadrant").
    mirrored : True if the linkage is seen from behind: the rocker turns the other way (Q24).

    Raises
    ------
    GeometryError
        With the key of an invalid value; with "linkage", if the linkage does not
        close at stroke 0.
    """

    member: ClassVar[Literal["slider"]] = "slider"
    unit: ClassVar[Literal["mm"]] = "mm"

    deflection: Annotated[AcuteAngle, "crank_deflection"]
    leans_away: Annotated[Truth, "crank_leans"]
    slider_side: Sense
    stroke_direction: Sense
    branch: Branch
    mirrored: Truth = False

    def __post_init__(self) -> None:
        check_fields(self, "linkage.")
        gap = self.missing_length(np.zeros(1))[0]
        if gap > 0.0:
            message = f"the linkage does not close at stroke 0: it misses by {gap:.6g} mm"
            raise GeometryError(message, key="linkage")

    @cached_property
    def guide_height(self) -> float:
        """e_sk, distance of the guide from the rocker shaft [mm]."""
        return self.crank * math.cos(self.deflection)

    @property
    def _height_square(self) -> float:
        return self.guide_height**2

    @cached_property
    def start_position(self) -> float:
        """s_0, X at stroke 0 [mm]."""
        lean = self.crank * math.sin(self.deflection)
        distance = self.coupler - lean if self.leans_away else self.coupler + lean
        return self.slider_side * distance

    @cached_property
    def coupler_angle(self) -> float:
        """Angle of the coupler, tip to pin, at stroke 0 [rad]; 0 or pi if parallel to the guide.

        The dimensions are defined for a coupler parallel to the guide at stroke 0; if it is not,
        the other branch was meant.
        """
        pin = -self.start_position + 1j * self.guide_height
        tip = self.crank * complex(math.cos(self.start_angle), math.sin(self.start_angle))
        return math.atan2((pin - tip).imag, (pin - tip).real)

    @cached_property
    def dead_strokes(self) -> tuple[float, ...]:
        """The strokes [mm] at which crank and coupler are in line."""
        return tuple(
            self.stroke_direction * (x - self.start_position)
            for reach in (self.crank + self.coupler, abs(self.crank - self.coupler))
            for x in level(self.guide_height, reach)
        )

    def dead_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.dead_positions`."""
        return tuple(stroke for stroke in self.dead_strokes if low <= stroke <= high)

    def turning_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.turning_positions`: where the pin passes the shaft."""
        passing = -self.stroke_direction * self.start_position
        return (passing,) if low <= passing <= high else ()

    def pin(self, stroke: FloatArray) -> tuple[FloatArray, FloatArray]:
        """X (n,) and d = |P| (n,) [mm] at `stroke` (n,) [mm]."""
        x = self.start_position + self.stroke_direction * stroke
        return x, np.sqrt(x * x + self._height_square)

    def _distance(self, stroke: FloatArray) -> FloatArray:
        """d (n,) [mm], from the shaft to the pin."""
        return self.pin(stroke)[1]

    def _pin_angle(self, stroke: FloatArray) -> FloatArray:
        """Direction (n,) [rad] from the shaft to the pin, in (0, pi)."""
        return np.arctan2(self.guide_height, -self.pin(stroke)[0])

    def _farthest_and_nearest(
        self, stroke: FloatArray, reach: FloatArray
    ) -> tuple[tuple[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]:
        x, start = np.abs(self.pin(stroke)[0]), self.start_position

        def at(beside: FloatArray) -> tuple[FloatArray, FloatArray]:
            return (beside - start) * (beside + start), np.hypot(beside, self.guide_height)

        return at(x + reach), at(np.maximum(x - reach, 0.0))

    def _pin_heading(self, stroke: FloatArray, reach: FloatArray) -> Angles:
        """The pin moves along the guide."""
        none = np.zeros_like(stroke)
        return Angles(none + 1.0, none, none)

    @property
    def _pin_pace(self) -> tuple[float, float]:
        return -self.stroke_direction, 0.0

    @cached_property
    def _start_gaps(self) -> tuple[float, float]:
        """(l_sk + l_4)^2 - d^2 and d^2 - (l_sk - l_4)^2 [mm^2] at stroke 0, accurate where tiny."""
        lean = -self.deflection if self.leans_away else self.deflection
        outer = math.sin(0.5 * (0.5 * math.pi - lean))
        inner = math.sin(0.5 * (0.5 * math.pi + lean))
        product = 4.0 * self.crank * self.coupler
        return product * outer * outer, product * inner * inner

    def _growth(self, stroke: FloatArray) -> FloatArray:
        """d^2 minus its value at stroke 0 [mm^2]."""
        return np.asarray(stroke * (2.0 * self.stroke_direction * self.start_position + stroke))

    def transform(self, jet: Jet, order: int = FULL_ORDER) -> Jet:
        """(order + 1, n) rocker angle psi and derivatives [rad/rad^k] for strokes `jet`.

        `jet` (4, n) is the slider's stroke and its derivatives [mm/rad^k]; order is at least 1.

        psi is measured from stroke 0, counter-clockwise positive, in (-pi, pi].

        Raises
        ------
        GeometryError
            With key "linkage", at a dead centre that is not passed at rest: psi'' is infinite.
        """
        x, d = self.pin(jet[0])
        crank, coupler = self.crank, self.coupler
        half_sine, half_cosine = self.half_angle(self._growth(jet[0]), d)
        theta = np.arctan2(self.guide_height, -x)
        theta -= self.branch * 2.0 * np.arctan2(half_sine, half_cosine)
        # exp(i theta) without another sine: the pin's direction turned by the triangle's angle.
        product = half_sine * half_cosine
        scale = 1.0 / (4.0 * crank * d * d)
        versor = half_cosine * half_cosine
        versor -= half_sine * half_sine
        versor *= scale
        cross = product * scale
        cross *= 2.0 * self.branch
        height = self.guide_height
        cosine = height * cross - x * versor
        sine = height * versor + x * cross
        cos_v = (-1.0 / coupler) * x - (crank / coupler) * cosine
        # cos(v - theta) from the law of cosines, sin(v - theta) from the triangle's area.
        cos_between = cos_v * cosine + (height / coupler - (crank / coupler) * sine) * sine
        leverage = passed_at_rest(
            (self.branch / (2.0 * crank * coupler)) * product,
            jet,
            "crank and coupler are in line while the slider starts to move, the rocker's"
            " acceleration is",
        )
        p1 = jet[1]
        of_crank = 1.0 / (crank * leverage)
        direction = -float(self.stroke_direction)
        per_crank = direction * cos_v  # theta' for p' = 1, the sign of p included
        per_crank *= of_crank
        out = np.empty((order + 1, jet.shape[1]))
        theta1 = np.multiply(p1, per_crank, out=out[1])
        if order > 1:
            of_coupler = (crank / coupler) * of_crank
            per_coupler = direction * cosine
            per_coupler *= of_coupler
            v1 = p1 * per_coupler
            np.negative(v1, out=v1)
            swing_in = theta1 * theta1
            swing_in *= crank
            coupler_in = v1 * v1
            coupler_in *= coupler
            theta2 = np.multiply(jet[2], per_crank, out=out[2])
            theta2 += (swing_in * cos_between + coupler_in) * of_crank
        if order > 2:
            v2 = -jet[2] * per_coupler - (swing_in + coupler_in * cos_between) * of_coupler
            mixed = (3.0 * crank) * cos_between * theta1 * theta2 + (3.0 * coupler) * v1 * v2
            theta3 = np.multiply(jet[3], per_crank, out=out[3])
            theta3 += theta1 * theta1 * theta1
            theta3 += mixed * of_crank
        swing = np.subtract(theta, self.start_angle, out=out[0])
        if len(swing) and not (np.max(swing) <= math.pi and np.min(swing) > -math.pi):
            beyond = (swing > math.pi) | (swing <= -math.pi)
            swing[beyond] -= TURN * np.ceil((swing[beyond] - math.pi) / TURN)
        return np.negative(out, out=out) if self.mirrored else out

    @property
    def slider_sense(self) -> int:
        """Sign of the slider's displacement along x, in the drawing of the cam, per stroke.

        The frame of the formulas is the drawing with its origin in the rocker shaft; a `mirrored`
        linkage is seen from behind, with left and right exchanged.
        """
        return self.stroke_direction if self.mirrored else -self.stroke_direction

    def joints(self, stroke: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """P and T (n,) [mm]: slider's pin and crank's tip at `stroke` (n,) [mm], as in the drawing.

        Seen from the rocker shaft, with the axes of the drawing of the cam.
        """
        x, _ = self.pin(stroke)
        theta = self.crank_angle(stroke)
        sense = 1.0 if self.mirrored else -1.0
        pin = sense * x + 1j * self.guide_height
        tip = self.crank * (-sense * np.cos(theta) + 1j * np.sin(theta))
        return np.asarray(pin), np.asarray(tip)

    def sketch(self, place: complex, _: complex, position: FloatArray) -> MechanismSketch[Places]:
        """See `Linkage.sketch`."""
        joined = drawn(place, self.joints(position))
        return joined + MechanismSketch(guides=(Guide(joined.joints[1], 1.0 + 0j),))

    @property
    def coupler_tilt(self) -> float:
        """See `Linkage`."""
        return abs(math.remainder(self.coupler_angle, math.pi))

    def joint_rates(
        self, stroke: FloatArray, demanded: FloatArray, own: FloatArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """See `Linkage.joint_rates`: P goes along the guide, T turns."""
        _, tip = self.joints(stroke)
        return (self.slider_sense * demanded).astype(np.complex128), turning(tip, own)

    def per_follower(self, stroke: FloatArray) -> FloatArray:
        """(n,) ds/dpsi [mm/rad] at `stroke` (n,) [mm], see `Linkage.per_follower`.

        From the derivative of P - T = l_4 exp(i v) with dT/dpsi = i T and P moving along the guide:
        ds/dpsi = -+ l_sk sin(v - theta) / cos v, the reciprocal of `transform`; 0 at a dead centre.

        Raises
        ------
        GeometryError
            With key "linkage", where the coupler is square to the guide, cos v = 0 up to
            rounding, see `locked_positions`.
        """
        far, own = self.transmission_sines(stroke)
        if np.any(np.abs(far) * self.coupler <= self._rounding):
            message = "the coupler is square to the guide: the rocker cannot move the slider"
            raise GeometryError(message, key="linkage")
        slide = -self.stroke_direction * self.crank * own / far
        return np.asarray(-slide if self.mirrored else slide)

    def _far_sine(self, stroke: FloatArray) -> FloatArray:
        """cos v."""
        across = -self.pin(stroke)[0] - self.crank * np.cos(self.crank_angle(stroke))
        return np.asarray(across / self.coupler)

    def far_turning_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.far_turning_positions`: the crank is square to the guide."""
        found = [
            self.stroke_direction * (x - self.start_position)
            for tip in (self.crank, -self.crank)
            for x in level(self.guide_height - tip, self.coupler)
            if x * tip * self.branch >= 0.0
        ]
        return tuple(each for each in found if low <= each <= high)

    def locked_positions(self, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.locked_positions`: the strokes [mm] with the coupler square to the guide.

        There the pin is right above or below the crank's tip, Im T = e_sk -+ l_4: however hard the
        rocker pushes, it cannot move the slider.
        """
        low, high = low - self._rounding, high + self._rounding
        return tuple(each for each in self._across_strokes() if low <= each <= high)

    @property
    def _rounding(self) -> float:
        """The size [mm] up to which a length counts as zero."""
        return ROUNDING * (self.crank + self.coupler)

    def _across_strokes(self) -> list[float]:
        """The strokes [mm] at which, on this branch, the coupler is square to the guide."""
        # The tip (-x, e_sk - down) is clockwise of the pin (-x, e_sk) where x and `down` have
        # opposite signs.
        return [
            self.stroke_direction * (x - self.start_position)
            for down in (self.coupler, -self.coupler)
            for x in level(self.guide_height - down, self.crank)
            if x * down * self.branch <= 0.0
        ]

    def size_limits(self, size: Size, low: float, high: float) -> tuple[float, ...]:
        """See `Linkage.size_limits`.

        With X = a (l_4 - b l_sk sin alpha) + eps_s s, a the side of the slider, b = +1 if the crank
        leans away, and d^2 = X^2 + (l_sk cos alpha)^2, the condition d = l_sk + l_4 as well as
        d = |l_sk - l_4| is linear in each of the two lengths: their squares cancel. Between the
        ends of the stroke d is least where X = 0, at the height of the guide.
        """
        limits = _of_coupler if size == "coupler" else _of_crank
        found = limits(self, (low, high))
        return tuple(top / bottom for top, bottom in found if bottom != 0.0)


def _of_coupler(
    linkage: SliderCrank, strokes: tuple[float, float]
) -> Iterator[tuple[float, float]]:
    """Numerators and denominators for l_4."""
    crank, height, side = linkage.crank, linkage.guide_height, linkage.slider_side
    lean = crank * math.sin(linkage.deflection)
    lean = lean if linkage.leans_away else -lean
    yield crank + height, 1.0
    yield crank - height, 1.0
    for stroke in strokes:
        rest = linkage.stroke_direction * stroke - side * lean  # X = a l_4 + rest
        # l_sk^2 - e_sk^2 is the square of the lean
        top = (lean - rest) * (lean + rest)
        yield top, 2.0 * (side * rest - crank)
        yield top, 2.0 * (side * rest + crank)
        yield -side * rest, 1.0


def _of_crank(linkage: SliderCrank, strokes: tuple[float, float]) -> Iterator[tuple[float, float]]:
    """Numerators and denominators for l_sk."""
    coupler, side = linkage.coupler, linkage.slider_side
    sine, cosine = math.sin(linkage.deflection), math.cos(linkage.deflection)
    sine = sine if linkage.leans_away else -sine
    yield coupler, 1.0 + cosine
    yield coupler, 1.0 - cosine
    for stroke in strokes:
        rest = side * linkage.stroke_direction * stroke + coupler  # a X = rest - b l_sk sin alpha
        top = (rest - coupler) * (rest + coupler)
        yield top, 2.0 * (coupler + rest * sine)
        yield -top, 2.0 * (coupler - rest * sine)
        yield rest, sine
