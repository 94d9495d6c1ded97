"""Rules between the keys of the part."""

from __future__ import annotations

from collections.abc import Iterator

from camgeo.errors import GeometryError
from camgeo.part.engraving import ENGRAVING, STRAIGHT
from camgeo.part.keyways import din_6885_1
from camgeo.scene.valid_values import Broken, ValidValues


def contact_and_part_agree(values: ValidValues) -> Iterator[Broken]:
    """The part has the boundaries that its contact needs, and no others."""
    contact = values.contact
    if contact is None or values.lacks("follower"):
        return
    if not contact.is_plate and values.lacks("part", "rim"):
        yield ("follower", "contact"), "needs [part] rim, the diameter of the blank"
    if contact.is_plate and values.has("part", "rim"):
        message = 'belongs to contact "outer" or "groove"; the outline of this cam is its flank'
        yield ("part", "rim"), message
    if not contact.closed_by_form and values.has("part", "groove_depth"):
        yield ("part", "groove_depth"), 'belongs to contact "groove"'
    for key in ("bore", "hub"):
        if not contact.runs_inside and values.has("part", key):
            message = (
                'has no place in a cam with contact "outer": the roller runs where it would be'
            )
            yield ("part", key), message


def part_is_possible(values: ValidValues) -> Iterator[Broken]:
    """Groove, mark and texts within the thickness, keyway within the bore, bore within the hub."""
    thickness = values.get("part", "thickness")
    texts = values.get("part", ENGRAVING) or ()
    yield from _texts_have_a_place(values, len(texts))
    depths = [("part", ENGRAVING, number, "depth") for number in range(len(texts))]
    for place in (("part", "groove_depth"), ("part", "mark", "depth"), *depths):
        depth = values.get(*place)
        if depth is not None and thickness is not None and not depth < thickness:
            yield place, f"must be less than the thickness, {thickness:g}"
    for key in ("keyway", "d_shaft"):
        if values.has("part", key) and values.lacks("part", "bore"):
            yield ("part", key), "needs [part] bore"
    if values.has("part", "d_shaft") and values.has("part", "keyway"):
        yield ("part", "d_shaft"), "contradicts keyway; a bore has one of them"
    bore = values.get("part", "bore")
    yield from _keyway_is_stated_once(values, bore)
    width = values.get("part", "keyway", "width")
    if bore is not None and width is not None and not width < bore:
        yield ("part", "keyway", "width"), f"must be less than the bore, {bore:g}"
    across = values.get("part", "d_shaft", "across")
    if bore is not None and across is not None and not 0.5 * bore < across < bore:
        yield ("part", "d_shaft", "across"), f"must be more than {0.5 * bore:g}, less than {bore:g}"
    hub = values.get("part", "hub", "diameter")
    if bore is not None and hub is not None and not hub > bore:
        yield ("part", "hub", "diameter"), f"must be more than the bore, {bore:g}"
    yield from _set_screw_fits(values)
    yield from _pair_is_possible(values, bore)
    place = ("part", "bolt_circle", "counterbore")
    wide, hole = values.get(*place, "diameter"), values.get("part", "bolt_circle", "hole")
    if wide is not None and hole is not None and not wide > hole:
        yield (*place, "diameter"), f"must be more than the hole, {hole:g}"
    length, width = (values.get("part", "mark", key) for key in ("length", "width"))
    if length is not None and width is not None and not length > width:
        yield ("part", "mark", "length"), f"must be more than the width, {width:g}"


def _texts_have_a_place(values: ValidValues, count: int) -> Iterator[Broken]:
    """A text along a circle beyond the cam axis; a straight one with one direction at most."""
    for number in range(count):
        place = ("part", ENGRAVING, number)
        along = values.get(*place, "along")
        radius, height = (values.get(*place, key) for key in ("radius", "height"))
        if along != STRAIGHT:
            if values.has(*place, "turn"):
                yield (*place, "turn"), f'belongs to along = "{STRAIGHT}"'
            if radius is not None and height is not None and not radius > 0.5 * height:
                message = f"must be more than half the height of the letters, {0.5 * height:g}"
                yield (*place, "radius"), message
        elif values.has(*place, "turn") and values.has(*place, "tops"):
            yield (*place, "turn"), "contradicts tops, which says the same"


def chamfers_have_edges(values: ValidValues) -> Iterator[Broken]:
    """Chamfers are along what there is, and of a part whose heights are stated."""
    place = ("part", "chamfers")
    if not values.has(*place):
        return
    if values.lacks("part", "thickness"):
        yield place, "needs [part] thickness"
    for key in ("rim", "bore", "hub", "bolt_circle", "lightening_holes"):
        if values.has(*place, key) and values.lacks("part", key):
            yield (*place, key), f"needs [part] {key}"
    contact = values.contact
    grooved = contact is not None and contact.closed_by_form
    if grooved and values.has(*place, "outline") and values.lacks("part", "groove_depth"):
        yield (*place, "outline"), "needs [part] groove_depth"


def _keyway_is_stated_once(values: ValidValues, bore: float | None) -> Iterator[Broken]:
    """By width and depth, or by a standard that has the bore."""
    place = ("part", "keyway")
    if not values.has(*place):
        return
    by_standard = values.has(*place, "standard")
    for key in ("width", "depth"):
        if by_standard and values.has(*place, key):
            yield (*place, key), "contradicts standard, by which the bore decides it"
        elif not by_standard and values.lacks(*place, key):
            yield place, f"needs {key}, or standard"
    if by_standard and bore is not None and values.valid("units"):
        try:
            din_6885_1(bore * values.mm)
        except GeometryError as error:
            yield (*place, "standard"), f"{error.message}; width and depth state another"


def _pair_is_possible(values: ValidValues, bore: float | None) -> Iterator[Broken]:
    """Two discs of known thickness, and a spacer around the bore."""
    place = ("part", "pair")
    if not values.has(*place):
        return
    if values.lacks("follower", "return"):
        yield place, "belongs to a conjugate pair: it needs [follower.return]"
    if values.lacks("part", "thickness"):
        yield place, "needs [part] thickness"
    spacer = values.get(*place, "spacer")
    if bore is not None and spacer is not None and not spacer > bore:
        yield (*place, "spacer"), f"must be more than the bore, {bore:g}"


def _set_screw_fits(values: ValidValues) -> Iterator[Broken]:
    """Within the height of the hub, and narrower than the bore."""
    place = ("part", "set_screw")
    if not values.has(*place):
        return
    for key in ("bore", "hub"):
        if values.lacks("part", key):
            yield place, f"needs [part] {key}"
    size, at = (values.get(*place, key) for key in ("diameter", "height"))
    high, bore = values.get("part", "hub", "height"), values.get("part", "bore")
    most = min((each for each in (high, bore) if each is not None), default=None)
    if size is None or most is None:
        return
    if not size < most:
        what = "bore" if most == bore else "height of the hub"
        yield (*place, "diameter"), f"must be less than the {what}, {most:g}"
    elif high is not None and at is not None and not 0.5 * size < at < high - 0.5 * size:
        message = f"must be more than {0.5 * size:g}, less than {high - 0.5 * size:g}"
        yield (*place, "height"), f"{message}: the hole lies within the hub"
