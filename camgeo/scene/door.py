"""The door of a scene: its values are checked, and the engine's objects built from them."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from decimal import Decimal
from functools import partial
from typing import TYPE_CHECKING, Any, Final, TypeVar

import numpy as np

from camgeo.cam.cam import Contact
from camgeo.check.finding import Limits
from camgeo.errors import GeometryError, SceneError
from camgeo.kinematics.mechanism.declared.registry import FOLLOWERS, LINKAGES
from camgeo.kinematics.mechanism.linkage import linked
from camgeo.kinematics.mechanism.values import SIGNS, Values
from camgeo.kinematics.motion import FREE
from camgeo.kinematics.plan import FULL_TURN, Dwell, MotionPlan
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import (
    MoveRequest,
    PointsRequest,
    Request,
    TableRequest,
    Unit,
)
from camgeo.part.spec import PartSpec, part_of
from camgeo.reading import SCENE
from camgeo.scene.formats.drawing import drawing_of
from camgeo.scene.formats.format import Options, OutputSpec
from camgeo.scene.keys import KeyPath, path_of
from camgeo.scene.rules import broken_rules
from camgeo.scene.schema import (
    EFFECTS_KEY,
    INFLECTION,
    MILLING,
    OUTPUT,
    SHAPES,
    definition,
    schema_for,
)
from camgeo.scene.schema_faults import judge
from camgeo.scene.values import Document, Inside, Source, ValidValues, far_end_of
from camgeo.units import RPM, TURN

if TYPE_CHECKING:
    from camgeo.cam.cam import Yoke
    from camgeo.kinematics.mechanism.conjugate import Mount
    from camgeo.kinematics.mechanism.follower import Follower
    from camgeo.kinematics.mechanism.linkage import Linkage
    from camgeo.kinematics.time_course import SpeedCurve
    from camgeo.milling.milling import MillingSpec
    from camgeo.part.printing import PrintSpec
    from camgeo.scene.formats.drawing import DrawingSpec


Built = TypeVar("Built")


VERSION_KEY: Final = "camgeo"

WEIGHING: Final = "balance"
"""The effect whose table may state the density of the part."""

Attributes = Mapping[str, Any]
"""Of a `camgeo.scene.scene.Scene`, by their names."""


def enter(document: Document, source: Source, earlier: Attributes | None = None) -> Attributes:
    """The attributes of the scene that `document` states.

    What an edit of an `earlier` scene leaves unchanged is taken from that scene.

    Raises
    ------
    SceneError
        With all its faults.
    """
    verdict = judge(document)
    if (VERSION_KEY,) in verdict.bad and VERSION_KEY in document.exact:
        # A scene of another version has other keys; this schema's messages would mislead.
        found = [f for f in (*document.faults, *verdict.faults) if f.key == VERSION_KEY]
        raise SceneError(found, source.file)
    values = ValidValues(document, verdict.bad, verdict.meant)
    stated: ValidValues | None = earlier["stated"] if earlier else None
    faults = [*document.faults, *verdict.faults, *broken_rules(values, stated)]
    inside = Inside(values, source.folder, source.contents)
    builder = Builder(inside, earlier or {})
    # The plan repeats some of these checks with messages of its own.
    moves = not any(fault.key.startswith("motion") for fault in faults)
    plan = builder.plan() if moves else None
    follower, linkage, speed_curve = builder.follower(), builder.linkage(), builder.speed_curve()
    mount = None if follower is None else builder.mount()
    returning = None if mount is None or follower is None else builder.returning(mount, follower)
    effects = builder.effects({fault.key for fault in faults})
    output = builder.kept("output", Builder.output)
    faulted = {fault.key for fault in faults}
    milling = builder.kept("milling", lambda own: own.milling(output, faulted))
    if plan is not None and follower is not None and linkage is not None:
        builder.join(plan, follower, linkage)
    faults += inside.faults
    if faults or plan is None or (follower is None and values.has("follower")):
        last = len(document.lines) + SCENE.size
        raise SceneError(sorted(faults, key=lambda fault: fault.line or last), source.file)
    rest = builder.rest(speed_curve, effects)
    if inside.faults:
        raise SceneError(inside.faults, source.file)
    return {
        "stated": values,
        "source": source.having(inside.contents),
        "files": tuple(sorted(inside.hashes.items())),
        "plan": plan,
        "follower": follower,
        "linkage": linkage,
        "mount": mount,
        "returning": returning,
        "effects": effects,
        "output": output,
        "milling": milling,
        **rest,
    }


class Builder:
    """Builds the objects of a scene from its valid values; the faults go to `inside`."""

    def __init__(self, inside: Inside, earlier: Attributes) -> None:
        self.inside = inside
        self.values = inside.values
        self._earlier = earlier
        self._mm = inside.values.mm
        self._schema = schema_for(inside.values.scene.plain)

    def _unchanged(self, *tables: str) -> bool:
        """Whether this is an edit of a scene with the same tables, and the same units."""
        if not self._earlier:
            return False
        now, then = self.values.scene.exact, self._earlier["stated"].scene.exact
        return all(now.get(name) is then.get(name) for name in ("units", *tables))

    def kept(self, name: str, make: Callable[[Builder], Built]) -> Built:
        """What `make` builds, or the attribute `name` of the earlier scene if nothing that this was
        built from has changed.

        `make` reads the scene by its builder alone. What is built from files is built again.
        """
        reads = self.values.reads
        if name in reads:
            found: Built = self._earlier[name]
            return found
        if not (self._earlier and self.values.flawless):
            return make(self)
        inside, noted = self.inside.noting()
        made = make(Builder(inside, self._earlier))
        self.inside.take(inside)
        if not inside.contents:
            reads[name] = noted.noted
        return made

    def plan(self) -> MotionPlan | None:
        """The motion plan; None if the motion is not valid."""
        values = self.values
        if not values.valid("motion") or not values.valid("follower", "kind"):
            return None
        earlier = self._earlier
        if self._unchanged("motion") and earlier["stated"].angular == values.angular:
            for index in range(values.segments):
                if values.has("motion", index, "file"):
                    self.inside.read(("motion", index, "file"))
            plan: MotionPlan = earlier["plan"]
            return plan
        requests = MotionRequests(self.inside)
        if self.inside.faults:
            return None
        return self._engine(("motion",), lambda: plan_motion(requests.all, requests.unit))

    def speed_curve(self) -> SpeedCurve | None:
        """How the speed varies; None if it does not, or its file is not valid."""
        key = ("cam", "speed_curve")
        if self.values.get(*key) is None:
            return None
        data = self.inside.read(key)
        if data is None:
            return None
        if self._unchanged("cam"):
            curve: SpeedCurve | None = self._earlier["speed_curve"]
            return curve
        from camgeo.kinematics.tables import read_speed_table  # few scenes have one

        name: str = self.values.get(*key)
        return self._engine(key, lambda: read_speed_table(data, name))

    def follower(self) -> Follower | None:
        """The follower; None if its table is not valid or there is no such mechanism."""
        values = self.values
        if not values.valid("follower") or not values.has("follower"):
            return None
        if self._unchanged("follower", "linkage"):
            follower: Follower = self._earlier["follower"]
            return follower
        kind = FOLLOWERS[values.get("follower", "kind")]
        return self._engine(("follower",), lambda: kind.build(self._table("follower")))

    def mount(self) -> Mount | None:
        """How the return roller of a conjugate pair is fixed to the main one; None without one."""
        table: dict[str, Any] | None = self.values.get("follower", "return")
        if table is None:
            return None
        build = FOLLOWERS[self.values.get("follower", "kind")].build_return
        assert build is not None  # the schema of other kinds has no such table
        mount: Mount = build(self._table("follower", "return"))
        return mount

    def returning(self, mount: Mount, follower: Follower) -> Follower | None:
        """The return roller of a conjugate pair; None if it cannot work."""
        return self._engine(("follower",), lambda: mount.roller(follower))

    def _yoke(self) -> Yoke | None:
        if self.values.get("follower", "yoke") is None:
            return None
        from camgeo.cam.cam import Yoke  # few scenes have one

        return Yoke(**self.inside.table(("follower", "yoke"), definition("yoke")))

    def linkage(self) -> Linkage | None:
        """The linkage; None if there is none, or it cannot work.

        Of a slider-crank the follower's kind decides which member makes the demanded motion.
        """
        if self.values.get("linkage") is None:
            return None
        kind = LINKAGES[self.values.get("linkage", "kind")]
        given, unit = self._table("linkage"), self.values.lift_unit
        if unit not in kind.members:
            return None  # which is reported
        earlier = self._earlier
        if self._unchanged("linkage") and far_end_of(earlier["stated"]) == far_end_of(self.values):
            linkage: Linkage = earlier["linkage"]
            return linkage
        return self._engine(("linkage",), lambda: kind.build(given, unit))

    def _table(self, *place: str) -> Values:
        """The valid table at `place`."""
        return Values(self.values.get(*place), self._mm, linked=self.values.has("linkage"))

    def join(self, plan: MotionPlan, follower: Follower, linkage: Linkage) -> None:
        """Check that the linkage makes the motion, and moves the roller as the scene says."""
        motion = self._engine(("linkage",), lambda: linked(plan, linkage))
        stated = self.values.get("follower", "direction")
        if motion is None or stated is None or follower.pivot is None:
            return
        arm_side = SIGNS[self.values.get("follower", "arm_side") or "ccw"]
        strokes = [segment.to for segment in plan.segments if not isinstance(segment, Dwell)]
        farthest = max(strokes, key=abs, default=0.0)
        jet = np.array([[farthest], [0.0], [0.0], [0.0]])
        swing = float(linkage.transform(jet)[0, 0])
        if swing * farthest * arm_side * SIGNS[stated] < 0.0:
            found = "inward" if stated == "outward" else "outward"
            message = f"contradicts the linkage, which moves the {follower.touching} {found}"
            hint = f'leave it out, write "{found}", or turn one of the linkage\'s choices'
            self.inside.fault(("follower", "direction"), message, hint)

    def effects(self, faulted: Collection[str] = ()) -> dict[str, dict[str, Any]]:
        """The tables of the effects that the scene names, in the units inside.

        No further faults are reported for those whose keys are among `faulted`.
        """
        if not self.values.has("effects"):
            return {}
        from camgeo.scene.effects import effect_tables  # few scenes name an effect

        return effect_tables(self.inside, faulted)

    def rest(self, speed_curve: SpeedCurve | None, effects: Attributes) -> dict[str, Any]:
        """The other attributes of a scene, all of whose values are valid; None, with a fault, for
        what has numbers too large or too small to be computed with.
        """
        get = self.values.get
        speed = get("cam", "speed")
        if speed_curve is not None:
            speed = TURN / speed_curve.spline.period / RPM
        return {
            "name": get("name"),
            "unit": self.values.unit,
            "lift_unit": self.values.lift_unit,
            "rotation": SIGNS[get("cam", "rotation")],
            "speed": None if speed is None else speed * RPM,
            "yoke": self._yoke(),
            "speed_curve": speed_curve,
            "contact": self.values.contact or Contact.INNER,
            "side_clearance": self._mm * (get("follower", "side_clearance") or 0.0),
            "limits": self.kept("limits", Builder._limits),
            "part": self.kept("part", lambda own: own.part(effects)),
            "model": get("state", "motion"),
            "contour": get("state", "contour"),
            "flank": get("state", "flank"),
            "train": get("state", "output") or "elastic",
            "state_speed": get("state", "speed"),
            "printing": self.kept("printing", Builder._printing),
            "drawing": self.kept("drawing", Builder._drawing),
        }

    def _limits(self) -> Limits | None:
        return self._engine(("limits",), lambda: Limits(**self._top("limits")))

    def _drawing(self) -> DrawingSpec | None:
        return self._engine(("drawing",), lambda: drawing_of(self._top("drawing")))

    def part(self, effects: Attributes) -> PartSpec | None:
        """The part; the `effects` are those that the scene names."""
        self.values.raw(EFFECTS_KEY)  # notes that `effects` are read, see `kept`
        if not self.values.has("part"):
            return None
        top, name = self._top("part"), self.values.get("name")

        def made() -> PartSpec:
            found = part_of(top, name)
            if WEIGHING not in effects:
                return found
            from camgeo.scene.effects import weighed  # few scenes name an effect

            return weighed(found, effects[WEIGHING], self.inside)

        return self._engine(("part",), made)

    def _printing(self) -> PrintSpec | None:
        if self.values.get("print") is None:
            return None
        from camgeo.part.printing import print_of  # few scenes print

        return self._engine(("print",), lambda: print_of(self._top("print")))

    def output(self) -> OutputSpec:
        """What is written, and how; the defaults if anything in it is not valid."""
        given = self._top("output")
        options: dict[str, Any] = {}
        for form in self._schema.formats:
            table = given.pop(form.name, None)
            if table is not None and None not in table.values():  # a file that cannot be read
                place = ("output", form.name)
                options[form.name] = self._engine(place, partial(form.parse, table))
        ripple = given.pop("accuracy", {}).get("ripple", False)
        return OutputSpec(options=Options(options), accuracy_ripple=ripple, **given)

    def milling(self, output: OutputSpec, faulted: Collection[str] = ()) -> MillingSpec | None:
        """What the scene says on milling; None if it says nothing, or nothing valid.

        No further faults are reported if one of its keys is among those `faulted`. `output` is that
        of the scene.
        """
        self.values.raw(OUTPUT)  # notes that `output` is read, see `kept`
        named = any(self.values.has(name) for name in MILLING)
        if not (named or "gcode" in output.options.given):
            return None
        if any((path_of(key) or ("",))[0] in MILLING for key in faulted):
            return None
        from camgeo.scene.milling import MillingBuilder  # few scenes mill

        return MillingBuilder(self.inside).spec(output.options.given.get("gcode"))

    def _top(self, name: str) -> dict[str, Any]:
        """One of the scene's tables in the units inside; empty if it is missing or not valid."""
        if self.values.get(name) is None:
            return {}
        return self.inside.table((name,), self._schema.root["properties"][name])

    def _engine(self, table: KeyPath, make: Callable[[], Built]) -> Built | None:
        """What `make` builds; None, with a fault of the table's key, if geometry forbids it."""
        try:
            return make()
        except GeometryError as error:
            path = path_of(error.key) or ()
            if path[: len(table)] != table:
                path = table + path
            self.inside.fault(path, error.message)
            return None


# -- motion ---------------------------------------------------------------------------------------
# From the segments of a scene to the requests for the motion plan.


EQUAL: Final = "equal-"
"""Prefix of words for the inflection point that makes both parts of a law equal in something."""

UNITS: Final = {
    "mm": ("mm",),
    "inch": ("inch", "in", '"'),
    "deg": ("deg", "degree", "degrees", "°"),
}
"""Spellings of the units that the heading of a lift table may name."""


class MotionRequests:
    """The segments of a valid scene as requests.

    Attributes
    ----------
    all : in the order of the scene.
    unit : of positions in the scene.
    """

    def __init__(self, inside: Inside) -> None:
        values = inside.values
        self.inside = inside
        self.values = values
        self.all: list[Request] = []
        self._scale = math.radians(1.0) if values.angular else values.mm
        self.unit = Unit("deg" if values.angular else values.unit, self._scale)
        for index in range(values.segments):
            request = self._request(("motion", index))
            if request is not None:
                self.all.append(request)

    def _request(self, place: KeyPath) -> Request | None:
        dwell = self.values.exact(*place, "dwell")
        if dwell is not None:
            return Dwell(dwell)
        table: dict[str, Any] = self.values.get(*place)
        span = self.values.exact(*place, "span") or Decimal(0)
        if table["law"] == "table":
            return self._table(place, table, span)
        end = {key: self._scaled(table.get(key)) for key in ("velocity", "acceleration")}
        to = self._scale * table["to"]
        if table["law"] == "points":
            return self._points(place, table, span, to, end)
        inflection = table.get(INFLECTION)
        balance = inflection.removeprefix(EQUAL) if isinstance(inflection, str) else ""
        return MoveRequest(
            span=span,
            to=to,
            law=table["law"],
            parameters={
                key: float(table[key])
                for key in SHAPES
                if key in table and not (balance and key == INFLECTION)
            },
            jerk=self._scaled(table.get("jerk")),
            optimise=_weights(table.get("optimise")),
            balance=balance,
            **end,
        )

    def _scaled(self, value: float | None) -> float | None:
        return None if value is None else self._scale * value

    def _points(
        self,
        place: KeyPath,
        table: dict[str, Any],
        span: Decimal,
        to: float,
        end: dict[str, float | None],
    ) -> PointsRequest | None:
        shares: list[float] = []
        last = Decimal(0)
        for index in range(len(table["points"])):
            at = self.values.exact(*place, "points", index, "at")
            assert at is not None  # the scene is valid
            if not last < at < span:
                message = f"must ascend, inside the span of {span.normalize():f} degrees"
                self.inside.fault((*place, "points", index, "at"), message)
                return None
            shares.append(float(at / span))
            last = at
        given = {
            index: (self._scaled(point.get("velocity")), self._scaled(point.get("acceleration")))
            for index, point in enumerate(table["points"])
        }
        return PointsRequest(
            span=span,
            to=to,
            shares=np.array(shares),
            positions=np.array([self._scale * point["to"] for point in table["points"]]),
            given={index: boundary for index, boundary in given.items() if boundary != FREE},
            **end,
        )

    def _table(self, place: KeyPath, table: dict[str, Any], span: Decimal) -> TableRequest | None:
        from camgeo.kinematics.tables import read_lift_table  # few scenes have one

        key = (*place, "file")
        data = self.inside.read(key)
        if data is None:
            return None
        try:
            rows = read_lift_table(data, table["file"], float(span), periodic=span == FULL_TURN)
        except GeometryError as error:
            self.inside.fault(key, error.message)
            return None
        wanted = "deg" if self.values.angular else self.values.unit
        if rows.unit and rows.unit.lower() not in UNITS[wanted]:
            self.inside.fault(key, f"gives the lift in {rows.unit}; the scene takes it in {wanted}")
            return None
        return TableRequest(
            span=span,
            shares=rows.first / float(span),
            lifts=self._scale * rows.second,
            smoothing=self._scaled(table.get("smoothing")),
        )


def _weights(optimise: Any) -> dict[str, float]:
    """Weights of the quantities to be kept small."""
    if optimise is None:
        return {}
    return {optimise: 1.0} if isinstance(optimise, str) else dict(optimise)
