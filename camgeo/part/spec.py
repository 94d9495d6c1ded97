"""The specification of the part in a scene."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any, Final, Self

from camgeo.errors import GeometryError
from camgeo.mechanism.values import Angle, Length
from camgeo.numeric.checked import check_fields, instance, instances, number, one_of, whole
from camgeo.part.chamfers import Chamfer, Chamfers
from camgeo.part.engraving import ENGRAVING, MOST_TEXTS, Engraving, engravings_of
from camgeo.part.faces import BOTH, LOWER, SIDES, UPPER
from camgeo.part.keyways import din_6885_1
from camgeo.part.materials import Density, density_of
from camgeo.part.pair_spec import Pair
from camgeo.units import TURN

MOST_HOLES: Final = 100
"""On one circle."""


@dataclass(frozen=True, slots=True)
class Keyway:
    """Keyway of the bore, a slot with parallel sides.

    Attributes
    ----------
    width : width of the slot [mm].
    depth : from the bore's edge to the bottom, measured on the middle line [mm] (t2 of DIN 6885).
    angle : direction of the middle line from the x axis at cam angle 0 [rad], counter-clockwise,
        -2 pi to 2 pi.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    width: Length
    depth: Length
    angle: Angle = 0.0

    def __post_init__(self) -> None:
        check_fields(self, "part.keyway.")

    @classmethod
    def by_standard(cls, bore: float, angle: float = 0.0) -> Self:
        """By DIN 6885-1, deep form, for a bore of that diameter [mm]; raises GeometryError with key
        "part.keyway.standard" if the table has no such bore.
        """
        row = din_6885_1(bore)
        return cls(row.width, row.depth, angle)


@dataclass(frozen=True, slots=True)
class DShaft:
    """DShaft side of the bore for a D-shaft, parallel to the cam axis.

    Attributes
    ----------
    across : from the flat to the opposite side of the bore [mm]: less than its diameter, more than
        its radius.
    angle : direction from the cam axis to the flat, from the x axis at cam angle 0 [rad],
        counter-clockwise, -2 pi to 2 pi.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    across: Length
    angle: Angle = 0.0

    def __post_init__(self) -> None:
        check_fields(self, "part.d_shaft.")


@dataclass(frozen=True, slots=True)
class Hub:
    """A round hub about the cam axis, on one face of the disc or on both.

    Attributes
    ----------
    diameter : of the hub [mm].
    height : above the face on which it stands [mm]; on both faces the same.
    side : one of `SIDES`.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    diameter: Length
    height: Length
    side: Annotated[str, partial(one_of, choices=SIDES)] = UPPER

    def __post_init__(self) -> None:
        check_fields(self, "part.hub.")


@dataclass(frozen=True, slots=True)
class SetScrew:
    """Radial hole through the hub into the bore; prismatic layers do not have it.

    Attributes
    ----------
    diameter : of the hole [mm].
    height : of its middle above the face on which the hub stands [mm].
    angle : direction from the x axis at cam angle 0 [rad], counter-clockwise, -2 pi to 2 pi.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    diameter: Length
    height: Length
    angle: Angle = 0.0

    def __post_init__(self) -> None:
        check_fields(self, "part.set_screw.")


@dataclass(frozen=True, slots=True)
class Mark:
    """A timing mark sunk in the upper face of the disc: a radial slot with round ends, or a dot.

    Attributes
    ----------
    radius : distance of its middle from the cam axis [mm].
    width : of the slot, diameter of the dot [mm].
    depth : below the upper face [mm].
    length : of the slot from end to end, along the ray [mm]; None for a dot.
    angle : direction of its middle from the x axis at cam angle 0 [rad], counter-clockwise, -2 pi
        to 2 pi.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid, or the slot no longer than wide.
    """

    radius: Length
    width: Length
    depth: Length
    length: Length | None = None
    angle: Angle = 0.0

    def __post_init__(self) -> None:
        check_fields(self, "part.mark.")
        if self.length is not None:
            number("part.mark.length", self.length, above=self.width, unit="mm")


Count = Annotated[int, partial(whole, least=1, most=MOST_HOLES)]


@dataclass(frozen=True, slots=True)
class Counterbore:
    """The wider upper end of a bolt hole, for the head of a screw.

    Attributes
    ----------
    diameter : of the counterbore [mm].
    depth : below the face on which the hole opens, that of the disc or of a hub [mm].

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    diameter: Length
    depth: Length

    def __post_init__(self) -> None:
        check_fields(self, "part.bolt_circle.counterbore.")


@dataclass(frozen=True, slots=True)
class Holes:
    """Equal round holes through the part, evenly spaced on a circle about the cam axis.

    Attributes
    ----------
    count : from 1 to `MOST_HOLES`.
    circle : diameter of the circle through their middles [mm].
    hole : diameter of each [mm].
    angle : direction of the first from the x axis at cam angle 0 [rad], counter-clockwise, -2 pi to
        2 pi.
    counterbore : of each at its upper end; None for none.

    Raises
    ------
    GeometryError
        With the key in `part.holes`, if a value is invalid, or of the counterbore, if that is no
        wider than the hole.
    """

    count: Count
    circle: Length
    hole: Length
    angle: Angle = 0.0
    counterbore: Counterbore | None = None

    def __post_init__(self) -> None:
        check_fields(self, "part.holes.")
        if self.counterbore is not None:
            key = "part.bolt_circle.counterbore.diameter"
            number(key, self.counterbore.diameter, above=self.hole, unit="mm")

    @property
    def middles(self) -> tuple[complex, ...]:
        """Of the holes [mm]."""
        step = TURN / self.count
        return tuple(
            cmath.rect(0.5 * self.circle, self.angle + number * step)
            for number in range(self.count)
        )


@dataclass(frozen=True, slots=True)
class PartSpec:
    """The specification of the part; every length in mm, None if the scene does not give it.

    Attributes
    ----------
    thickness : of the disc.
    bore : diameter of the bore.
    keyway : of the bore.
    rim : diameter of the blank, the outer boundary of a groove cam, or of a cam whose roller runs
        inside ("outer" contact).
    groove_depth : of a groove cam, less than the thickness; the groove is open to the upper face.
    hub : about the bore.
    mark : for timing, less deep than the disc is thick.
    d_shaft : flat side of the bore, in place of a keyway.
    bolt_circle, lightening_holes : holes through the disc, and through the hubs that they lie in.
    set_screw : in the hub, between its face and that of the disc.
    pair : how both discs of a conjugate pair stand on one hub, in one piece; hub and set screw are
        then the pair's.
    density : of the whole part [t/mm^3]; its shape does not depend on it.
    engraving : texts in the upper face of the disc, less deep than the disc is thick.
    chamfers : of edges; None for none.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid, groove, mark or text are as deep as the disc, a keyway
        or flat has no bore, the flat does not cut the bore, the hub is no larger than the bore, the
        set screw has no bore or does not fit into the hub, or a pair has no thickness or a spacer
        no larger than the bore.
    """

    thickness: Length | None = None
    bore: Length | None = None
    keyway: Keyway | None = None
    rim: Length | None = None
    groove_depth: Length | None = None
    hub: Hub | None = None
    mark: Mark | None = None
    d_shaft: DShaft | None = None
    bolt_circle: Holes | None = None
    lightening_holes: Holes | None = None
    set_screw: SetScrew | None = None
    pair: Pair | None = None
    density: Density | None = None
    engraving: tuple[Engraving, ...] = ()
    chamfers: Chamfers | None = None

    def __post_init__(self) -> None:
        check_fields(self, "part.")
        if self.groove_depth is not None and self.thickness is not None:
            number("part.groove_depth", self.groove_depth, below=self.thickness, unit="mm")
        if self.mark is not None and self.thickness is not None:
            number("part.mark.depth", self.mark.depth, below=self.thickness, unit="mm")
        self._check_engraving()
        if self.hub is not None and self.bore is not None:
            number("part.hub.diameter", self.hub.diameter, above=self.bore, unit="mm")
        if self.set_screw is not None:
            if self.hub is None or self.bore is None:
                raise GeometryError("belongs to a hub with a bore", key="part.set_screw")
            half, key = 0.5 * self.set_screw.diameter, "part.set_screw"
            most = min(self.hub.height, self.bore)
            number(f"{key}.diameter", self.set_screw.diameter, below=most, unit="mm")
            below = self.hub.height - half
            number(f"{key}.height", self.set_screw.height, above=half, below=below, unit="mm")
        if self.pair is not None:
            if self.thickness is None:
                raise GeometryError("needs the thickness of the discs", key="part.pair")
            if self.bore is not None:
                number("part.pair.spacer", self.pair.spacer, above=self.bore, unit="mm")
        for name in ("keyway", "d_shaft"):
            if getattr(self, name) is not None and self.bore is None:
                raise GeometryError("belongs to a bore, and there is none", key=f"part.{name}")
        if self.d_shaft is not None:
            key = "part.d_shaft"
            if self.keyway is not None:
                raise GeometryError("a bore has a keyway or is for a D-shaft, not both", key=key)
            assert self.bore is not None  # see above
            across, half = self.d_shaft.across, 0.5 * self.bore
            number(f"{key}.across", across, above=half, below=self.bore, unit="mm")

    def _check_engraving(self) -> None:
        key = f"part.{ENGRAVING}"
        given = instance(key, self.engraving, tuple, "a tuple of texts")
        if len(instances(key, given, (Engraving,), "texts")) > MOST_TEXTS:
            raise GeometryError(f"at most {MOST_TEXTS} texts are engraved", key, f"{len(given)}")
        for place, text in enumerate(given, start=1):
            if self.thickness is not None:
                number(f"{key}[{place}].depth", text.depth, below=self.thickness, unit="mm")

    def alone(self, disc: str) -> PartSpec:
        """The main or the return disc (of `camgeo.part.pair_spec.DISCS`) of a pair in one piece,
        without the hub; of other parts all of it. Only the upper disc has texts, which a gap would
        hide, and counterbores, as bolts go in from above.
        """
        if self.pair is None:
            return self
        own = replace(self, pair=None, hub=None, set_screw=None)
        if self.chamfers is not None:
            side = UPPER if disc == self.pair.upper else LOWER
            hub = self.hub is not None and self.hub.side in (side, BOTH)
            own = replace(own, chamfers=self.chamfers.on_one_side(side, hub=hub))
        if disc == self.pair.upper:
            return own
        bolts = self.bolt_circle
        bolts = None if bolts is None else replace(bolts, counterbore=None)
        return replace(own, bolt_circle=bolts, engraving=())


def part_of(table: Mapping[str, Any], name: str) -> PartSpec:
    """The specification of a converted table `[part]`, in mm, rad and t; raises GeometryError.

    `name` is engraved where a text is not given.
    """
    given = dict(table)
    given[ENGRAVING] = engravings_of(given.get(ENGRAVING, ()), name)
    given["density"] = density_of(table)
    given.pop("material", None)
    features: Mapping[str, Callable[..., Any]] = {
        "keyway": Keyway,
        "d_shaft": DShaft,
        "hub": Hub,
        "mark": Mark,
        "set_screw": SetScrew,
        "bolt_circle": Holes,
        "lightening_holes": Holes,
        "pair": Pair,
    }
    for name, made in features.items():
        if name not in given:
            continue
        own = {**given[name]}
        if "counterbore" in own:
            own["counterbore"] = Counterbore(**own["counterbore"])
        if "count" in own:
            own["count"] = int(own["count"])
        if own.pop("standard", None):
            given[name] = Keyway.by_standard(given["bore"], **own)
        else:
            given[name] = made(**own)
    if "chamfers" in given:
        stated = {name: Chamfer(**each) for name, each in given["chamfers"].items()}
        given["chamfers"] = Chamfers(**stated)
    return PartSpec(**given)
