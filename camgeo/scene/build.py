"""From the values of a scene to the engine's objects: units converted, once."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np

from camgeo.cam.contact import Contact
from camgeo.check.limits import Limits
from camgeo.errors import Fault, GeometryError
from camgeo.formats.format import Options
from camgeo.mechanism.declared.registry import FOLLOWERS, LINKAGES
from camgeo.mechanism.linkage import LinkedMotion
from camgeo.mechanism.values import SIGNS, Values
from camgeo.motion.plan import Dwell, MotionPlan
from camgeo.motion.planning.planner import plan_motion
from camgeo.part.spec import Keyway, PartSpec
from camgeo.scene.data_files import DataFiles
from camgeo.scene.inside import Inside
from camgeo.scene.keys import Path, path_of
from camgeo.scene.model import OutputSpec
from camgeo.scene.motion import MotionRequests
from camgeo.scene.schema import schema_for
from camgeo.scene.sound import SoundValues
from camgeo.units import RPM, TURN

if TYPE_CHECKING:
    from camgeo.cam.breadth import Yoke
    from camgeo.mechanism.follower import Follower
    from camgeo.mechanism.linkage_protocol import Linkage
    from camgeo.motion.time_course import SpeedCurve

Built = TypeVar("Built")


class Earlier(Protocol):
    """A scene that this one is an edit of; what does not change is taken from it."""

    @property
    def stated(self) -> SoundValues: ...

    @property
    def plan(self) -> MotionPlan: ...

    @property
    def follower(self) -> Follower | None: ...

    @property
    def linkage(self) -> Linkage | None: ...


class Builder:
    """Builds the objects of a scene whose values are sound, and gathers what geometry forbids."""

    def __init__(
        self, values: SoundValues, files: DataFiles, earlier: Earlier | None = None
    ) -> None:
        self.values = values
        self.faults: list[Fault] = []
        self.files = files
        self._earlier = earlier
        self._mm = values.mm

    def _unchanged(self, *tables: str) -> Earlier | None:
        """The scene before the edit, if these tables, and the units, are the same objects."""
        if self._earlier is None:
            return None
        now, then = self.values.scene.exact, self._earlier.stated.scene.exact
        same = all(now.get(name) is then.get(name) for name in ("units", *tables))
        return self._earlier if same else None

    def plan(self) -> MotionPlan | None:
        """The motion plan; None if the motion is not sound."""
        values = self.values
        if not values.sound("motion") or not values.sound("follower", "kind"):
            return None
        earlier = self._unchanged("motion")
        if earlier is not None and earlier.stated.angular == values.angular:
            for index in range(values.segments):
                if values.has("motion", index, "file"):
                    self.files.read(("motion", index, "file"))
            return earlier.plan
        requests = MotionRequests(values, self.files)
        self.faults += requests.faults
        if requests.faults or self.files.faults:
            return None
        return self._engine(("motion",), lambda: plan_motion(requests.all, requests.unit))

    def speed_curve(self) -> SpeedCurve | None:
        """How the speed varies; None if it does not, or its file is not sound."""
        key = ("cam", "speed_curve")
        if self.values.get(*key) is None:
            return None
        data = self.files.read(key)
        if data is None:
            return None
        from camgeo.motion.speed_table import read_speed_table  # few scenes have one

        name: str = self.values.get(*key)
        return self._engine(key, lambda: read_speed_table(data, name))

    def follower(self) -> Follower | None:
        """The follower; None if its table is not sound or there is no such mechanism."""
        values = self.values
        if not values.sound("follower") or not values.has("follower"):
            return None
        if (earlier := self._unchanged("follower", "linkage")) is not None:
            return earlier.follower
        kind = FOLLOWERS[values.get("follower", "kind")]
        return self._engine(("follower",), lambda: kind.build(self._table("follower")))

    def returning(self, follower: Follower) -> Follower | None:
        """The return roller of a conjugate pair; None if there is none, or none that works."""
        table: dict[str, Any] | None = self.values.get("follower", "return")
        if table is None:
            return None
        build = FOLLOWERS[self.values.get("follower", "kind")].build_return
        assert build is not None  # the schema of other kinds has no such table
        given = self._table("follower", "return")
        return self._engine(("follower",), lambda: build(follower, given))

    def _yoke(self) -> Yoke | None:
        table: dict[str, Any] | None = self.values.get("follower", "yoke")
        if table is None:
            return None
        from camgeo.cam.breadth import Yoke  # few scenes have one

        return Yoke(**_given(table, {"breadth": self._mm}))

    def linkage(self) -> Linkage | None:
        """The linkage; None if there is none, or none that works.

        Of a slider-crank the follower's kind decides which member makes the demanded motion.
        """
        if self.values.get("linkage") is None:
            return None
        kind = LINKAGES[self.values.get("linkage", "kind")]
        given, unit = self._table("linkage"), self.values.lift_unit
        if unit not in kind.members:
            return None  # which is told
        earlier = self._unchanged("linkage")
        if earlier is not None and earlier.stated.far_end == self.values.far_end:
            return earlier.linkage
        return self._engine(("linkage",), lambda: kind.build(given, unit))

    def _table(self, *place: str) -> Values:
        """The sound table at `place`."""
        return Values(self.values.get(*place), self._mm, linked=self.values.has("linkage"))

    def join(self, plan: MotionPlan, follower: Follower, linkage: Linkage) -> None:
        """Check that the linkage makes the motion, and moves the roller as the scene says."""
        linked = self._engine(("linkage",), lambda: LinkedMotion(plan, linkage))
        stated = self.values.get("follower", "direction")
        if linked is None or stated is None or follower.pivot is None:
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
            self.faults.append(self.values.scene.fault(("follower", "direction"), message, hint))

    def effects(self, faulted: Collection[str] = ()) -> dict[str, dict[str, Any]]:
        """The tables of the effects that the scene names, in the units inside.

        Of those whose keys are among `faulted` nothing more is told.
        """
        if not self.values.has("effects"):
            return {}
        from camgeo.scene.effects import EffectTables  # few scenes name an effect

        tables = EffectTables(self.values, self.files, faulted)
        self.faults += tables.faults
        return tables.all

    def rest(self, speed_curve: SpeedCurve | None) -> dict[str, Any]:
        """The rest of what a scene has, all of whose values are sound."""
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
            "limits": self._limits(),
            "part": self._part(),
        }

    def _limits(self) -> Limits:
        table: dict[str, Any] = self.values.get("limits") or {}
        angle = table.get("transmission_angle")
        return Limits(
            transmission_angle=None if angle is None else math.radians(angle),
            undercut=table.get("undercut", "refuse"),
            **_given(table, {"radius_ratio": 1.0, "closing_error": self._mm}),
        )

    def _part(self) -> PartSpec | None:
        table: dict[str, Any] | None = self.values.get("part")
        if table is None:
            return None
        keyway = table.get("keyway")
        lengths = dict.fromkeys(("thickness", "bore", "rim", "groove_depth"), self._mm)
        return PartSpec(
            keyway=keyway
            and Keyway(
                width=self._mm * keyway["width"],
                depth=self._mm * keyway["depth"],
                angle=math.radians(keyway.get("angle", 0.0)),
            ),
            **_given(table, lengths),
        )

    def output(self) -> OutputSpec:
        """What is written, and how; the defaults, if anything of it is not sound."""
        table: dict[str, Any] = self.values.get("output") or {}
        inside = Inside(self.values, self.files)
        options: dict[str, Any] = {}
        for form in schema_for(self.values.scene.plain).formats:
            if form.name in table:
                path = ("output", form.name)
                made = inside.table(path, form.schema)
                if None not in made.values():  # a file that cannot be read, which is told
                    options[form.name] = self._engine(path, partial(form.parse, made))
        given: dict[str, Any] = _given(table, {"tolerance": self._mm})
        if "formats" in table:
            given["formats"] = tuple(table["formats"])
        if "fit" in table:
            given["fit"] = table["fit"]
        if "accuracy" in table:
            given["accuracy_ripple"] = table["accuracy"].get("ripple", False)
        return OutputSpec(options=Options(options), **given)

    def _engine(self, table: Path, make: Callable[[], Built]) -> Built | None:
        """What `make` builds; None, with a fault of the table's key, if geometry forbids it."""
        try:
            return make()
        except GeometryError as error:
            path = path_of(error.key) or ()
            if path[: len(table)] != table:
                path = table + path
            self.faults.append(self.values.scene.fault(path, error.message))
            return None


def _given(table: dict[str, Any], scales: dict[str, float]) -> dict[str, Any]:
    """The keys of `scales` that the table has, scaled; for the rest the dataclass has defaults."""
    return {key: scale * table[key] for key, scale in scales.items() if key in table}
