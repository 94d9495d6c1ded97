"""Faults of a scene: against its schema, and against rules that a schema cannot state."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from decimal import Context, Decimal, Inexact
from typing import Final, Literal

from camgeo.errors import Fault, GeometryError, SceneError
from camgeo.kinematics.laws import find_family
from camgeo.kinematics.mechanism.declared.registry import FOLLOWERS, LINKAGES
from camgeo.kinematics.plan import FULL_TURN, SHORTEST_SPAN
from camgeo.kinematics.planning.requests import AUTO
from camgeo.part.spec import BOTH, ENGRAVING, LOWER, STRAIGHT, din_6885_1
from camgeo.scene.formats.format import LARGEST_TOLERANCE, SMALLEST_TOLERANCE, OutputSpec
from camgeo.scene.keys import KeyPath
from camgeo.scene.schema import (
    BY_DATA,
    EFFECTS_KEY,
    FINDERS,
    MILLING,
    NAMING,
    SHAPES,
    schema_for,
)
from camgeo.scene.values import (
    FAMILIES,
    SWEEP,
    Broken,
    RecordingValues,
    ValidValues,
    design_path,
    faults_of_list,
    faults_of_range,
    present_tables,
    unchanged,
    variable_keys,
    variable_rows,
)

# -- family rules ---------------------------------------------------------------------------------
# Rules on the families of designs that a scene states in `[sweep]` and `[optimise]`.


def families_vary(values: ValidValues) -> Iterator[Broken]:
    """Each variable has keys that a scene may have, each once, and values for them."""
    for name in FAMILIES:
        table = values.raw(name)
        if not isinstance(table, dict) or not isinstance(table.get("vary"), list):
            continue
        seen: set[str] = set()
        for index in range(len(table["vary"])):
            place = (name, "vary", index)
            if values.valid(*place):
                yield from _variable(values, place, seen)


def _variable(
    values: ValidValues, place: tuple[str | int, ...], seen: set[str]
) -> Iterator[Broken]:
    table = values.get(*place)
    if ("key" in table) == ("keys" in table):
        yield place, 'must have either "key" or "keys"'
        return
    if "key" in table:
        places = {(*place, "key"): table["key"]}
    else:
        places = {(*place, "keys", number): key for number, key in enumerate(table["keys"])}
    yield from _keys(values, places, seen)
    ranged = "from" in table or "to" in table or "count" in table
    if ("values" in table) == ranged:
        yield place, 'must have either "values", or "from" and "to"'
    elif ranged:
        yield from _range(values, place)
    else:
        keys = len(variable_keys(table))
        for number, message in faults_of_list(variable_rows(table["values"], keys), keys):
            yield (*place, "values", number), message


def _keys(
    values: ValidValues, places: dict[tuple[str | int, ...], str], seen: set[str]
) -> Iterator[Broken]:
    for where, key in places.items():
        try:
            design_path(values.raw(), key, seen)
        except SceneError as error:
            (fault,) = error.faults
            yield where, f"{fault.message} ({fault.hint})" if fault.hint else fault.message
        except GeometryError as error:
            yield where, error.message


def _range(values: ValidValues, place: tuple[str | int, ...]) -> Iterator[Broken]:
    table = values.get(*place)
    start, stop = values.exact(*place, "from"), values.exact(*place, "to")
    if start is None or stop is None:
        yield place, 'must have both "from" and "to"'
        return
    count = table.get("count")
    faults = [((*place, key), why) for key, why in faults_of_range(start, stop, count)]
    if place[0] == SWEEP and count is None and not faults and not values.has(SWEEP, "samples"):
        yield place, 'needs "count", unless [sweep] has "samples"'
    yield from faults


# -- part rules -----------------------------------------------------------------------------------
# Rules between the keys of the part.


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
    """Groove, mark and texts are less deep than the disc is thick, and the features of bore, hub,
    bolt circle and mark fit into each other.
    """
    texts = values.get("part", ENGRAVING) or ()
    yield from _texts_have_a_place(values, len(texts))
    depths = [("part", ENGRAVING, number, "depth") for number in range(len(texts))]
    for place in (("part", "groove_depth"), ("part", "mark", "depth"), *depths):
        yield from _compared(values, place, "less", "thickness")
    for key in ("keyway", "d_shaft"):
        if values.has("part", key) and values.lacks("part", "bore"):
            yield ("part", key), "needs [part] bore"
    if values.has("part", "d_shaft") and values.has("part", "keyway"):
        yield ("part", "d_shaft"), "contradicts keyway; a bore may have only one of them"
    bore = values.get("part", "bore")
    yield from _keyway_is_stated_once(values, bore)
    yield from _compared(values, ("part", "keyway", "width"), "less", "bore")
    across = values.get("part", "d_shaft", "across")
    if bore is not None and across is not None and not 0.5 * bore < across < bore:
        yield ("part", "d_shaft", "across"), f"must be more than {0.5 * bore:g}, less than {bore:g}"
    yield from _compared(values, ("part", "hub", "diameter"), "more", "bore")
    yield from _set_screw_fits(values)
    yield from _pair_is_possible(values)
    wide = ("part", "bolt_circle", "counterbore", "diameter")
    yield from _compared(values, wide, "more", "bolt_circle", "hole")
    yield from _compared(values, ("part", "mark", "length"), "more", "mark", "width")


def _compared(
    values: ValidValues, place: KeyPath, relation: Literal["less", "more"], *other: str
) -> Iterator[Broken]:
    """The length at `place` must be less or more than the one at `part` and `other`; nothing is
    reported unless both are known.
    """
    length, limit = values.get(*place), values.get("part", *other)
    if length is None or limit is None:
        return
    if not (length < limit if relation == "less" else length > limit):
        yield place, f"must be {relation} than the {other[-1]}, {limit:g}"


def _texts_have_a_place(values: ValidValues, count: int) -> Iterator[Broken]:
    """A text along a circle must stay off the cam axis; the direction of a straight one may be
    stated by `turn` or by `tops`, not by both.
    """
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
            yield (*place, "turn"), "contradicts tops; state only one of them"


def chamfers_have_edges(values: ValidValues) -> Iterator[Broken]:
    """Chamfers lie along edges that the part has, and need a part whose heights are stated."""
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
    """A keyway is stated either by width and depth, or by a standard that covers the bore."""
    place = ("part", "keyway")
    if not values.has(*place):
        return
    by_standard = values.has(*place, "standard")
    for key in ("width", "depth"):
        if by_standard and values.has(*place, key):
            yield (*place, key), "contradicts standard, by which the bore determines it"
        elif not by_standard and values.lacks(*place, key):
            yield place, f"needs {key}, or standard"
    if by_standard and bore is not None and values.valid("units"):
        try:
            din_6885_1(bore * values.mm)
        except GeometryError as error:
            yield (*place, "standard"), f"{error.message}; width and depth state another"


def _pair_is_possible(values: ValidValues) -> Iterator[Broken]:
    """A pair in one piece has two discs of known thickness, and a spacer larger than the bore."""
    place = ("part", "pair")
    if not values.has(*place):
        return
    if values.lacks("follower", "return"):
        yield place, "belongs to a conjugate pair: it needs [follower.return]"
    if values.lacks("part", "thickness"):
        yield place, "needs [part] thickness"
    yield from _compared(values, (*place, "spacer"), "more", "bore")


def _set_screw_fits(values: ValidValues) -> Iterator[Broken]:
    """A set screw lies within the height of the hub, and is narrower than the bore."""
    place = ("part", "set_screw")
    if not values.has(*place):
        return
    for key in ("bore", "hub"):
        if values.lacks("part", key):
            yield place, f"needs [part] {key}"
    size, screw_height = (values.get(*place, key) for key in ("diameter", "height"))
    high, bore = values.get("part", "hub", "height"), values.get("part", "bore")
    most = min((length for length in (high, bore) if length is not None), default=None)
    if size is None or most is None:
        return
    if not size < most:
        what = "bore" if most == bore else "height of the hub"
        yield (*place, "diameter"), f"must be less than the {what}, {most:g}"
    elif (
        high is not None
        and screw_height is not None
        and not 0.5 * size < screw_height < high - 0.5 * size
    ):
        message = f"must be more than {0.5 * size:g}, less than {high - 0.5 * size:g}"
        yield (*place, "height"), f"{message}: the hole lies within the hub"


# -- print rules ----------------------------------------------------------------------------------
# Rules between what a scene states on printing and its part.


def print_suits_the_part(values: ValidValues) -> Iterator[Broken]:
    """The part has the features for which a print is compensated, and its lowest layer, disc or
    hub, is higher than the elephant's foot.
    """
    if values.has("print", "bore_clearance") and values.lacks("part", "bore"):
        yield ("print", "bore_clearance"), "needs [part] bore"
    key = ("print", "key_clearance")
    if values.has(*key) and values.lacks("part", "keyway") and values.lacks("part", "d_shaft"):
        yield key, "needs [part] keyway, or d_shaft"
    place = ("print", "elephant_foot", "height")
    lowest, what = values.get("part", "thickness"), "thickness"
    if values.get("part", "hub", "side") in (LOWER, BOTH):
        lowest, what = values.get("part", "hub", "height"), "height of the lower hub"
    high = values.get(*place)
    if high is not None and lowest is not None and not high < lowest:
        yield place, f"must be less than the {what}, {lowest:g}"


# -- state rules ----------------------------------------------------------------------------------
# Rules between the keys of [state] and those of the machine and its effects.


def a_computed_speed_has_one_source(values: ValidValues) -> Iterator[Broken]:
    """A computed speed needs an effect that computes it, and no more than one."""
    named = [effect for effect in FINDERS if not values.lacks(EFFECTS_KEY, effect)]
    if values.get("state", "speed") == "found" and not named:
        yield ("state", "speed"), f"needs [effects.{'] or [effects.'.join(FINDERS)}]"
    yield from (
        ((EFFECTS_KEY, effect), f"contradicts [effects.{named[0]}]") for effect in named[1:]
    )


FLANKS: Final = {
    "main": ("is a disc of a conjugate pair or a side of a yoke", ("return", "yoke")),
    "return": ("is a disc of a conjugate pair", ("return",)),
    "opposite": ("is a side of a yoke", ("yoke",)),
}
"""What each flank is, and the tables of the follower at least one of which it needs."""


def a_flank_is_one_of_two(values: ValidValues) -> Iterator[Broken]:
    """A flank may be chosen only where the follower is held both ways: by a conjugate pair, a yoke
    or a groove.
    """
    flank = values.get("state", "flank")
    if flank is None:
        return
    place = ("state", "flank")
    if values.get("state", "motion") != "written":
        yield place, 'belongs to motion = "written"; another motion is the same on both sides'
    elif flank in FLANKS:
        what, keys = FLANKS[flank]
        if all(values.lacks("follower", key) for key in keys):
            yield place, f"{what}: it needs [follower.{'] or [follower.'.join(keys)}]"
    elif values.contact is not None and not values.contact.closed_by_form:
        yield place, 'is a flank of a groove: it needs contact = "groove"'


# -- tolerance rules ------------------------------------------------------------------------------
# Rules on the tolerances that a scene states in `[tolerance]`.


TOLERANCE: Final = "tolerance"
"""The table of the scene that states tolerances."""

RANGES: Final = ("plus_minus", "limits", "class")
"""Keys that state the range of a dimension, of which it has exactly one."""


def tolerances_are_stated_once(values: ValidValues) -> Iterator[Broken]:
    """Each dimension is toleranced once and by one range."""
    table = values.raw(TOLERANCE)
    if not isinstance(table, dict):
        return
    if not any(key in table for key in ("dimension", "clearance", "form")):
        yield (TOLERANCE,), 'states no tolerance: it needs "dimension", "clearance" or "form"'
    seen: set[str] = set()
    for index in range(len(_tables(table, "dimension"))):
        place = (TOLERANCE, "dimension", index)
        if values.valid(*place):
            yield from _dimension(values, place, seen)
    for index, fit in enumerate(_tables(table, "clearance")):
        place = (TOLERANCE, "clearance", index)
        if values.valid(*place) and fit["at"] != "cam":
            yield from _pinned(values, place)


def _tables(table: dict[str, list[dict[str, str]]], key: str) -> list[dict[str, str]]:
    tables = table.get(key)
    return tables if isinstance(tables, list) else []


def _dimension(
    values: ValidValues, place: tuple[str | int, ...], seen: set[str]
) -> Iterator[Broken]:
    table = values.get(*place)
    if sum(key in table for key in RANGES) != 1:
        yield place, 'must have one of "plus_minus", "limits" and "class"'
    limits = table.get("limits")
    if limits is not None and not limits[0] < limits[1]:
        yield (*place, "limits"), "must be [from, to], with from below to"
    if "sigma" in table and table.get("distribution", "normal") != "normal":
        yield (*place, "sigma"), 'belongs to distribution "normal": the others end at their limits'
    if table["key"] in seen:
        yield (*place, "key"), "has a tolerance already"
    seen.add(table["key"])


def _pinned(values: ValidValues, place: tuple[str | int, ...]) -> Iterator[Broken]:
    """A clearance at a pin states the pin's diameter, and not the side to which it is taken up: the
    load decides that.
    """
    if not values.has(*place, "size"):
        yield place, 'needs "size", the nominal diameter of the pin'
    if values.has(*place, "shifted"):
        message = 'belongs to at = "cam": a roller is always pushed off the cam by the load'
        yield (*place, "shifted"), message


# -- rules ----------------------------------------------------------------------------------------


SPAN_DIGITS: Final = 60
"""Digits of the exact sum of spans; a span that needs more is no realistic angle."""

WIDEST_SWING: Final = 180.0
"""Largest rocker angle [degrees]; a rocker never swings through the cam axis."""

WIDEST_TURN: Final = 3600.0
"""Largest angle of the far end of a linkage [degrees]: a crank may turn over and over."""

SMALLEST_POSITION: Final = 1e-30
"""Smallest position that is not 0; with less, velocities of up to 1e12 as parts of the stroke are
beyond what a double can hold when they are multiplied."""

SMALLEST_LENGTH: Final = 1e-9
"""Smallest length that is not 0, as of the schema's `length`, in the scene's unit."""

FINEST_PART: Final = 1e-10
"""Smallest ratio of tolerance to the mechanism's largest length: 200,000 chords a turn."""

COARSEST_PART: Final = 0.1
"""Largest ratio of tolerance to the base radius: above, the contour no longer resembles the cam."""

DEFAULT_TOLERANCE: Final = OutputSpec().tolerance


YOKE: Final = ("follower", "yoke")

FOR_ROLLERS: Final = "is for roller followers"

DRIVES: Final = {"mm": "turns a rocker", "rad": "moves a guided follower"}
"""What a linkage does that cannot drive a follower whose lift has that unit."""

JERK: Final = "jerk"
"""Key of the third derivative at the end of a move."""

Rule = Callable[[ValidValues], Iterator[Broken]]


def broken_rules(values: ValidValues, earlier: ValidValues | None = None) -> list[Fault]:
    """Return the faults of all rules.

    Those that an `earlier` scene without faults obeyed, and that read nothing that has changed
    since, are obeyed still.
    """
    if earlier is None or not values.flawless:
        return [values.scene.fault(*broken) for rule in RULES for broken in rule(values)]
    values.reads |= unchanged(earlier, values)
    faults: list[Fault] = []
    for rule in RULES:
        if rule not in values.reads:
            recording = RecordingValues(values.scene)
            faults += [values.scene.fault(*broken) for broken in rule(recording)]
            values.reads[rule] = recording.recorded
    return faults


def spans_make_one_turn(values: ValidValues) -> Iterator[Broken]:
    """The spans add up to one turn, exactly as they are written."""
    spans: list[Decimal] = []
    for index in range(values.segments):
        dwells = values.has("motion", index, "dwell")
        if dwells and values.has("motion", index, "span"):
            return
        key = "dwell" if dwells else "span"
        span = values.exact("motion", index, key)
        if span is None:
            return
        if 0 < span < SHORTEST_SPAN:
            yield ("motion", index, key), "must be 0, or from 1e-6 to 360 (degrees)"
        spans.append(span)
    if not spans:
        return
    # Decimal sums are exact as long as they are not rounded; a rounded one is trapped.
    adding = Context(prec=SPAN_DIGITS, traps=[Inexact])
    total = Decimal(0)
    try:
        for span in spans:
            total = adding.add(total, span)
    except Inexact:
        yield ("motion",), f"the spans have more digits than can be added exactly ({SPAN_DIGITS})"
        return
    if total != FULL_TURN:
        message = f"the spans add up to {total.normalize():f} degrees; they must add up to 360"
        yield ("motion",), message


def motion_returns(values: ValidValues) -> Iterator[Broken]:
    """The motion starts at 0 and ends there."""
    # The last segment with a position decides: dwells after it keep that position.
    for index in reversed(range(values.segments)):
        place = ("motion", index, "to")
        if values.get("motion", index, "law") == "table":
            return  # its file says where it ends
        if values.has(*place):
            if values.get(*place):
                yield place, "the motion starts at 0 and must return to 0 with its last move"
            return
        if not values.valid("motion", index):
            return


def positions_are_distinct_from_0(values: ValidValues) -> Iterator[Broken]:
    """A position is 0, or large enough for the velocities of its laws to be computed."""
    for place, end in _ends(values):
        if 0.0 < abs(end) < SMALLEST_POSITION:
            yield place, "must be 0, or at least 1e-30 in magnitude"


def laws_have_their_parameters(values: ValidValues) -> Iterator[Broken]:
    """A move states only parameters that its law has."""
    for index in range(values.segments):
        place = ("motion", index)
        name = values.get(*place, "law")
        if name is None or not values.valid(*place) or name in BY_DATA:
            continue
        if name != AUTO and values.has(*place, "optimise"):
            yield (*place, "optimise"), f'belongs to law "{AUTO}"'
        parameters = law_parameters(name)
        for key in (*SHAPES, JERK):
            if not values.has(*place, key) or key in parameters:
                continue
            allowed = [shape for shape in SHAPES if shape in parameters]
            known = f"its parameters: {', '.join(allowed)}" if allowed else "it has no parameters"
            yield (*place, key), f'is not a parameter of "{name}"; {known}'


def law_parameters(law: str) -> frozenset[str]:
    """Keys of a move that the law takes: parameters that shape it, and its jerk at the end."""
    if law == AUTO:
        return frozenset(SHAPES)
    parameters = frozenset[str]().union(*find_family(law).parameters.values())
    return parameters & set(SHAPES) | ({JERK} if {"j0", "j1"} & parameters else set())


def one_speed(values: ValidValues) -> Iterator[Broken]:
    """The speed of the disc is stated by a number or by a table, not by both."""
    if values.has("cam", "speed") and values.has("cam", "speed_curve"):
        yield ("cam", "speed_curve"), "contradicts speed; state only one of them"


def swing_is_possible(values: ValidValues) -> Iterator[Broken]:
    """A rocker's own motion is given in degrees and stays on its side of the cam axis."""
    if not values.angular:
        return
    free = not values.lacks("linkage") or values.lacks("follower")  # of a side of the cam axis
    for place, end in _ends(values):
        if free and not abs(end) <= WIDEST_TURN:
            yield place, "must lie between -3600 and 3600: the motion is given in degrees"
        elif not free and not abs(end) < WIDEST_SWING:
            message = (
                "must lie between -180 and 180: without a linkage the motion of an oscillating "
                "follower is given in degrees"
            )
            yield place, message


def positions_have_one_unit(values: ValidValues) -> Iterator[Broken]:
    """The unit of positions is stated only where neither follower nor linkage decides it."""
    for name in ("linkage", "follower"):
        if values.has("units", "motion") and values.has(name):
            message = f"belongs to a scene without [{name}], which decides it here; leave it out"
            yield ("units", "motion"), message
            return


def a_return_disc_has_a_main_disc(values: ValidValues) -> Iterator[Broken]:
    """A conjugate pair is two plate cams; only a pair or a yoke has a closing error."""
    place = ("follower", "return")
    if not values.has(*place):
        free = values.lacks(*place) and values.lacks(*YOKE)
        if values.has("limits", "closing_error") and free:
            message = "belongs to a pair or a yoke: it needs [follower.return] or [follower.yoke]"
            yield ("limits", "closing_error"), message
        return
    if values.contact is not None and not values.contact.is_plate:
        yield place, 'belongs to contact "inner": both discs of a conjugate pair are plate cams'


def a_yoke_holds_one_plate_cam(values: ValidValues) -> Iterator[Broken]:
    """Both sides of a yoke lie in line with the cam axis, on one plate cam."""
    if not values.has(*YOKE):
        return
    if values.get("follower", "offset"):
        message = "must be 0 for a yoke: both its rollers lie in line with the cam axis"
        yield ("follower", "offset"), message
    if values.contact is not None and not values.contact.is_plate:
        yield YOKE, 'belongs to contact "inner": a yoke encloses a plate cam'
    if values.has("follower", "return"):
        yield YOKE, "contradicts [follower.return]: one disc drives a yoke in both directions"


def followers_keep_their_own_rules(values: ValidValues) -> Iterator[Broken]:
    """The keys of the follower obey the rules that its kind declares."""
    kind = values.follower_kind
    if kind is None:
        return
    known = {key: values.get("follower", key) for key in kind.schema["properties"]}
    table = {key: value for key, value in known.items() if value is not None}
    for rule in kind.rules:
        for key, message in rule(table):
            yield ("follower", key), message


def rollers_have_what_is_theirs(values: ValidValues) -> Iterator[Broken]:
    """A limit of the ratio of radii needs a roller."""
    if values.flat and values.has("limits", "radius_ratio"):
        yield ("limits", "radius_ratio"), FOR_ROLLERS


def linkage_drives_the_follower(values: ValidValues) -> Iterator[Broken]:
    """A linkage may drive rockers only, or guided followers only."""
    if values.has("limits", "linkage_transmission_angle") and values.lacks("linkage"):
        yield ("limits", "linkage_transmission_angle"), "belongs to a linkage: it needs [linkage]"
    linkage, follower = values.get("linkage", "kind"), values.follower_kind
    if linkage is None or follower is None or follower.unit in LINKAGES[linkage].members:
        return
    units = LINKAGES[linkage].members
    fitting = " or ".join(f'"{kind.name}"' for kind in FOLLOWERS.values() if kind.unit in units)
    yield ("follower", "kind"), f"a {linkage} {DRIVES[follower.unit]}: it needs kind = {fitting}"


def effects_suit_the_machine(values: ValidValues) -> Iterator[Broken]:
    """Keys that effects declare for one kind of machine are given for that kind only."""
    if isinstance(values.raw(EFFECTS_KEY), dict):
        from camgeo.scene.effects import misfits  # few scenes name an effect

        yield from misfits(values)


def options_obey_their_rules(values: ValidValues) -> Iterator[Broken]:
    """The options of the formats named obey the declared rules."""
    for form in schema_for(present_tables(values, *NAMING)).formats:
        for key, message in form.broken(values):
            yield ("output", form.name, key), message


def milling_is_stated(values: ValidValues) -> Iterator[Broken]:
    """The tables on milling do not contradict themselves; only a program needs them complete."""
    if any(values.has(name) for name in MILLING):
        from camgeo.scene.milling import broken_tables  # few scenes mill

        yield from broken_tables(values)


def roller_is_possible(values: ValidValues) -> Iterator[Broken]:
    """Roller radius and side clearance are 0 or at least `SMALLEST_LENGTH`. A groove needs a
    roller, and only a groove has a side clearance, which is less than the roller's diameter.
    """
    groove = values.contact is not None and values.contact.closed_by_form
    radius = values.get("follower", "roller_radius")
    play = values.get("follower", "side_clearance")
    for key, value in (("roller_radius", radius), ("side_clearance", play)):
        if value is not None and 0.0 < value < SMALLEST_LENGTH:
            yield ("follower", key), f"must be 0, or {SMALLEST_LENGTH:g} to 1e9"
    if radius == 0.0 and groove:
        message = "must be above 0: a groove holds a roller, a knife edge has no groove"
        yield ("follower", "roller_radius"), message
    if play is None or values.contact is None:
        return
    if not groove:
        message = 'belongs to contact "groove"; a roller on one flank has no play'
        yield ("follower", "side_clearance"), message
    elif radius is not None and radius > 0.0 and not play < 2.0 * radius:
        message = f"must be less than the roller's diameter, {2.0 * radius:g}"
        yield ("follower", "side_clearance"), message


def a_mass_is_known(values: ValidValues) -> Iterator[Broken]:
    """Where the mass is limited, thickness and density are stated."""
    if not values.has("limits", "mass") or not values.valid("part"):
        return
    if values.lacks("part", "thickness"):
        yield ("limits", "mass"), "needs [part] thickness"
    dense = (("part", "density"), ("part", "material"), (EFFECTS_KEY, "balance"))
    if values.valid(EFFECTS_KEY) and all(values.lacks(*key) for key in dense):
        yield ("limits", "mass"), "needs [part] material or density"


def tolerance_is_possible(values: ValidValues) -> Iterator[Broken]:
    """The tolerance is within its limits, and in proportion to the mechanism."""
    place = ("output", "tolerance")
    if not values.valid("units"):
        return
    if values.has(*place):
        stated = values.get(*place)
        if stated is None:
            return
        tolerance = stated * values.mm
        if not SMALLEST_TOLERANCE <= tolerance <= LARGEST_TOLERANCE:
            message = "must be a length of 1e-7 mm to 1 mm"
            if values.unit != "mm":
                message += f'; it is given in the scene\'s unit, "{values.unit}"'
            yield place, message
            return
    else:
        tolerance = DEFAULT_TOLERANCE
    base = values.get("follower", "base_radius")
    size = _largest_length(values)
    if base is None or size is None:
        return
    base, size = base * values.mm, size * values.mm
    what = "" if values.has(*place) else f"is not given; its default, {tolerance:g} mm, "
    if tolerance < FINEST_PART * size:
        message = f"must be at least {FINEST_PART:g} of the largest length, {size:g} mm"
        yield place, what + message
    if tolerance > COARSEST_PART * base:
        message = f"must be at most {COARSEST_PART:g} of the base radius, {base:g} mm"
        yield place, what + message


def _largest_length(values: ValidValues) -> float | None:
    """The mechanism's largest length, in the scene's unit."""
    if not (values.valid("follower") and values.valid("motion")):
        return None
    kind = values.follower_kind
    if kind is None:
        return None
    sizes = (values.get("follower", *key.split(".")) for key in kind.sizes)
    lengths = [math.hypot(*size) if isinstance(size, list) else abs(size or 0.0) for size in sizes]
    if not values.angular:
        lengths.extend(abs(end) for _, end in _ends(values))
    return max(lengths)


def _ends(values: ValidValues) -> Iterator[tuple[KeyPath, float]]:
    """The positions at which segments end, where they are known, with their keys."""
    for index in range(values.segments):
        end = values.get("motion", index, "to")
        if end is not None:
            yield ("motion", index, "to"), end


RULES: Final[tuple[Rule, ...]] = (
    spans_make_one_turn,
    motion_returns,
    positions_are_distinct_from_0,
    laws_have_their_parameters,
    one_speed,
    swing_is_possible,
    positions_have_one_unit,
    a_return_disc_has_a_main_disc,
    a_yoke_holds_one_plate_cam,
    followers_keep_their_own_rules,
    rollers_have_what_is_theirs,
    linkage_drives_the_follower,
    effects_suit_the_machine,
    a_computed_speed_has_one_source,
    a_flank_is_one_of_two,
    options_obey_their_rules,
    milling_is_stated,
    contact_and_part_agree,
    roller_is_possible,
    part_is_possible,
    print_suits_the_part,
    families_vary,
    tolerances_are_stated_once,
    chamfers_have_edges,
    a_mass_is_known,
    tolerance_is_possible,
)
