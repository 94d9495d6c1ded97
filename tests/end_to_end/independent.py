"""Cam mechanisms of scenes computed from their dimensions alone, without any formula of camgeo.

Positions come from compass and ruler: intersecting circles and turning arms. Directions are central
differences of positions, and what cuts a flank off is found by laying the roller, or the face, into
each of thousands of places. So values are good to about `ACCURACY`, and nothing can be said of a
verdict that is nearer to its limit than that.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
from scipy.spatial import cKDTree

from camgeo.numeric.arrays import ComplexArray, FloatArray

TURN: Final = 2.0 * math.pi

PLACES: Final = 14_400
"""Cam angles of a turn at which the mechanism is laid out."""

STEP: Final = 2e-6
"""Half of the difference of cam angles from which a direction is taken [rad]."""

BEND_STEP: Final = 2e-4
"""The same for the curvature."""

ACCURACY: Final = 2e-5
"""Relative accuracy of quantities that follow from differences."""


# Motion -------------------------------------------------------------------------------------------


def _polynomial(z: FloatArray) -> FloatArray:
    return z**3 * (10.0 - 15.0 * z + 6.0 * z**2)


def _cycloid(z: FloatArray) -> FloatArray:
    return z - np.sin(TURN * z) / TURN


def _cosine(z: FloatArray) -> FloatArray:
    return 0.5 * (1.0 - np.cos(math.pi * z))


def _modified_sine(z: FloatArray) -> FloatArray:
    """Quarter periods of 1/2 and of 3/2 of the span, joined at equal acceleration."""
    pi = math.pi
    mirrored = z > 0.5
    half = np.where(mirrored, 1.0 - z, z)
    first = pi * half - np.sin(4.0 * pi * half) / 4.0
    second = 2.0 + pi * half - 9.0 * np.sin((pi + 4.0 * pi * half) / 3.0) / 4.0
    rise = np.where(half < 0.125, first, second) / (4.0 + pi)
    return np.where(mirrored, 1.0 - rise, rise)


LAWS: Final[Mapping[str, Callable[[FloatArray], FloatArray]]] = {
    "polynomial-345": _polynomial,
    "inclined-sine": _cycloid,
    "simple-sine": _cosine,
    "modified-sine": _modified_sine,
}
"""Rises from 0 to 1 over z from 0 to 1, from rest to rest."""


@dataclass(frozen=True)
class Motion:
    """Dwells and moves from rest to rest.

    Attributes
    ----------
    ends : (k,) cam angles at which the segments end, ascending [rad].
    levels : (k,) positions there.
    laws : (k,) names; None for a dwell.
    """

    ends: FloatArray
    levels: FloatArray
    laws: tuple[str | None, ...]

    @classmethod
    def of(cls, segments: list[Mapping[str, Any]], unit: float) -> Motion:
        ends, levels, laws, total, level = [], [], [], 0.0, 0.0
        for segment in segments:
            total += float(segment.get("span", segment.get("dwell", 0.0)))
            level = float(segment.get("to", level))
            ends.append(math.radians(total))
            levels.append(unit * level)
            laws.append(segment.get("law"))
        return cls(np.array(ends), np.array(levels), tuple(laws))

    def __call__(self, phi: FloatArray) -> FloatArray:
        """Positions at cam angles of any turn [mm or rad]."""
        phi = np.mod(phi, TURN)
        starts = np.concatenate(([0.0], self.ends[:-1]))
        before = np.concatenate(([0.0], self.levels[:-1]))
        which = np.minimum(np.searchsorted(self.ends, phi, side="right"), len(self.ends) - 1)
        out = np.empty_like(phi)
        for number, name in enumerate(self.laws):
            here = which == number
            span = self.ends[number] - starts[number]
            if name is None or span == 0.0:
                out[here] = self.levels[number]
                continue
            z = (phi[here] - starts[number]) / span
            out[here] = before[number] + (self.levels[number] - before[number]) * LAWS[name](z)
        return out

    @property
    def borders(self) -> FloatArray:
        """Where segments, and the pieces of their laws, meet [rad]."""
        starts = np.concatenate(([0.0], self.ends[:-1]))
        inner = [
            start + share * (end - start)
            for start, end in zip(starts, self.ends, strict=True)
            for share in (0.0, 0.125, 0.875, 1.0)
        ]
        return np.unique(inner)


# Linkages -----------------------------------------------------------------------------------------


def crossing(pin: ComplexArray, crank: float, coupler: float, side: int) -> ComplexArray:
    """The point at `crank` from the origin and `coupler` from `pin`, counter-clockwise of the pin
    seen from the origin if `side` is 1; NaN where the circles miss each other.
    """
    square = np.abs(pin) ** 2
    along = (crank**2 - coupler**2 + square) / (2.0 * square)
    with np.errstate(invalid="ignore"):
        across = np.sqrt(crank**2 / square - along**2)
    return pin * (along + 1j * side * across)


@dataclass(frozen=True)
class Linked:
    """A linkage in all the positions of an array.

    Attributes
    ----------
    moved : by how much it moves the follower: the rocker counter-clockwise [rad], or the carriage
        along its guide [mm].
    spare : the smallest length by which the rods close [mm]; negative where they do not.
    leverage : sine of the angle between the coupler and the direction in which the driven member
        cannot move; where it changes sign the cam cannot drive that member.
    """

    moved: FloatArray
    spare: FloatArray
    leverage: FloatArray


def _signed_sine(first: ComplexArray, second: ComplexArray) -> FloatArray:
    return np.asarray(np.imag(np.conj(first) * second) / (np.abs(first) * np.abs(second)))


def _spare(pin: ComplexArray, crank: float, coupler: float) -> FloatArray:
    distance = np.abs(pin)
    return np.minimum(crank + coupler - distance, distance - abs(crank - coupler))


def slider_pin(linkage: Mapping[str, Any]) -> tuple[complex, int]:
    """The slider's pin at stroke 0, seen from the crank's shaft, and the side of the tip."""
    deflection = math.radians(linkage["crank_deflection"])
    towards = 1.0 if linkage.get("slider_side", "left") == "right" else -1.0
    lean = -towards if linkage["crank_leans"] == "away" else towards
    tip = linkage["crank"] * complex(lean * math.sin(deflection), math.cos(deflection))
    side = 1 if linkage["branch"] == "ccw" else -1
    return tip + towards * linkage["coupler"], side


def by_slider(linkage: Mapping[str, Any], stroke: FloatArray) -> Linked:
    """A slider that drives, or is driven by, a rocker: the motion is its stroke."""
    pin0, side = slider_pin(linkage)
    sense = 1.0 if linkage["stroke_direction"] == "right" else -1.0
    crank, coupler = linkage["crank"], linkage["coupler"]
    pin = np.asarray(pin0 + sense * np.concatenate(([0.0], stroke)), dtype=np.complex128)
    tip = crossing(pin, crank, coupler, side)
    turned = np.angle(tip[1:] / tip[0]) * (-1.0 if linkage.get("mirrored") else 1.0)
    rod = (pin - tip)[1:]
    return Linked(
        turned,
        _spare(pin, crank, coupler),
        rod.real / np.abs(rod),
    )


def by_lever(linkage: Mapping[str, Any], angle: FloatArray) -> Linked:
    """A lever on a shaft of its own: the motion is its angle."""
    shaft = complex(*linkage["shaft"])
    sense = 1.0 if linkage.get("lever_sense", "ccw") == "ccw" else -1.0
    turned = math.radians(linkage["lever_angle"]) + sense * np.concatenate(([0.0], angle))
    lever = linkage["lever"] * np.exp(1j * turned)
    pin = shaft + lever
    crank, coupler = linkage["crank"], linkage["coupler"]
    tip = crossing(pin, crank, coupler, 1 if linkage["branch"] == "ccw" else -1)
    # The tip turns by less than half a turn from one place to the next.
    swung = np.unwrap(np.angle(tip / tip[0]))[1:] if np.all(np.isfinite(tip)) else np.angle(tip[1:])
    rod = pin - tip
    return Linked(
        swung,
        _spare(pin, crank, coupler),
        _signed_sine(lever[1:], rod[1:]),
    )


def by_crank(linkage: Mapping[str, Any], angle: FloatArray) -> Linked:
    """A crank that a slider drives: the motion is its angle, the slider carries the follower."""
    pin0, branch = slider_pin(linkage)
    crank, coupler = linkage["crank"], linkage["coupler"]
    tip0 = complex(crossing(np.array([pin0]), crank, coupler, branch)[0])
    tip = tip0 * np.exp(1j * np.concatenate(([0.0], angle)))
    rise = pin0.imag - tip.imag
    side = math.copysign(1.0, (pin0 - tip0).real)
    with np.errstate(invalid="ignore"):
        run = np.sqrt(coupler**2 - rise**2)
    sense = 1.0 if linkage["stroke_direction"] == "right" else -1.0
    rod = side * run[1:] + 1j * rise[1:]
    stroke = sense * (tip.real + side * run - pin0.real)[1:]
    return Linked(stroke, coupler - np.abs(rise), _signed_sine(tip[1:], rod))


# The mechanism ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Model:
    """The mechanism of a scene, given as its values.

    Lengths in mm; docs/scene.md says what the keys mean.
    """

    values: Mapping[str, Any]

    @cached_property
    def follower(self) -> Mapping[str, Any]:
        found: Mapping[str, Any] = self.values["follower"]
        return found

    @property
    def rocks(self) -> bool:
        return bool(self.follower["kind"].startswith("oscillating"))

    @property
    def is_flat(self) -> bool:
        return bool(self.follower["kind"].endswith("flat"))

    @property
    def roller_radius(self) -> float:
        return float(self.follower["roller_radius"])

    @property
    def sense(self) -> int:
        return 1 if self.values["cam"]["rotation"] == "ccw" else -1

    @property
    def turns(self) -> bool:
        """Whether the demanded motion is an angle."""
        linkage = self.values.get("linkage")
        if linkage is None:
            return self.rocks
        return linkage["kind"] == "four-bar" or not self.rocks

    @cached_property
    def motion(self) -> Motion:
        return Motion.of(self.values["motion"], math.radians(1.0) if self.turns else 1.0)

    def linked(self, phi: FloatArray) -> Linked | None:
        """The linkage at cam angles, or None without one."""
        linkage = self.values.get("linkage")
        if linkage is None:
            return None
        demanded = self.motion(phi)
        if linkage["kind"] == "four-bar":
            return by_lever(linkage, demanded)
        return by_slider(linkage, demanded) if self.rocks else by_crank(linkage, demanded)

    def lifts(self, phi: FloatArray) -> FloatArray:
        """What the follower moves: along its guide [mm], or counter-clockwise [rad]."""
        linked = self.linked(phi)
        outward = 1.0 if self.follower.get("direction", "outward") == "outward" else -1.0
        if self.rocks:
            if linked is not None:
                return linked.moved
            side = 1.0 if self.follower.get("arm_side", "ccw") == "ccw" else -1.0
            return outward * side * self.motion(phi)
        moved = self.motion(phi) if linked is None else linked.moved
        return outward * moved

    def centre(self, phi: FloatArray) -> ComplexArray:
        """(n,) centre of the roller in the fixed frame [mm]."""
        lift, base = self.lifts(phi), float(self.follower["base_radius"])
        if not self.rocks:
            offset = float(self.follower.get("offset", 0.0))
            guide = math.radians(self.follower.get("guide_angle", 90.0))
            start = math.sqrt(base**2 - offset**2)
            return np.asarray((start + lift - 1j * offset) * np.exp(1j * guide))
        pivot, arm = complex(*self.follower["pivot"]), float(self.follower["arm"])
        away = abs(pivot)
        side = 1.0 if self.follower.get("arm_side", "ccw") == "ccw" else -1.0
        opening = math.acos((away**2 + arm**2 - base**2) / (2.0 * away * arm))
        towards = np.angle(-pivot)
        return np.asarray(pivot + arm * np.exp(1j * (towards + side * opening + lift)))

    def face(self, phi: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(n,) distance of a flat face from the cam axis [mm], direction of its normal [rad]."""
        lift, base = self.lifts(phi), float(self.follower["base_radius"])
        if not self.rocks:
            guide = math.radians(self.follower.get("guide_angle", 90.0))
            return base + lift, np.full_like(lift, guide)
        pivot = complex(*self.follower["pivot"])
        beyond = float(self.follower.get("face_offset", 0.0))
        side = 1.0 if self.follower.get("arm_side", "ccw") == "ccw" else -1.0
        opening = math.asin((base - beyond) / abs(pivot)) + side * lift
        normal = np.angle(-pivot) + side * (opening + 0.5 * math.pi)
        return abs(pivot) * np.sin(opening) + beyond, normal

    # In the turning cam.

    @cached_property
    def angles(self) -> FloatArray:
        """(n,) cam angles of one turn, none nearer to a border of the motion than a step."""
        regular = np.linspace(0.0, TURN, PLACES, endpoint=False)
        near = np.concatenate(
            [self.motion.borders + sign * away for sign in (-1, 1) for away in (1e-3, 3e-4)]
        )
        found = np.sort(np.mod(np.concatenate((regular, near)), TURN))
        away = np.abs(found[:, None] - self.motion.borders[None, :]).min(axis=1)
        return np.asarray(found[away > 1.01 * BEND_STEP])

    def path(self, phi: FloatArray) -> ComplexArray:
        """(n,) centre of the roller in the turning cam."""
        return np.asarray(self.centre(phi) * np.exp(-1j * self.sense * phi))

    def direction(self, phi: FloatArray) -> ComplexArray:
        """(n,) unit tangent of that path."""
        ahead = self.path(phi + STEP) - self.path(phi - STEP)
        return ahead / np.abs(ahead)

    def curvature(self, phi: FloatArray) -> FloatArray:
        """(n,) curvature of that path, positive where it turns about the cam axis."""
        before, here, after = (self.path(phi + k * BEND_STEP) for k in (-1, 0, 1))
        first = (after - before) / (2.0 * BEND_STEP)
        second = (after - 2.0 * here + before) / BEND_STEP**2
        return np.asarray(-self.sense * np.imag(np.conj(first) * second) / np.abs(first) ** 3)

    def flank(self, phi: FloatArray, side: int) -> ComplexArray:
        """(n,) point of contact on the inner flank, `side` -1, or on the outer one, +1."""
        return self.path(phi) + 1j * side * self.sense * self.roller_radius * self.direction(phi)

    def contact(self, phi: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """(n,) point of contact with a flat face in the fixed frame, and the turning of the face in
        the cam by the cam angle, negative: it runs against the cam.
        """
        (low, first), (here, normal), (high, last) = (self.face(phi + k * STEP) for k in (-1, 0, 1))
        slope = (high - low) / (2.0 * STEP)
        turning = (last - first) / (2.0 * STEP) - self.sense
        return (here + 1j * slope / turning) * np.exp(1j * normal), turning

    # Verdicts.

    @cached_property
    def transmission_angle(self) -> float:
        """The smallest [rad], between the face or the flank's tangent and the follower's motion."""
        phi = self.angles
        if self.is_flat:
            if not self.rocks:
                return 0.5 * math.pi
            point, _ = self.contact(phi)
            _, normal = self.face(phi)
            arm = point - complex(*self.follower["pivot"])
            moves = 1j * arm
            across = np.exp(1j * normal)
        else:
            centre = self.centre(phi)
            if self.rocks:
                moves = 1j * (centre - complex(*self.follower["pivot"]))
            else:
                guide = math.radians(self.follower.get("guide_angle", 90.0))
                moves = np.full_like(centre, np.exp(1j * guide))
            across = 1j * self.direction(phi) * np.exp(1j * self.sense * phi)
        sine = np.abs(np.real(np.conj(moves) * across)) / np.abs(moves)
        return float(np.arcsin(np.clip(np.min(sine), 0.0, 1.0)))

    @cached_property
    def linkage(self) -> Linked | None:
        """The linkage over the turn."""
        return self.linked(np.linspace(0.0, TURN, PLACES + 1))

    @property
    def spare(self) -> float:
        """Length by which the linkage closes [mm]; infinite without one."""
        return math.inf if self.linkage is None else float(np.min(self.linkage.spare))

    @property
    def leverage(self) -> float:
        """Least sine that drives the far member; 0 or less if it changes sign."""
        if self.linkage is None:
            return math.inf
        held = self.linkage.leverage
        return float(np.min(held * np.sign(held[0])))

    def cusp_margin(self, side: int) -> float:
        """The least 1 + d kappa of the inner flank, `side` -1, or of the outer one, +1."""
        return float(np.min(1.0 + side * self.roller_radius * self.curvature(self.angles)))

    def reach(self, side: int) -> float:
        """Minus the depth by which the roller covers points of contact at other places [mm]. Never
        above 0, and 0 within rounding on a flank that the roller leaves whole.
        """
        phi = self.angles
        tree = cKDTree(_plane(self.path(phi)))
        distance, _ = tree.query(_plane(self.flank(phi, side)))
        return float(np.min(distance)) - self.roller_radius

    def face_radius(self, phi: FloatArray, step: float) -> FloatArray:
        """(n,) radius of curvature for a flat face [mm], by differences of `step` [rad]; -inf where
        the face turns back in the cam.
        """
        placed = [self.face(phi + k * step) for k in (-1, 0, 1)]
        pace = (placed[2][1] - placed[0][1]) / (2.0 * step) - self.sense
        # Three faces in the cam enclose a triangle; as they near each other, its circle is rho.
        t = [
            normal - self.sense * (phi + k * step)
            for k, (_, normal) in zip((-1, 0, 1), placed, strict=True)
        ]
        h = [height for height, _ in placed]
        d1, d2 = t[1] - t[0], t[2] - t[1]
        slope = (h[2] - h[1]) / d2 - (h[1] - h[0]) / d1
        return np.where(pace * self.sense >= 0.0, -math.inf, h[1] + 2.0 * slope / (d1 + d2))

    @cached_property
    def face_margin(self) -> float:
        """The least radius of curvature for a flat face [mm]."""
        return float(np.min(self.face_radius(self.angles, BEND_STEP)))

    def face_margin_next_to(self, angle: float) -> float:
        """The same next to a cam angle [rad], which may be a border, where the radius may change
        much within one step of the whole turn.
        """
        phi = np.mod(angle + np.linspace(-10.0, 10.0, 401) * BEND_STEP, TURN)
        away = np.abs(phi[:, None] - self.motion.borders[None, :]).min(axis=1)
        fine = 0.05 * BEND_STEP
        return float(np.min(self.face_radius(phi[away > 2.0 * fine], fine)))


def _plane(points: ComplexArray) -> FloatArray:
    return np.column_stack((points.real, points.imag))
