"""The sizes that a designer writes down: rounded up, to the side on which every limit is kept.

The base radius is the next one with a sensible number of decimals at which the checks find nothing
wrong. The second dimension is chosen in the middle of the range that the limits leave at that base
radius, with as many additional decimals as necessary.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Decimal
from typing import Any, Final

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.check.disc import disc_findings
from camgeo.check.finding import Finding, Limits
from camgeo.check.machine import linkage_findings
from camgeo.check.sizing.face import FaceTask
from camgeo.check.sizing.smallest import PlaceConditions, Rating, Sizing, extreme_angles
from camgeo.check.sizing.task import Placing, RollerTask, covered_pairs, no_pairs
from camgeo.errors import GeometryError
from camgeo.geometry.pieces import contact_extremes, convexity
from camgeo.lazy import Ledger

DECIMALS: Final = 4
"""Decimals of a length from 1 to 10,000 mm, in mm: a tenth of what a good machine resolves."""

SMALL, LARGE = 4, 7
"""Decimals after the first digit of a length below 1 mm, and of one above 10,000 mm."""

STEPS: Final = (0, 1, 2, 5, 20, 100, 1000)
"""Units of the last digit by which the base radius exceeds the limit, tried in turn. The first
nearly always suffices: the others are for a limit that is within rounding of its decimals, or that
leaves no room there at all."""

FACE_DECIMALS: Final = 2
"""Decimals of the ends of a face, in mm."""

MORE: Final = 5
"""Most additional decimals of the second dimension."""

TRIES: Final = 4
"""Most places tried for a base radius; each takes into account what the previous one broke."""

NEAR: Final = 1e-11
"""A limit that exceeds a rounded number by less than this fraction counts as equal to it."""

WIDTH, ZOOM, ZOOMS, WAYS = 0.1, 8.0, 12, 65
"""Search for the direction with the most room: half the first range [rad], by how much the next one
is narrower, the number of ranges, and the number of directions in each."""

SHOCK_FINDINGS: Final = ("tangent-closure", "lost-stroke")
"""Findings that a motion with jumps of its velocity has at any size."""


@dataclass(frozen=True, slots=True)
class RoundedMechanism:
    """A mechanism whose sizes can be written down.

    Attributes
    ----------
    lengths : lengths of the follower by their scene's keys, in the scene's unit.
    cam : the cam with these lengths.
    """

    lengths: dict[str, float | list[float]]
    cam: Cam

    @staticmethod
    def from_sizing(
        task: Placing, sizing: Sizing, ratio: float, present: float | None, unit: float
    ) -> RoundedMechanism | None:
        """The answer of a sizing with its sizes rounded up; None if there is none, or none sound.

        The arm is among the lengths if it is not the `present` one [mm]. `unit` is that of the
        scene [mm].
        """
        if sizing.answer is None:
            return None
        if isinstance(task, FaceTask):
            least = sizing.radius or 0.0
            return rounded_face(task, sizing.answer.place, sizing.angle, least, unit)
        assert isinstance(task, RollerTask)
        assert sizing.examined is not None  # as there is an answer
        mechanism = rounded(task, sizing.answer.place, sizing.examined, sizing.angle, ratio, unit)
        arm = getattr(task.follower, "arm", None)
        if mechanism is None or arm is None or arm == present:
            return mechanism
        return replace(mechanism, lengths={**mechanism.lengths, "arm": float(f"{arm / unit:.12g}")})


def decimal_exponent(length: float, unit: float) -> int:
    """Power of ten of the last decimal, in a unit of `unit` mm, of a `length` [mm]."""
    first = math.floor(math.log10(length))
    last = first - SMALL if first < 0 else max(-DECIMALS, first - LARGE)
    return last - math.floor(math.log10(unit))


def upward(length: float, exponent: int, unit: float) -> Decimal:
    """The next multiple of the last decimal, 10**`exponent`, from `length` [mm] on, in the unit."""
    exact = Decimal(length / unit * (1.0 - NEAR))
    return exact.quantize(Decimal(1).scaleb(exponent), ROUND_CEILING)


def sound(cam: Cam, angle: float, ratio: float) -> bool:
    """Whether the checks find that `cam` is within its limits and makes its motion."""
    limits = Limits(transmission_angle=angle, radius_ratio=ratio)
    other = linkage_findings(cam.drive, limits)
    try:
        return not any(
            _counts(finding) for finding in disc_findings(cam, limits) if finding not in other
        )
    except GeometryError:
        return False


def _counts(finding: Finding) -> bool:
    """Whether a finding is bad and depends on the size."""
    return finding.severity not in ("ok", "warning") and not finding.name.startswith(SHOCK_FINDINGS)


def rounded(
    task: RollerTask,
    place: complex,
    conditions: PlaceConditions,
    angle: float,
    ratio: float,
    unit: float,
) -> RoundedMechanism | None:
    """The next sizes from those of `place` on; None if no rounded ones are sound.

    Parameters
    ----------
    conditions : the conditions that decide near `place`.
    angle, ratio : required transmission angle [rad] and r_R/r_K.
    unit : mm per unit of the scene.
    """
    base = abs(place - task.start)
    exponent = decimal_exponent(base, unit)
    first = upward(base, exponent, unit)
    for step in STEPS:
        radius = float(first + step * Decimal(1).scaleb(exponent))
        for _ in range(TRIES):
            middle = _roomiest(task, conditions, place, radius * unit)
            mechanism = _with_second(task, middle, radius, (angle, ratio), exponent, unit)
            if mechanism is not None and sound(mechanism.cam, angle, ratio):
                return mechanism
            phi = extreme_angles(task, middle, conditions.tangent, conditions.ratio)[0]
            pairs = no_pairs(task) if mechanism is None else covered_pairs(task, middle)
            conditions = conditions.with_more(task, phi, pairs)
            if conditions.room(np.array([middle]))[0] >= 0.0:
                break  # no known condition is broken
    return None


def _with_second(
    task: RollerTask,
    place: complex,
    radius: float,
    required: tuple[float, float],
    exponent: int,
    unit: float,
) -> RoundedMechanism | None:
    """The mechanism with a base radius, in the unit, and the second dimension near that of `place`.

    The second dimension gets as many decimals as the `required` angle and ratio take; None if no
    number of decimals suffices.
    """
    for more in range(MORE + 1):
        last = Decimal(1).scaleb(exponent - more)
        lengths: dict[str, float | list[float]] = {"base_radius": radius}
        for key, length in task.moved(place).items():
            # A scene states a pivot by its two coordinates.
            if isinstance(length, complex):
                lengths[key] = [_near(length.real, last, unit), _near(length.imag, last, unit)]
            else:
                lengths[key] = _near(length, last, unit)
        mechanism = _resized(task.cam, lengths, unit)
        if mechanism is not None and _keeps_limits(mechanism.cam, *required):
            return mechanism
    return None


def _near(length: float, last: Decimal, unit: float) -> float:
    """A length [mm] rounded to its last decimal, in the unit; never -0."""
    return float(Decimal(length / unit).quantize(last, ROUND_HALF_EVEN)) + 0.0


def _keeps_limits(cam: Cam, angle: float, ratio: float) -> bool:
    """Whether `cam` keeps its transmission angle and r_R/r_K, which is quick to check."""
    task = RollerTask.from_cam(cam)
    rating = Rating.from_place(task, task.present)
    return (
        rating is not None
        and rating.transmission_angle.value >= angle
        and rating.radius_ratio.value <= ratio
    )


def _resized(
    cam: Cam, lengths: dict[str, float | list[float]], unit: float
) -> RoundedMechanism | None:
    inside = {
        key: unit * complex(*length) if isinstance(length, list) else unit * length
        for key, length in lengths.items()
    }
    try:
        return RoundedMechanism(lengths, cam.sized(**inside))
    except GeometryError:
        return None


def _roomiest(
    task: RollerTask, conditions: PlaceConditions, place: complex, radius: float
) -> complex:
    """The place with a base radius [mm], near `place`, that leaves the conditions most room."""
    theta = float(np.angle(place - task.start))
    width = WIDTH
    for _ in range(ZOOMS):
        ways = np.clip(theta + width * np.linspace(-1.0, 1.0, WAYS), *task.directions)
        room = conditions.room(task.start + radius * np.exp(1j * ways))
        theta = float(ways[int(np.argmax(room))])
        width /= ZOOM
    return complex(task.start + radius * np.exp(1j * theta))


def rounded_face(
    task: FaceTask, place: complex, angle: float, least: float, unit: float
) -> RoundedMechanism | None:
    """The mechanism with the next base radius from that of `place` on; None if none is sound.

    A face with ends is made as long as the contact requires. `least` is the smallest radius of
    curvature allowed [mm].
    """
    base = task.base_radius(place)
    exponent = decimal_exponent(base, unit)
    first = upward(base, exponent, unit)
    for step in STEPS:
        radius = first + step * Decimal(1).scaleb(exponent)
        mechanism = _resized(task.cam, {"base_radius": float(radius)}, unit)
        if mechanism is None:
            continue
        longer = _long_enough(mechanism, unit)
        curve = longer.cam.disc.pitch_curve
        if sound(longer.cam, angle, 1.0) and convexity(curve).radius[0] >= least:
            return longer
    return None


def _long_enough(mechanism: RoundedMechanism, unit: float) -> RoundedMechanism:
    """The mechanism with its face, if that has ends, as long as the contact requires."""
    face = mechanism.cam.follower.face
    if face is None:
        return mechanism
    try:
        places = contact_extremes(mechanism.cam.disc.pitch_curve)
    except GeometryError:
        return mechanism
    last = Decimal(1).scaleb(-FACE_DECIMALS - math.floor(math.log10(unit)))
    low, high = places.smallest()[0], places.largest()[0]
    ends = [end / unit for end in face]
    if low < face[0]:
        ends[0] = float(Decimal(low / unit).quantize(last, ROUND_FLOOR))
    if high > face[1]:
        ends[1] = float(Decimal(high / unit).quantize(last, ROUND_CEILING))
    if ends == [end / unit for end in face]:
        return mechanism
    follower: Any = mechanism.cam.follower  # a frozen dataclass
    longer = replace(follower, face=(unit * ends[0], unit * ends[1]))
    cam = replace(mechanism.cam, follower=longer, ledger=Ledger())
    return RoundedMechanism({**mechanism.lengths, "face": ends}, cam)


# -- arm ------------------------------------------------------------------------------------------
# The arm of an oscillating follower, optimised within a range together with the cam axis.
#
# For a given swing all lengths of a rocker scale with the arm l_3: places of the cam axis as P/l_3,
# curvatures as kappa l_3. For the transmission angle alone the smallest base circle is therefore
# proportional to the arm, and the shortest arm gives the smallest. The roller does not scale: it is
# large relative to a short arm, so with r_R <= ratio r_K the best arm may lie inside the range.
# No arm above r_G,best/r_G,mu times the shortest one can be better, which bounds the search.


ARMS = 7
"""Number of arms tried first, in equal ratios from the shortest to the longest that can be
better."""

SECTIONS = 14
"""Golden sections of the two intervals about the best of them: to 1e-3 of an interval."""

ROUNDS = 150
"""The sections end when the sizings of all arms have taken this many rounds: where global undercut
decides, one sizing takes a dozen, and the best arm is approached less closely."""

CLOSE = 1e-3
"""If an arm longer than the shortest by this fraction is no better, the shortest is the best."""

NO_ARM: Final = "only an oscillating roller follower has an arm to be sized"

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


def with_arm(task: RollerTask, arm: float) -> RollerTask:
    """The mechanism with an arm of the length `arm` [mm], its pivot and base circle scaled too."""
    follower = task.follower
    scale = arm / follower.arm
    pivot, base_radius = follower.pivot * scale, follower.base_radius * scale
    return RollerTask.from_cam(task.cam.sized(arm=arm, pivot=pivot, base_radius=base_radius))


def size_with_arm(
    task: RollerTask, angle: float, ratio: float, low: float, high: float
) -> tuple[RollerTask, Sizing]:
    """The mechanism with the arm that gives the smallest base circle, and its sizing.

    Parameters
    ----------
    angle, ratio : as for `Sizing.solve`.
    low, high : the shortest and the longest arm [mm].

    Raises
    ------
    GeometryError
        With key "follower.kind" for a follower without an arm, "arm" if the range is invalid or
        lets the roller reach the pivot; and as `Sizing.solve` does.
    """
    if task.held is None:
        raise GeometryError(NO_ARM, key="follower.kind", value=task.follower.kind)
    roller = task.follower.roller_radius
    if not (roller < low <= high < math.inf):
        raise GeometryError(
            f"must be two lengths, the shorter one first, above the roller radius, {roller:g} mm:"
            " the roller must not reach the pivot",
            key="arm",
            value=f"{low:g} {high:g}",
        )
    tried: dict[float, Sizing] = {}

    def radius(arm: float) -> float:
        if arm not in tried:
            tried[arm] = Sizing.solve(with_arm(task, arm), angle, ratio)
        answer = tried[arm].answer
        return math.inf if answer is None else answer.base_radius

    def result(arm: float) -> tuple[RollerTask, Sizing]:
        return with_arm(task, arm), tried[arm]

    shortest = radius(low)
    alone = tried[low].for_angle
    if alone is None or shortest == alone.base_radius or low == high:
        return result(low)
    per_arm = alone.base_radius / low
    # For the angle alone the circle grows with the arm, so a longer one than this needs a larger
    # circle than the shortest arm does.
    high = min(high, shortest / per_arm)
    arms = [float(arm) for arm in np.geomspace(low, high, ARMS)]
    for arm in arms:
        if arm * per_arm < min(radius(other) for other in tried):
            radius(arm)
    if all(math.isinf(radius(arm)) for arm in tried):
        return result(low)
    best = min(tried, key=radius)
    if best == low and radius(low * (1.0 + CLOSE)) >= radius(low):
        return result(low)
    step = (high / low) ** (1.0 / (ARMS - 1))
    left, right = max(low, best / step), min(high, best * step)
    for _ in range(SECTIONS):
        if right <= left * (1.0 + 1e-4) or sum(sizing.rounds for sizing in tried.values()) > ROUNDS:
            break
        # The golden section of the logarithm of the arm.
        first = right * (left / right) ** GOLDEN
        second = left * (right / left) ** GOLDEN
        if radius(first) <= radius(second):
            right = second
        else:
            left = first
    return result(min(tried, key=radius))


# -- sides ----------------------------------------------------------------------------------------
# The sizing of a cam whatever its follower: on both sides of a rocker, then rounded up.


def rated(cam: Cam) -> Rating | None:
    """The rating of a cam as it is; None if there is no such mechanism."""
    rating: Rating | None
    if cam.follower.has_pitch_curve:
        task = RollerTask.from_cam(cam)
        rating = Rating.from_place(task, task.present)
    else:
        face = FaceTask.from_cam(cam)
        rating = face.rate_place(face.present)
    return None if rating is None else replace(rating, follower=cam.follower)


def sized(
    cam: Cam,
    angle: float,
    ratio: float,
    radius: float,
    arms: tuple[float, float] | None,
    unit: float,
) -> list[tuple[Placing, Sizing]]:
    """The tasks of both sides of a rocker, or of the one of a guide, each with its sizing.

    The side of the present cam comes first.

    Parameters
    ----------
    angle, ratio, radius : limits as for `Sizing.solve` and `FaceTask.size`.
    arms : the shortest and the longest arm of a rocker [mm], to look for its arm too.
    unit : unit of written lengths [mm].

    Raises
    ------
    GeometryError
        As `Sizing.solve`, `FaceTask.size` and `size_with_arm`.
    """
    if cam.follower.has_pitch_curve:
        sides = RollerTask.from_cam(cam).sides
        if arms is None:
            return [(side, Sizing.solve(side, angle, ratio)) for side in sides]
        return [_with_stated_arm(side, angle, ratio, arms, unit) for side in sides]
    if arms is not None:
        raise GeometryError(NO_ARM, key="follower.kind", value=cam.follower.kind)
    return [(side, side.size(angle, radius)) for side in FaceTask.from_cam(cam).sides]


def _with_stated_arm(
    side: RollerTask, angle: float, ratio: float, arms: tuple[float, float], unit: float
) -> tuple[RollerTask, Sizing]:
    """The sizing with the best arm, rounded to the decimals with which it is written."""
    task, sizing = size_with_arm(side, angle, ratio, *arms)
    best_arm = task.follower.arm
    last = Decimal(1).scaleb(decimal_exponent(best_arm, unit))
    arm = min(max(unit * float(Decimal(best_arm / unit).quantize(last)), arms[0]), arms[1])
    if best_arm in arms or arm == best_arm:
        return task, sizing
    task = with_arm(task, arm)
    return task, Sizing.solve(task, angle, ratio)
