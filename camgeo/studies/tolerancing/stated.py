"""The tolerances that a scene states in `[tolerance]`, with its units converted."""

from __future__ import annotations

import math
import re
from bisect import bisect_left
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial, singledispatch
from typing import Any, Final, Literal

import numpy as np

from camgeo.design.design import Design
from camgeo.errors import GeometryError, SceneError, meant
from camgeo.geometry.outline.path import Flank
from camgeo.kinematics.mechanism.flat import OscillatingFlat, TranslatingFlat
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.linkage import Linkage
from camgeo.kinematics.mechanism.linkages import FourBar
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.numeric.arrays import FloatArray
from camgeo.record import schema_beside
from camgeo.scene.keys import KeyPath, spelled
from camgeo.scene.rules import TOLERANCE
from camgeo.scene.scene import Scene
from camgeo.studies.tolerancing.sensitivity import (
    Freedom,
    Hold,
    Machine,
    Unit,
    Way,
)
from camgeo.units import MM_PER, TURN, listed

Table = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Moments:
    """Of a random number: its mean and its variance."""

    mean: float
    variance: float


@dataclass(frozen=True, slots=True)
class Source:
    """Something random that machines deviate by: a dimension, a clearance, an error of form.

    Attributes
    ----------
    name : its key.
    sense : what a positive deviation is, in words.
    units : of the numbers by which machines deviate.
    moments : of each of these numbers, which are uncorrelated; of two, in a random direction, the
        mean is 0.
    draws : uniformly distributed numbers that make one machine.
    numbers : gives (units, m) numbers from shares (draws, m), within (0, 1).
    limits : of what is stated [mm or rad].
    shape : of its distribution, in a word.
    is_angle : whether it is in rad.
    """

    name: str
    sense: str
    units: tuple[Unit, ...]
    moments: Moments
    draws: int
    numbers: Callable[[FloatArray], FloatArray]
    limits: tuple[float, float]
    shape: str
    is_angle: bool = False


@dataclass(frozen=True)
class Stated:
    """What a scene states.

    Attributes
    ----------
    machine : the nominal one; of a follower that two sides hold, where the main one carries it.
    second : the same where the other side carries it; None if there is none.
    sources : of deviations, in the order of the scene.
    limit : largest error of the position that is allowed [mm or rad]; None if there is none.
    set_at : cam angle [rad] at which the error is set to 0; None if it is not.
    """

    machine: Machine
    second: Machine | None
    sources: tuple[Source, ...]
    limit: float | None
    set_at: float | None


def stated_of(design: Design) -> Stated:
    """The tolerances of a design's scene.

    Raises
    ------
    SceneError
        If it states none, a key that is no dimension of the machine, with the nearest one, an
        unknown tolerance class, a fit without clearance, or a side that the follower has not.
    GeometryError
        If its kind of machine, or its flank, cannot be analysed.
    """
    scene = design.scene
    table: Table | None = scene.values.get(TOLERANCE)
    if table is None:
        message = "is missing: it states the tolerances, see docs/tolerance.md"
        raise _refused(scene, (TOLERANCE,), message)
    machine, second = machines_of(design, table.get("flank"))
    for each in (machine, second):
        if each is not None:
            each.require_whole()
    sides = Sides(scene, machine, second)
    sources = (*_dimensions(sides, table), *_fits(sides, table), *_forms(sides, table))
    limit, set_at = table.get("limit"), table.get("set_at")
    per = math.radians(1.0) if design.drive.unit == "rad" else MM_PER[scene.unit]
    return Stated(
        machine,
        second,
        sources,
        None if limit is None else float(limit) * per,
        None if set_at is None else math.radians(set_at),
    )


def machines_of(design: Design, flank: str | None = None) -> tuple[Machine, Machine | None]:
    """The machine of a design on a flank, by default its main one; and of a follower that two sides
    hold, where the other side carries it.
    """
    cam, *others = design.cams
    if cam.opposite is not None:
        others = [cam.opposite]
    main = Hold.MAIN if others else Hold.ANY
    second = [Machine(each, Flank(each.contact.main), Hold.RETURN) for each in others]
    return Machine(cam, Flank(flank or cam.contact.main), main), second[0] if second else None


@dataclass(frozen=True)
class Sides:
    """The machine of a scene, by the sides that hold its follower."""

    scene: Scene
    machine: Machine
    second: Machine | None

    def hold_of(self, place: KeyPath, table: Table, *, is_disc: bool) -> Hold:
        """The side that a fit or an error of form is on: of a yoke, both sides have one disc."""
        whole = self.second is None or (is_disc and self.second.cam.mount is None)
        if whole and "side" in table:
            what = "has one disc" if self.second is not None else "is held by one side"
            raise _refused(self.scene, (*place, "side"), f"belongs to two: this follower {what}")
        return Hold.ANY if whole else Hold(table.get("side", Hold.MAIN))


def _refused(scene: Scene, path: KeyPath, message: str, hint: str = "") -> SceneError:
    return SceneError([scene.stated.scene.fault(path, message, hint)], scene.source.file)


def _dimensions(sides: Sides, table: Table) -> Iterator[Source]:
    scene, machine = sides.scene, sides.machine
    known = dimensions_of(machine, sides.second)
    for index, each in enumerate(table.get("dimension", ())):
        key, place = each["key"], (TOLERANCE, "dimension", index)
        if key not in known:
            kind = machine.cam.follower.kind
            message = f"is no dimension of this {kind} machine; it has {listed(sorted(known))}"
            raise _refused(scene, (*place, "key"), message, meant(key, known))
        dimension = known[key]
        distribution = _distribution(scene, place, each, dimension)
        yield Source(
            key,
            dimension.sense,
            (dimension.unit,),
            Moments(distribution.mean, distribution.variance),
            1,
            distribution.quantile,
            (distribution.low, distribution.high),
            distribution.shape,
            dimension.is_angle,
        )


def _distribution(scene: Scene, place: KeyPath, table: Table, dimension: Dimension) -> Distribution:
    mm = MM_PER[scene.unit]
    per = math.radians(1.0) if dimension.is_angle else mm
    if "class" in table:
        if dimension.size is None:
            message = "belongs to lengths: this dimension takes plus_minus or limits"
            raise _refused(scene, (*place, "class"), message)
        low, high = (
            each * dimension.per_size
            for each in _class(scene, (*place, "class"), table["class"], dimension.size)
        )
    elif "limits" in table:
        low, high = (float(each) * per for each in table["limits"])
    else:
        high = float(table["plus_minus"]) * per
        low = -high
    shape: Shape = table.get("distribution", "normal")
    sigma = table.get("sigma")
    return Distribution(low, high, shape, None if sigma is None else float(sigma) * per)


def _class(scene: Scene, path: KeyPath, name: str, size: float) -> tuple[float, float]:
    try:
        return limits_of(name, size)
    except GeometryError as error:
        raise _refused(scene, path, error.message) from error


def _fits(sides: Sides, table: Table) -> Iterator[Source]:
    scene, machine = sides.scene, sides.machine
    for index, each in enumerate(table.get("clearance", ())):
        place = (TOLERANCE, "clearance", index)
        size = _size(scene, place, each)
        limits = {}
        for key, hole in (("hole", True), ("shaft", False)):
            if is_hole(each[key]) is not hole:
                letters = "a capital letter" if hole else "a small letter"
                raise _refused(scene, (*place, key), f"must begin with {letters}")
            limits[key] = _class(scene, (*place, key), each[key], size)
        if limits["hole"][0] < limits["shaft"][1]:
            over = PER_MM * (limits["shaft"][1] - limits["hole"][0])
            message = (
                f"is no fit with clearance: {each['hole']}/{each['shaft']} may interfere by"
                f" {over:.4g} micrometres; leave it out, or state a looser fit"
            )
            raise _refused(scene, place, message)
        hold = sides.hold_of(place, each, is_disc=each["at"] == "cam")
        yield _clearance(place, each, hold, machine.flank, limits)


def _size(scene: Scene, place: KeyPath, table: Table) -> float:
    """The nominal diameter [mm]."""
    if "size" in table:
        return float(table["size"]) * MM_PER[scene.unit]
    if scene.part is None or scene.part.bore is None:
        message = "is missing: the scene has no part.bore, whose diameter is the default"
        raise _refused(scene, (*place, "size"), message)
    return scene.part.bore


def _clearance(
    place: KeyPath,
    table: Table,
    hold: Hold,
    flank: Flank,
    limits: Mapping[str, tuple[float, float]],
) -> Source:
    shape: Shape = table.get("distribution", "normal")
    hole, shaft = (Distribution(*limits[key], shape) for key in ("hole", "shaft"))
    # Of half the clearance, by which one may lie off the other.
    half = Moments(0.5 * (hole.mean - shaft.mean), 0.25 * (hole.variance + shaft.variance))
    ends = hole.low - shaft.high, hole.high - shaft.low
    name = f"{spelled(place[1:])} {table['hole']}/{table['shaft']}"
    at_cam = table["at"] == "cam"
    if at_cam and table.get("shifted", "anywhere") == "anywhere":
        axes = _both_axes(Freedom(Way.SEAT, hold=hold))
        # Half the mean square of the distance in each direction, which turns with the cam.
        moments = Moments(0.0, 0.5 * (half.mean**2 + half.variance))
        what, numbers = "the cam lies anywhere in its clearance", partial(_anywhere, hole, shaft)
        return Source(name, what, axes, moments, 3, numbers, ends, shape)
    what = f"the load pushes the {'cam' if at_cam else 'roller'} back"
    # The follower comes nearer to the material by half the clearance.
    unit = Unit(Freedom(Way.GROWTH, hold=hold), float(flank.sign))
    return Source(name, what, (unit,), half, 2, partial(_pressed, hole, shaft), ends, shape)


def _forms(sides: Sides, table: Table) -> Iterator[Source]:
    for index, each in enumerate(table.get("form", ())):
        height = float(each["plus_minus"]) * MM_PER[sides.scene.unit]
        waves = int(each["waves"])
        hold = sides.hold_of((TOLERANCE, "form", index), each, is_disc=True)
        yield Source(
            f"form[{index + 1}]",
            f"{waves} waves on the flank",
            _both_axes(Freedom(Way.WAVE, waves, hold)),  # in phase and a quarter of a wave later
            Moments(0.0, 0.5 * height**2),  # at any place the phase is uniformly distributed
            1,
            partial(_in_any_phase, height),
            (-height, height),
            "random phase",
        )


def _both_axes(freedom: Freedom) -> tuple[Unit, ...]:
    return Unit(freedom), Unit(freedom, 1j)


def _pressed(hole: Distribution, shaft: Distribution, shares: FloatArray) -> FloatArray:
    """(1, m) half the clearance [mm]; a normal distribution may pass its limits, not 0."""
    clearance = hole.quantile(shares[0]) - shaft.quantile(shares[1])
    return (0.5 * np.maximum(clearance, 0.0))[np.newaxis]


def _anywhere(hole: Distribution, shaft: Distribution, shares: FloatArray) -> FloatArray:
    (sizes,) = _pressed(hole, shaft, shares[:2])
    return _in_direction(sizes, shares[2])


def _in_any_phase(height: float, shares: FloatArray) -> FloatArray:
    return _in_direction(np.full(shares.shape[1], height), shares[0])


def _in_direction(sizes: FloatArray, shares: FloatArray) -> FloatArray:
    """(2, m) components of vectors of these sizes (m,), at shares (m,) of a turn."""
    angle = TURN * shares
    return np.stack((sizes * np.cos(angle), sizes * np.sin(angle)))


# -- distribution ---------------------------------------------------------------------------------
# How a deviation is distributed between its limits.


Shape = Literal["normal", "uniform", "triangular"]

SHAPES: Final[tuple[Shape, ...]] = ("normal", "uniform", "triangular")

SIGMAS: Final = 3.0
"""Standard deviations of a normal distribution from its mean to a limit, unless one is stated."""

WIDTHS: Final[dict[Shape, float]] = {
    "normal": SIGMAS,
    "uniform": math.sqrt(3.0),
    "triangular": math.sqrt(6.0),
}
"""Half the range between the limits, in standard deviations."""


@dataclass(frozen=True, slots=True)
class Distribution:
    """A random deviation [mm or rad].

    Attributes
    ----------
    low, high : its limits; a normal distribution goes beyond them.
    shape : symmetric about the middle of the limits.
    stated : the standard deviation, if it is not what limits and shape say; else None.
    """

    low: float
    high: float
    shape: Shape = "normal"
    stated: float | None = None

    @property
    def mean(self) -> float:
        """Its expected value."""
        return 0.5 * (self.low + self.high)

    @property
    def sigma(self) -> float:
        """Its standard deviation."""
        if self.stated is not None:
            return self.stated
        return 0.5 * (self.high - self.low) / WIDTHS[self.shape]

    @property
    def variance(self) -> float:
        """Its variance."""
        return self.sigma**2

    def quantile(self, share: FloatArray) -> FloatArray:
        """(n,) values below which the shares (n,), within (0, 1), of all values lie."""
        unit = _NORMALISED[self.shape](share)
        return self.mean + self.sigma * unit


def _normal(share: FloatArray) -> FloatArray:
    from scipy.special import ndtri  # where nothing is drawn, nothing is loaded

    return np.asarray(ndtri(share))


def _uniform(share: FloatArray) -> FloatArray:
    return WIDTHS["uniform"] * (2.0 * share - 1.0)


def _triangular(share: FloatArray) -> FloatArray:
    low = share < 0.5
    tail = np.where(low, share, 1.0 - share)
    rest = WIDTHS["triangular"] * (1.0 - np.sqrt(2.0 * tail))
    return np.where(low, -rest, rest)


_NORMALISED: Final = {"normal": _normal, "uniform": _uniform, "triangular": _triangular}
"""Quantiles with the mean 0 and the standard deviation 1."""


# -- dimensions -----------------------------------------------------------------------------------
# The dimensions of a machine that may have tolerances, and the freedoms in which they deviate.
#
# What only some followers and linkages have is registered by class.


@dataclass(frozen=True, slots=True)
class Dimension:
    """A dimension of the machine.

    Attributes
    ----------
    unit : how the machine deviates where the dimension is 1 mm or rad too large.
    sense : what a positive deviation is, in words.
    size : the size [mm] to which a tolerance class belongs; None if it has none.
    per_size : deviation of the dimension per deviation of that size.
    is_angle : whether it is in rad.
    """

    unit: Unit
    sense: str
    size: float | None = None
    per_size: float = 1.0
    is_angle: bool = False

    def of_side(self, hold: Hold) -> Dimension:
        """The same of one side alone, of a follower that two sides hold."""
        return replace(self, unit=self.unit.of_side(hold))


MOUNTED: Final[Mapping[str, Dimension]] = {
    "mounting.x": Dimension(
        Unit(Freedom(Way.SEAT)), "the flank lies farther along x of the cam, on its shaft"
    ),
    "mounting.y": Dimension(
        Unit(Freedom(Way.SEAT), 1j), "the flank lies farther along y of the cam, on its shaft"
    ),
    "mounting.angle": Dimension(
        Unit(Freedom(Way.TIMING)),
        "the disc runs ahead of its shaft, as it turns",
        is_angle=True,
    ),
    "shaft.x": Dimension(Unit(Freedom(Way.SHAFT)), "the cam axis lies farther along x"),
    "shaft.y": Dimension(Unit(Freedom(Way.SHAFT), 1j), "the cam axis lies farther along y"),
}
"""Dimensions that every machine has and no scene states, by the keys that tolerances give them."""


TOUCHING: Final = frozenset((Way.GROWTH, Way.BODY))
"""What is one side's own on any follower that two sides hold."""

OF_A_DISC: Final = frozenset((Way.SEAT, Way.TIMING))
"""What is one side's own where each has a disc."""


def dimensions_of(machine: Machine, second: Machine | None = None) -> dict[str, Dimension]:
    """All dimensions of the machine, by their keys; `second` is its other side, if two hold it."""
    found = dict(MOUNTED)
    own = _follower(machine.cam.follower, machine)
    found.update({f"follower.{key}": each for key, each in own.items()})
    if second is not None:
        mount = second.cam.mount
        mine = TOUCHING if mount is None else TOUCHING | OF_A_DISC
        for key, each in found.items():
            if each.unit.freedom.way in mine:
                found[key] = each.of_side(Hold.MAIN)
        own = _yoke(second) if mount is None else _returning(second.cam.follower, second)
        table = "follower.yoke" if mount is None else "follower.return"
        others = {f"{table}.{key}": each for key, each in own.items()}
        if mount is not None:
            others |= {f"return.{key}": each for key, each in MOUNTED.items() if "mount" in key}
        found.update({key: each.of_side(Hold.RETURN) for key, each in others.items()})
    if machine.linkage is not None:
        behind = _linkage(machine.linkage)
        found.update({f"linkage.{key}": each for key, each in behind.items()})
    return found


def _length(way: Way, sense: str, size: float, factor: complex = 1.0) -> Dimension:
    return Dimension(Unit(Freedom(way), factor), sense, size)


def _radius(follower: Follower, machine: Machine) -> dict[str, Dimension]:
    if follower.has_edge:
        return {}
    unit = Unit(Freedom(Way.GROWTH), float(-machine.flank.sign))
    diameter = 2.0 * follower.roller_radius
    return {"roller_radius": Dimension(unit, "the roller is larger", diameter, 0.5)}


def _setting() -> dict[str, Dimension]:
    sense = "the lift is counted from farther outward"
    return {"base_radius": Dimension(Unit(Freedom(Way.SETTING)), sense)}


def _place(way: Way, key: str, what: str) -> dict[str, Dimension]:
    return {
        f"{key}[1]": Dimension(Unit(Freedom(way)), f"{what} lies farther along x"),
        f"{key}[2]": Dimension(Unit(Freedom(way), 1j), f"{what} lies farther along y"),
    }


@singledispatch
def _follower(_: Follower, __: Machine) -> dict[str, Dimension]:
    """Of a follower, by their keys in its table."""
    return {}


def _guide_angle() -> dict[str, Dimension]:
    unit = Unit(Freedom(Way.TILT))
    sense = "the guide is turned counter-clockwise about the cam axis"
    return {"guide_angle": Dimension(unit, sense, is_angle=True)}


@_follower.register
def _(follower: TranslatingRoller, machine: Machine) -> dict[str, Dimension]:
    right = -1j * follower.outward
    sense = "the roller's path lies farther to the right, looking along the guide"
    offset = {"offset": Dimension(Unit(Freedom(Way.BODY), right), sense)}
    return _radius(follower, machine) | _setting() | offset | _guide_angle()


@_follower.register
def _(follower: OscillatingRoller, machine: Machine) -> dict[str, Dimension]:
    along = follower.start_arm / abs(follower.start_arm)
    arm = {"arm": _length(Way.BODY, "the arm is longer", follower.arm, along)}
    place = _place(Way.PIVOT, "pivot", "the rocker's shaft")
    return _radius(follower, machine) | _setting() | arm | place


@_follower.register
def _(_: TranslatingFlat, __: Machine) -> dict[str, Dimension]:
    return _setting() | _guide_angle()


@_follower.register
def _(follower: OscillatingFlat, _: Machine) -> dict[str, Dimension]:
    foot = follower.traced_point(0.0)
    unit = Unit(Freedom(Way.BODY), foot / abs(foot))
    sense = "the face lies farther from the cam axis on its rocker"
    face = {"face_offset": Dimension(unit, sense)}
    return _setting() | face | _place(Way.PIVOT, "pivot", "the rocker's shaft")


def _yoke(second: Machine) -> dict[str, Dimension]:
    """Of the second side of a yoke, by their keys in its table."""
    follower = second.cam.follower
    place = follower.traced_point(0.0)
    breadth = _length(
        Way.BODY, "the second side lies farther from the first",
        second.cam.yoke_breadth, place / abs(place),
    )  # fmt: skip
    own = _follower(follower, second)
    return {"breadth": breadth} | {key: own[key] for key in own if key == "roller_radius"}


@singledispatch
def _returning(_: Follower, __: Machine) -> dict[str, Dimension]:
    """Of the return roller of a pair, by their keys in its table."""
    return {}


@_returning.register
def _(follower: TranslatingRoller, second: Machine) -> dict[str, Dimension]:
    assert second.cam.mount is not None
    right = 1j * follower.outward  # the main roller looks the other way
    offset = Unit(Freedom(Way.BODY), right)
    spacing = dict(second.cam.mount.given)["spacing"]
    return {
        "spacing": _length(
            Way.BODY, "the return roller lies farther from the main one", spacing, follower.outward
        ),
        "offset": Dimension(offset, "the return roller's path lies farther to the right"),
        **_radius(follower, second),
    }


@_returning.register
def _(follower: OscillatingRoller, second: Machine) -> dict[str, Dimension]:
    along = follower.start_arm / abs(follower.start_arm)
    turned = Dimension(
        Unit(Freedom(Way.BODY), 1j * follower.start_arm),
        "the return arm is turned counter-clockwise against the main one",
        is_angle=True,
    )
    return {
        "arm": _length(Way.BODY, "the return arm is longer", follower.arm, along),
        "arm_angle": turned,
        **_radius(follower, second),
    }


@singledispatch
def _linkage(linkage: Linkage) -> dict[str, Dimension]:
    """Of a linkage, by their keys in its table: what all have."""
    return {
        "crank": _length(Way.CRANK, "the crank is longer", linkage.crank),
        "coupler": _length(Way.COUPLER, "the coupler is longer", linkage.coupler),
    }


@_linkage.register
def _(linkage: FourBar) -> dict[str, Dimension]:
    angle = Dimension(
        Unit(Freedom(Way.FAR_ANGLE)),
        "the lever's pin is turned counter-clockwise on the lever",
        is_angle=True,
    )
    return {
        **_linkage.dispatch(object)(linkage),
        "lever": _length(Way.LEVER, "the lever is longer", linkage.lever),
        **_place(Way.FAR_SHAFT, "shaft", "the lever's shaft"),
        "lever_angle": angle,
    }


# -- iso286 ---------------------------------------------------------------------------------------
# Tolerance classes of ISO 286-1, as "H7" of a hole and "g6" of a shaft; values in iso286.json.


FORM: Final = re.compile(r"(?P<letters>[A-Za-z]{1,2})(?P<grade>\d{1,2})")

SHAFTS: Final = (
    "a", "b", "c", "d", "e", "f", "g", "h", "js", "k", "m", "n", "p", "r", "s", "t", "u",
)  # fmt: skip

HOLES: Final = tuple(letter.upper() for letter in SHAFTS)

K_GRADES: Final = range(4, 8)
"""In which a shaft k has a fundamental deviation other than 0."""

SMALLEST: Final = 3.0
"""Sizes [mm] up to which all holes are shafts reversed."""

PER_MM: Final = 1000.0
"""Micrometres."""


def limits_of(name: str, size: float) -> tuple[float, float]:
    """Lower and upper deviation [mm] of a size [mm] of the tolerance class `name`.

    Raises
    ------
    GeometryError
        If there is no such class here, the size is not above 0 and up to 500 mm, or the class has
        no value at this size in ISO 286-1.
    """
    data = _data()
    parts = FORM.fullmatch(name)
    letters, number = (parts["letters"], parts["grade"]) if parts else ("", "")
    if letters not in (*HOLES, *SHAFTS) or number not in data["grades"]:
        grades = [f"IT{each}" for each in data["grades"]]
        raise GeometryError(
            "is no tolerance class that is known here: a letter of holes"
            f" ({listed(HOLES)}) or of shafts ({listed(SHAFTS)}) and a grade from {grades[0]} to"
            f' {grades[-1]}, e.g. "H7"',
            value=name,
        )
    most = data["up_to"][-1]
    if not 0.0 < size <= most:
        message = f"belongs to sizes above 0 up to {most} mm, and this one is {size:g} mm"
        raise GeometryError(message, value=name)
    grade = int(number)
    _require_value(name, letters, grade, size)
    width = _standard(grade, size) / PER_MM
    letter = letters.lower()
    if letter == "js":
        return -0.5 * width, 0.5 * width
    if letter in data["upper"]:
        high = _of_size(data["upper"][letter], size) / PER_MM
        return (0.0 - high, width - high) if is_hole(name) else (high - width, high)
    if is_hole(name):
        high = _highest(letters, grade, size) / PER_MM
        return high - width, high
    zero = letter == "k" and grade not in K_GRADES
    low = 0.0 if zero else _of_size(data["lower"][letter], size) / PER_MM
    return low, low + width


def _require_value(name: str, letters: str, grade: int, size: float) -> None:
    for each in _data()["absent"]:
        (first, last), (above, up_to) = each["grades"], each["sizes"]
        known = letters in each.get("letters", letters)
        if known and first <= grade <= last and above < size <= up_to:
            raise GeometryError(
                f"has no value in ISO 286-1: there are none of {letters}{first} to"
                f" {letters}{last} for sizes above {above} up to {up_to} mm, and this one is"
                f" {size:g} mm",
                value=name,
            )


def _highest(letters: str, grade: int, size: float) -> float:
    """Upper deviation [micrometres] of a hole K to U: its shaft's, reversed, plus delta, by which a
    hole fits the shaft of the next finer grade as it would by the system of the basic hole.
    """
    data = _data()
    high = 0.0 - _of_size(data["lower"][letters.lower()], size)
    if size <= SMALLEST:
        return high
    if grade > data["delta_up_to"][letters]:
        return 0.0 if letters == "N" else high
    nearer = data["exceptions"].get(f"{letters}{grade}")
    if nearer and nearer["sizes"][0] < size <= nearer["sizes"][1]:
        return float(nearer["high"])
    return high + _standard(grade, size) - _standard(grade - 1, size)


def _standard(grade: int, size: float) -> float:
    """The standard tolerance IT of a grade [micrometres]."""
    return _of_size(_data()["grades"][str(grade)], size)


def _of_size(values: Sequence[float], size: float) -> float:
    """The value of the range that a size is in; some letters have more ranges than others."""
    data = _data()
    ranges = next(
        each for each in (data["up_to"], data["up_to_finely"]) if len(each) == len(values)
    )
    return float(values[bisect_left(ranges, size)])


def is_hole(name: str) -> bool:
    """Whether a valid class is one of holes."""
    return name[:1].isupper()


@cache
def _data() -> dict[str, Any]:
    return schema_beside(__file__, "iso286")
