"""The dimensions of a machine that may have tolerances, and the freedoms in which they deviate.

What only some followers and linkages have is registered by class.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import singledispatch
from typing import Final

from camgeo.mechanism.follower import Follower
from camgeo.mechanism.four_bar import FourBar
from camgeo.mechanism.linkage_protocol import Linkage
from camgeo.mechanism.oscillating_flat import OscillatingFlat
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_flat import TranslatingFlat
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.tolerancing.freedoms import Freedom, Hold, Unit, Way
from camgeo.tolerancing.machine import Machine


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
        others = _yoke(second) if mount is None else _returning(second.cam.follower, second)
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
    """Of the second side of a yoke."""
    follower = second.cam.follower
    place = follower.traced_point(0.0)
    breadth = _length(
        Way.BODY, "the second side lies farther from the first",
        second.cam.yoke_breadth, place / abs(place),
    )  # fmt: skip
    found = {"breadth": breadth}
    own = _follower(follower, second)
    found |= {key: each for key, each in own.items() if key == "roller_radius"}
    return {f"follower.yoke.{key}": each for key, each in found.items()}


@singledispatch
def _returning(_: Follower, __: Machine) -> dict[str, Dimension]:
    """Of the return roller of a pair."""
    return {}


@_returning.register
def _(follower: TranslatingRoller, second: Machine) -> dict[str, Dimension]:
    assert second.cam.mount is not None
    right = 1j * follower.outward  # the main roller looks the other way
    offset = Unit(Freedom(Way.BODY), right)
    spacing = dict(second.cam.mount.given)["spacing"]
    found = {
        "spacing": _length(
            Way.BODY, "the return roller lies farther from the main one", spacing, follower.outward
        ),
        "offset": Dimension(offset, "the return roller's path lies farther to the right"),
        **_radius(follower, second),
    }
    return {f"follower.return.{key}": each for key, each in found.items()}


@_returning.register
def _(follower: OscillatingRoller, second: Machine) -> dict[str, Dimension]:
    along = follower.start_arm / abs(follower.start_arm)
    turned = Dimension(
        Unit(Freedom(Way.BODY), 1j * follower.start_arm),
        "the return arm is turned counter-clockwise against the main one",
        is_angle=True,
    )
    found = {
        "arm": _length(Way.BODY, "the return arm is longer", follower.arm, along),
        "arm_angle": turned,
        **_radius(follower, second),
    }
    return {f"follower.return.{key}": each for key, each in found.items()}


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
