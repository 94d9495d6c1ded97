"""The specification of the part in a scene."""

from __future__ import annotations

import cmath
import unicodedata
from bisect import bisect_left
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any, Final, NamedTuple, Self

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.values import Angle, Length
from camgeo.numeric.checked import (
    CheckedFields,
    check_fields,
    instance,
    instance_from_table,
    instances,
    number,
    one_of,
    value_text,
    whole,
)
from camgeo.part.glyphs import require_glyphs
from camgeo.part.materials import KG_M3, table_density
from camgeo.units import TURN

# -- pair spec ------------------------------------------------------------------------------------
# The specification of a conjugate pair in one piece: two discs on one hub, with a spacer.


MAIN: Final = "main"
RETURN: Final = "return"

DISCS: Final = (MAIN, RETURN)
"""Discs of a pair."""


@dataclass(frozen=True, slots=True)
class Pair(CheckedFields, path="part.pair."):
    """How the discs of a conjugate pair stand on one hub.

    Attributes
    ----------
    gap : distance between the faces of the discs that look at each other [mm].
    spacer : diameter of the round body between the discs [mm].
    upper : the disc that is above, one of `DISCS`.
    roller_width : width of the wider roller, each in the middle of its disc [mm]; None if unknown.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    gap: Length
    spacer: Length
    upper: Annotated[str, partial(one_of, choices=DISCS)] = MAIN
    roller_width: Length | None = None


# -- engraving ------------------------------------------------------------------------------------
# What a scene states of engraved text.


ENGRAVING: Final = "engraving"
"""Key of the list of texts in [part], and how the names of their boundaries begin."""

LETTER: Final = " letter "
"""Separator in the name of a letter's boundary between the name of the text and the number of the
character."""

CIRCLE: Final = "circle"
STRAIGHT: Final = "straight"
COURSES: Final = (CIRCLE, STRAIGHT)
"""The lines along which a text can run."""

OUTWARD: Final = "outward"
INWARD: Final = "inward"
SENSES: Final = (OUTWARD, INWARD)
"""The directions in which the tops of letters can point, seen from the cam axis."""

MOST_LETTERS: Final = 100
"""Most characters of a text."""

MOST_TEXTS: Final = 20
"""Most texts of a part."""

SHAPED: Final = ("R", "AL", "AN")
"""Directions of characters that are written from right to left, in shapes that depend on their
neighbours."""


def text_to_engrave(key: str, value: Any) -> str:
    """A line of text in composed characters, each of which has one shape.

    Raises
    ------
    GeometryError
        If it is empty or too long, or a character does not stand for itself.
    """
    text = unicodedata.normalize("NFC", instance(key, value, str, "a text"))
    if not text.strip() or len(text) > MOST_LETTERS:
        raise GeometryError(
            f"must be a text of 1 to {MOST_LETTERS} characters, not of spaces alone",
            key,
            value_text(value),
        )
    for character in text:
        known = f"U+{ord(character):04X}"
        # Combining marks (M), and controls, formats and code points without a meaning (C).
        if unicodedata.category(character)[0] in "MC":
            raise GeometryError(
                f"{known} in it is not a character of its own, so it cannot be engraved",
                key,
                value_text(value),
            )
        if unicodedata.bidirectional(character) in SHAPED:
            raise GeometryError(
                f'"{character}" ({known}) is written from right to left, which is not engraved',
                key,
                value_text(value),
            )
    return text


@dataclass(frozen=True, slots=True)
class Engraving:
    """A line of text sunk in the upper face of the disc.

    Attributes
    ----------
    text : the text, in composed characters (NFC).
    height : height of capital letters [mm].
    depth : depth below the upper face [mm].
    radius : distance of the text's middle, at half the height of capital letters, from the cam axis
        [mm].
    angle : direction of the text's middle from the x axis at cam angle 0 [rad], counter-clockwise,
        -2 pi to 2 pi.
    along : one of `COURSES`: letters stand on a circle about the cam axis, or on a straight line.
    tops : one of `SENSES`: where the tops of the letters point, at the middle of the text.
    turn : direction in which a straight text is read, from the x axis at cam angle 0 [rad], in
        place of `tops`; None for a text across the ray through its middle.

    Raises
    ------
    GeometryError
        With the key in `part.engraving`, if a value is invalid, the letters of a text along a
        circle reach the cam axis, or a text along a circle has a turn.
    """

    text: Annotated[str, text_to_engrave]
    height: Length
    depth: Length
    radius: Length
    angle: Angle = 0.0
    along: Annotated[str, partial(one_of, choices=COURSES)] = CIRCLE
    tops: Annotated[str, partial(one_of, choices=SENSES)] = OUTWARD
    turn: Angle | None = None

    def __post_init__(self) -> None:
        check_fields(self, f"part.{ENGRAVING}.")
        if self.along == STRAIGHT:
            return
        if self.turn is not None:
            raise GeometryError(
                'belongs to a "straight" text; along a circle tops point outward or inward',
                f"part.{ENGRAVING}.turn",
            )
        number(f"part.{ENGRAVING}.radius", self.radius, above=0.5 * self.height, unit="mm")


def text_name(boundary: str) -> str:
    """Name of the text to which the boundary called `boundary` belongs; empty if to none."""
    text, letter, _ = boundary.partition(LETTER)
    return text if letter and text.startswith(ENGRAVING) else ""


def read_engravings(tables: Iterable[Mapping[str, Any]], name: str) -> tuple[Engraving, ...]:
    """The engravings of converted tables, in mm and rad; a table without a text engraves `name`.

    Raises
    ------
    GeometryError
        With the key of the text, counted from 1, if one is invalid or its font has no such
        character.
    """
    texts = []
    for number_of_text, table in enumerate(tables, start=1):
        try:
            engraving = Engraving(**{"text": name, **table})
            require_glyphs(engraving.text)
        except GeometryError as error:
            begin = f"part.{ENGRAVING}"
            key = error.key.replace(begin, f"{begin}[{number_of_text}]", 1)
            raise GeometryError(error.message, key, error.value) from None
        texts.append(engraving)
    return tuple(texts)


# -- faces ----------------------------------------------------------------------------------------
# The faces of a disc, as scenes name them.


UPPER: Final = "upper"
LOWER: Final = "lower"
BOTH: Final = "both"

SIDES: Final = (UPPER, LOWER, BOTH)
"""Faces of the disc on which a hub stands, or whose edges have a chamfer."""


# -- spec -----------------------------------------------------------------------------------------


MOST_HOLES: Final = 100
"""Most holes on one circle."""


@dataclass(frozen=True, slots=True)
class Keyway(CheckedFields, path="part.keyway."):
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

    @classmethod
    def by_standard(cls, bore: float, angle: float = 0.0) -> Self:
        """The keyway by DIN 6885-1, deep form, for a bore of the diameter `bore` [mm].

        Raises GeometryError with key "part.keyway.standard" if the table has no such bore.
        """
        row = din_6885_1(bore)
        return cls(row.width, row.depth, angle)


@dataclass(frozen=True, slots=True)
class DShaft(CheckedFields, path="part.d_shaft."):
    """The flat side of the bore for a D-shaft, parallel to the cam axis.

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


@dataclass(frozen=True, slots=True)
class Hub(CheckedFields, path="part.hub."):
    """A round hub about the cam axis, on one face of the disc or on both.

    Attributes
    ----------
    diameter : diameter of the hub [mm].
    height : height above the face on which it stands [mm]; the same on both faces.
    side : one of `SIDES`.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    diameter: Length
    height: Length
    side: Annotated[str, partial(one_of, choices=SIDES)] = UPPER


@dataclass(frozen=True, slots=True)
class SetScrew(CheckedFields, path="part.set_screw."):
    """Radial hole through the hub into the bore; prismatic layers do not have it.

    Attributes
    ----------
    diameter : diameter of the hole [mm].
    height : height of its middle above the face on which the hub stands [mm].
    angle : direction from the x axis at cam angle 0 [rad], counter-clockwise, -2 pi to 2 pi.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    diameter: Length
    height: Length
    angle: Angle = 0.0


@dataclass(frozen=True, slots=True)
class Mark:
    """A timing mark sunk in the upper face of the disc: a radial slot with round ends, or a dot.

    Attributes
    ----------
    radius : distance of its middle from the cam axis [mm].
    width : width of the slot, or diameter of the dot [mm].
    depth : depth below the upper face [mm].
    length : length of the slot from end to end, along the ray [mm]; None for a dot.
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
class Counterbore(CheckedFields, path="part.bolt_circle.counterbore."):
    """The wider upper end of a bolt hole, for the head of a screw.

    Attributes
    ----------
    diameter : diameter of the counterbore [mm].
    depth : depth below the face on which the hole opens, of the disc or of a hub [mm].

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    diameter: Length
    depth: Length


@dataclass(frozen=True, slots=True)
class Holes:
    """Equal round holes through the part, evenly spaced on a circle about the cam axis.

    Attributes
    ----------
    count : number of holes, from 1 to `MOST_HOLES`.
    circle : diameter of the circle through their middles [mm].
    hole : diameter of each hole [mm].
    angle : direction of the first hole from the x axis at cam angle 0 [rad], counter-clockwise,
        -2 pi to 2 pi.
    counterbore : counterbore at the upper end of each hole; None for none.

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
            number(
                "part.bolt_circle.counterbore.diameter",
                self.counterbore.diameter,
                above=self.hole,
                unit="mm",
            )

    @property
    def middles(self) -> tuple[complex, ...]:
        """Middles of the holes [mm]."""
        step = TURN / self.count
        return tuple(
            cmath.rect(0.5 * self.circle, self.angle + number * step)
            for number in range(self.count)
        )


LEAST_DENSITY: Final = 1e-6 / KG_M3
MOST_DENSITY: Final = 1e6 / KG_M3
"""Range of densities in scenes [t/mm^3]: that of all materials, with room for one that stands for a
slice or a shell."""


Density = Annotated[float, partial(number, least=LEAST_DENSITY, most=MOST_DENSITY, unit="t/mm^3")]


@dataclass(frozen=True, slots=True)
class PartSpec:
    """The specification of the part; every length in mm, None if the scene does not give it.

    Attributes
    ----------
    thickness : thickness of the disc.
    bore : diameter of the bore.
    keyway : keyway of the bore.
    rim : diameter of the blank, the outer boundary of a groove cam, or of a cam whose roller runs
        inside ("outer" contact).
    groove_depth : depth of a groove cam's groove, less than the thickness; it is open to the upper
        face.
    hub : hub about the bore.
    mark : timing mark, less deep than the disc is thick.
    d_shaft : flat side of the bore, in place of a keyway.
    bolt_circle, lightening_holes : holes through the disc, and through the hubs that they lie in.
    set_screw : hole of a set screw in the hub, between the faces of hub and disc.
    pair : how both discs of a conjugate pair stand on one hub, in one piece; hub and set screw are
        then the pair's.
    density : density of the whole part [t/mm^3]; the shape does not depend on it.
    engraving : texts in the upper face of the disc, less deep than the disc is thick.
    chamfers : chamfers of the edges; None for none.

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
                message = "a bore has either a keyway or a flat for a D-shaft, not both"
                raise GeometryError(message, key=key)
            assert self.bore is not None  # see above
            across, half = self.d_shaft.across, 0.5 * self.bore
            number(f"{key}.across", across, above=half, below=self.bore, unit="mm")

    def _check_engraving(self) -> None:
        key = f"part.{ENGRAVING}"
        texts = instance(key, self.engraving, tuple, "a tuple of texts")
        if len(instances(key, texts, (Engraving,), "texts")) > MOST_TEXTS:
            raise GeometryError(f"at most {MOST_TEXTS} texts are engraved", key, f"{len(texts)}")
        for place, text in enumerate(texts, start=1):
            if self.thickness is not None:
                number(f"{key}[{place}].depth", text.depth, below=self.thickness, unit="mm")

    def alone(self, disc: str) -> PartSpec:
        """The specification of one disc, named as in `DISCS`, of a pair in one piece, without the
        hub; for any other part the whole specification.

        Only the upper disc has texts, which a gap would hide, and counterbores, as bolts go in from
        above.
        """
        if self.pair is None:
            return self
        disc_spec = replace(self, pair=None, hub=None, set_screw=None)
        if self.chamfers is not None:
            side = UPPER if disc == self.pair.upper else LOWER
            hub = self.hub is not None and self.hub.side in (side, BOTH)
            disc_spec = replace(disc_spec, chamfers=self.chamfers.on_one_side(side, hub=hub))
        if disc == self.pair.upper:
            return disc_spec
        bolts = self.bolt_circle
        bolts = None if bolts is None else replace(bolts, counterbore=None)
        return replace(disc_spec, bolt_circle=bolts, engraving=())

    @classmethod
    def from_table(cls, table: Mapping[str, Any], name: str) -> PartSpec:
        """The specification of a converted table `[part]`, in mm, rad and t; raises GeometryError.

        `name` is engraved where a text is not given.
        """
        values = {key: table[key] for key in table if key != "material"}
        values[ENGRAVING] = read_engravings(values.get(ENGRAVING, ()), name)
        values["density"] = table_density(table)
        keyway = dict(values.get("keyway", {}))
        if keyway.pop("standard", None):
            values["keyway"] = Keyway.by_standard(values["bore"], **keyway)
        return instance_from_table(PartSpec, values)


# -- chamfers -------------------------------------------------------------------------------------
# What a scene states of chamfers; `camgeo.part.assembly` makes them.


KEY: Final = "part.chamfers"
"""Key of the table of chamfers in the scene."""


@dataclass(frozen=True, slots=True)
class Chamfer(CheckedFields, path=f"{KEY}."):
    """A chamfer of 45 degrees.

    Attributes
    ----------
    width : width on the face and height along the wall [mm].
    edges : the ends of the wall that have it, one of `SIDES`.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    width: Length
    edges: Annotated[str, partial(one_of, choices=SIDES)] = BOTH


@dataclass(frozen=True, slots=True)
class Chamfers:
    """The chamfers of a part, by what they run along; None for sharp edges.

    Attributes
    ----------
    outline : along the flanks; of a groove only along their upper edges.
    rim, bore : at both ends.
    hub : along the outer edge of each hub.
    bolt_circle, lightening_holes : along the edges of the holes on the faces.
    """

    outline: Chamfer | None = None
    rim: Chamfer | None = None
    bore: Chamfer | None = None
    hub: Chamfer | None = None
    bolt_circle: Chamfer | None = None
    lightening_holes: Chamfer | None = None

    def on_one_side(self, side: str, *, hub: bool) -> Chamfers:
        """The chamfers of one disc of a pair in one piece, without those of its hub.

        The bore has no edge where the other disc follows, nor on the outer `side` if there is a
        `hub`.
        """
        bore = self.bore
        if bore is not None:
            bore = None if hub or bore.edges not in (side, BOTH) else replace(bore, edges=side)
        return replace(self, hub=None, bore=bore)


# -- keyways --------------------------------------------------------------------------------------
# Keyways of hubs by DIN 6885-1, parallel keys of the deep form: from the diameter of the bore.
#
# Rows on which sources do not agree are left out: that of shafts above 440 mm, where the depth in
# the hub is 19.4 or 19.5 mm. `tests/part/test_part.py` names the sources.


class KeywayRow(NamedTuple):
    """A row of the table of DIN 6885-1.

    Attributes
    ----------
    largest : largest diameter of shaft and bore for which it holds [mm].
    width : b of key and keyway [mm].
    depth : t2 of the keyway in the hub [mm].
    """

    largest: float
    width: float
    depth: float


SMALLEST: Final = 6.0
"""Diameter above which the table begins [mm]."""

ROWS: Final = (
    KeywayRow(8.0, 2.0, 1.0),
    KeywayRow(10.0, 3.0, 1.4),
    KeywayRow(12.0, 4.0, 1.8),
    KeywayRow(17.0, 5.0, 2.3),
    KeywayRow(22.0, 6.0, 2.8),
    KeywayRow(30.0, 8.0, 3.3),
    KeywayRow(38.0, 10.0, 3.3),
    KeywayRow(44.0, 12.0, 3.3),
    KeywayRow(50.0, 14.0, 3.8),
    KeywayRow(58.0, 16.0, 4.3),
    KeywayRow(65.0, 18.0, 4.4),
    KeywayRow(75.0, 20.0, 4.9),
    KeywayRow(85.0, 22.0, 5.4),
    KeywayRow(95.0, 25.0, 5.4),
    KeywayRow(110.0, 28.0, 6.4),
    KeywayRow(130.0, 32.0, 7.4),
    KeywayRow(150.0, 36.0, 8.4),
    KeywayRow(170.0, 40.0, 9.4),
    KeywayRow(200.0, 45.0, 10.4),
    KeywayRow(230.0, 50.0, 11.4),
    KeywayRow(260.0, 56.0, 12.4),
    KeywayRow(290.0, 63.0, 12.4),
    KeywayRow(330.0, 70.0, 14.4),
    KeywayRow(380.0, 80.0, 15.4),
    KeywayRow(440.0, 90.0, 17.4),
)

RANGE: Final = f"is for bores above {SMALLEST:g} mm, up to {ROWS[-1].largest:g} mm"


def din_6885_1(bore: float) -> KeywayRow:
    """The keyway for a bore of that diameter [mm].

    Raises
    ------
    GeometryError
        With key "part.keyway.standard", outside the table.
    """
    if not SMALLEST < bore <= ROWS[-1].largest:
        raise GeometryError(RANGE, key="part.keyway.standard", value=f"{bore:g} mm")
    return ROWS[bisect_left([row.largest for row in ROWS], bore)]
