"""A scene: the values that specify a cam, and the engine's objects built from them."""

from __future__ import annotations

import errno
import hashlib
import json
import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property, partial
from os import PathLike
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Self, TypeVar

import numpy as np

from camgeo.cam.cam import Contact, Yoke
from camgeo.check.finding import Limits
from camgeo.errors import CamgeoError, Fault, GeometryError, SceneError, unreadable
from camgeo.kinematics.mechanism.declared.registry import FOLLOWERS, LINKAGES
from camgeo.kinematics.mechanism.linkage import Linkage, linked
from camgeo.kinematics.mechanism.values import SIGNS, Values
from camgeo.kinematics.motion import FREE
from camgeo.kinematics.plan import FULL_TURN, Dwell, MotionPlan
from camgeo.kinematics.planning.planner import plan_motion
from camgeo.kinematics.planning.requests import (
    MoveRequest,
    PointsRequest,
    PositionUnit,
    Request,
    TableRequest,
)
from camgeo.numeric.checked import instance_from_table
from camgeo.part.spec import PartSpec
from camgeo.reading import SCENE, TABLE, read_limited
from camgeo.record import brief, pickled
from camgeo.scene.formats.drawing import DrawingSpec
from camgeo.scene.formats.format import FORMATS, Format, Options, OutputSpec
from camgeo.scene.keys import KeyPath, parse_path, tree_value
from camgeo.scene.rules import broken_rules
from camgeo.scene.schema import (
    EFFECTS_KEY,
    INFLECTION,
    MILLING,
    OUTPUT,
    SHAPES,
    Node,
    definition,
    resolved,
    schema_for,
    table_keys,
)
from camgeo.scene.values import (
    Document,
    SceneConverter,
    Source,
    Tree,
    ValidValues,
    check_schema,
    document,
    document_of_tree,
    encode_scene,
    linkage_far_end,
    with_edits,
    without,
)
from camgeo.units import RPM, TURN, LengthUnit, LiftUnit

if TYPE_CHECKING:
    from camgeo.dynamics.state.state import Carrier, Model, Speed, Train
    from camgeo.geometry.contour.contour import Form
    from camgeo.kinematics.mechanism.follower import Follower
    from camgeo.kinematics.mechanism.rollers import Mount
    from camgeo.kinematics.time_course import SpeedCurve
    from camgeo.milling.milling import MillingSpec
    from camgeo.part.compensation import PrintSpec


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Scene:
    """One scene; lengths in mm, angles in rad, unless said otherwise.

    Its values decide all else: no attribute can be replaced by itself, only by `with_values`.
    Scenes with the same content are equal, whatever file they come from.

    Attributes
    ----------
    source : where the values came from, and what is in the files that they name.
    stated : the valid values, as the scene's own rules see them.
    files : names of the files with data, each with the SHA-256 of its bytes.
    name : of the design, the stem of its files.
    unit : of length in the scene file; drawings, programs and tables are written in it.
    rotation : sense in which the disc turns, +1 counter-clockwise, -1 clockwise.
    speed : of the disc, positive [rad/s], the mean one if it varies; None if the scene gives none.
    speed_curve : how the speed varies over the turn; None if it does not.
    plan : the motion; of the far end of a linkage if there is one, else of the follower.
    lift_unit : of the follower's own motion, "mm" or "rad".
    follower : what touches the disc; None if the scene has none, and so no disc.
    linkage : between motion and follower; None if the motion is the follower's own.
    mount : how the second roller of a conjugate pair is fixed to the first; None if there is none.
    returning : the second roller, on the return disc of a conjugate pair; None if there is none.
    yoke : the other side of the follower on a cam of constant breadth; None if there is none.
    contact : the flank on which the roller runs.
    side_clearance : groove's width less the roller's diameter [mm]; 0 without groove.
    limits : with which the design is compared.
    part : the disc as a body; None if the scene has no `[part]`.
    drawing : what the sheet states; the defaults if the scene has no `[drawing]`.
    model : whose motion the effects are computed for; None for the default of its `limits`.
    contour : form of the contour that the model "written" is of; None for that of the drawing.
    flank : side on which a follower that is held both ways runs for the model "written"; None for
        the main one.
    train : whether the forces are those of the elastic train, where the scene has one.
    effects : the table of each effect that the scene names, in its order, numbers in the units
        of `camgeo.dynamics.effects.effect`.
    output : what is written.
    printing : how bodies are compensated for printing; None if the scene has no `[print]`.
    milling : tools, blank, holding and operations; None if the scene says nothing on milling, or
        lacks keys of its tables.
    """

    source: Source
    stated: ValidValues
    files: tuple[tuple[str, str], ...]
    name: str
    unit: LengthUnit
    rotation: int
    speed: float | None
    speed_curve: SpeedCurve | None
    plan: MotionPlan
    lift_unit: LiftUnit
    follower: Follower | None
    linkage: Linkage | None
    mount: Mount | None
    returning: Follower | None
    yoke: Yoke | None
    contact: Contact
    side_clearance: float
    limits: Limits
    part: PartSpec | None
    drawing: DrawingSpec
    effects: Mapping[str, Mapping[str, Any]]
    output: OutputSpec
    milling: MillingSpec | None
    printing: PrintSpec | None
    model: Model | None
    contour: Form | None
    flank: Carrier | None
    train: Train
    state_speed: Speed | None

    def __init__(self, values: Mapping[str, Any], *, folder: str | Path | None = None) -> None:
        """A scene from its tables, nested as in TOML; a float is the number that Python prints.

        `folder` holds the files that the scene names.

        Raises
        ------
        SceneError
            With all its faults.
        """
        _fill(self, enter(Document.from_values(values), Source.from_file("", folder)))

    @classmethod
    def from_text(cls, data: bytes, file: str = "", folder: str | Path | None = None) -> Self:
        """A scene from its TOML in UTF-8; `file` is the path it came from, for messages too.

        `folder` holds the files that the scene names, if it is not that of `file`. Raises
        SceneError with all its faults.
        """
        try:
            parsed = document(data)
        except SceneError as error:
            raise SceneError(error.faults, file) from error
        return cls.from_document(parsed, Source.from_file(file, folder, data.decode()))

    @classmethod
    def from_document(
        cls, document: Document, source: Source, earlier: Scene | None = None
    ) -> Self:
        """A scene from its document; what an edit of `earlier` leaves unchanged is reused."""
        instance = cls.__new__(cls)
        _fill(instance, enter(document, source, None if earlier is None else vars(earlier)))
        return instance

    @cached_property
    def values(self) -> Mapping[str, Any]:
        """The values as they are stated, nested as in TOML; decimal numbers are Decimals."""
        values: Mapping[str, Any] = _read_only(self._tree)
        return values

    @property
    def _tree(self) -> Tree:
        return self.stated.scene.exact

    @property
    def states_milling(self) -> bool:
        """Whether the scene states anything on milling, even if not all that a program needs."""
        return self.milling is not None or any(map(self.stated.has, MILLING))

    def lacking(self, formats: Iterable[Format[Any]]) -> tuple[Fault, ...]:
        """Why the scene cannot be written in `formats`, at the place that names each."""
        named: list[str] = self.stated.get("output", "formats") or []
        return tuple(
            self.stated.scene.fault(("output", "formats", named.index(form.name)), message)
            if form.name in named
            else Fault("format", form.name, message)
            for form in formats
            for message in form.lacking(self.stated)
        )

    @cached_property
    def identity(self) -> str:
        """SHA-256 of all that the scene states, hexadecimal; equal for equal values in any
        spelling.
        """
        return scene_identity(self._tree, self._digest)

    @cached_property
    def made(self) -> str:
        """SHA-256 of all that decides the bytes of files, hexadecimal, as it stands in them."""
        return output_hash(self._tree, self._digest)

    def _digest(self, name: str) -> str:
        import hashlib  # its import costs as much as a small check

        return hashlib.sha256(self.source.contents[name]).hexdigest()

    @cached_property
    def text_hash(self) -> str:
        """Hash of the text, which files of earlier versions state; empty if there is no text."""
        parsed = self._text_document
        return "" if parsed is None else scene_text_hash(self.source.text.encode(), parsed)

    @property
    def _text_document(self) -> Document | None:
        """The document of the text; None if the values were edited, or came from no text."""
        text = self.source.text
        parsed = document(text.encode()) if text else None
        return None if parsed is None or parsed.exact != self._tree else parsed

    def with_values(self, edits: Mapping[str, Any]) -> Scene:
        """The scene with other values at some keys, None to remove a key.

        Keys are spelled as in messages: "follower.base_radius", "motion[2].law" (or motion.2.law),
        positions counted from 1. What does not depend on the edit is shared: the plan with a new
        roller, plan, follower and linkage with another output. Files are not read again.

        Raises
        ------
        SceneError
            With all faults that the edit would cause.
        """
        changed = document_of_tree(with_edits(self._tree, edits), earlier=self.stated.scene)
        return Scene.from_document(changed, self.source, self)

    def restate(self, error: CamgeoError) -> None:
        """Convert the lengths in an error to the unit of the scene, and show the number of a key as
        the scene states it. A SceneError is in the unit of its scene already.
        """
        if not isinstance(error, SceneError):
            error.restate(self.unit)
        if isinstance(error, GeometryError) and error.value[:1].isdigit():
            fault = self.stated.scene.fault(parse_path(error.key) or (), "")
            error.value = fault.value or error.value

    @contextmanager
    def restating(self) -> Iterator[None]:
        """Restate the errors that are raised in the body of the `with` statement."""
        try:
            yield
        except CamgeoError as error:
            self.restate(error)
            raise

    def to_toml(self) -> str:
        """The scene as TOML, with the comments and the order of the text that it came from.

        Keys added by an edit follow those that were set before them in their table.
        """
        if self._text_document is not None:
            return self.source.text
        from camgeo.scene.toml import written_into

        return written_into(self.source.text, self._tree)

    def __repr__(self) -> str:
        file = f", file={brief(self.source.file)}" if self.source.file else ""
        return f"Scene({brief(self.name)}{file})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scene) and self.identity == other.identity

    def __hash__(self) -> int:
        return hash(self.identity)

    def __reduce__(self) -> tuple[Any, ...]:
        source = self.source
        folder = None if source.folder is None else str(source.folder)
        contents = dict(source.contents)
        return pickled(
            scene, tree=self._tree, file=source.file, folder=folder, text=source.text,
            contents=contents,
        )  # fmt: skip


def _read_only(tree: Any) -> Any:
    """The values of a tree in mappings and tuples, which cannot be changed."""
    if isinstance(tree, dict):
        return MappingProxyType({key: _read_only(item) for key, item in tree.items()})
    if isinstance(tree, list):
        return tuple(_read_only(item) for item in tree)
    return tree


def _fill(made: Scene, attributes: Mapping[str, Any]) -> None:
    """Set the attributes of a new scene, which is frozen."""
    for name, value in attributes.items():
        object.__setattr__(made, name, value)


def scene(
    tree: Tree, file: str, folder: str | None, text: str, contents: Mapping[str, bytes]
) -> Scene:
    """The scene from its pickled state; no file is read."""
    source = Source(file, None if folder is None else Path(folder), text).having(contents)
    return Scene.from_document(document_of_tree(tree), source)


# -- entry ----------------------------------------------------------------------------------------
# Entry of a scene: its values are checked, and the engine's objects are built from them.


Built = TypeVar("Built")


VERSION_KEY: Final = "camgeo"

WEIGHING: Final = "balance"
"""The effect whose table may state the density of the part."""

Attributes = Mapping[str, Any]
"""The attributes of a `Scene`, by their names."""


def enter(document: Document, source: Source, earlier: Attributes | None = None) -> Attributes:
    """The attributes of the scene that `document` states.

    What an edit of an `earlier` scene leaves unchanged is taken from that scene.

    Raises
    ------
    SceneError
        With all its faults.
    """
    verdict = check_schema(document, schema_for(document.plain))
    if (VERSION_KEY,) in verdict.bad and VERSION_KEY in document.exact:
        # A scene of another version has other keys; messages from this schema would mislead.
        version_faults = [f for f in (*document.faults, *verdict.faults) if f.key == VERSION_KEY]
        raise SceneError(version_faults, source.file)
    values = ValidValues(document, verdict.bad, verdict.meant)
    stated: ValidValues | None = earlier["stated"] if earlier else None
    faults = [*document.faults, *verdict.faults, *broken_rules(values, stated)]
    converter = SceneConverter(values, source.folder, source.contents)
    builder = Builder(converter, earlier or {})
    # The planner repeats some of these checks with messages of its own: each fault is reported
    # once.
    moves = not any(fault.key.startswith("motion") for fault in faults)
    plan = builder.plan() if moves else None
    follower, linkage, speed_curve = builder.follower(), builder.linkage(), builder.speed_curve()
    mount = None if follower is None else builder.mount()
    returning = None if mount is None or follower is None else builder.returning(mount, follower)
    effects = builder.effects({fault.key for fault in faults})
    output = builder.reuse("output", Builder.output)
    faulted = {fault.key for fault in faults}
    milling = builder.reuse("milling", lambda own: own.milling(output, faulted))
    if plan is not None and follower is not None and linkage is not None:
        builder.join(plan, follower, linkage)
    faults += converter.faults
    if faults or plan is None or (follower is None and values.has("follower")):
        # Faults without a line come last: no line number exceeds the size of a file in bytes.
        last = len(document.lines) + SCENE.size
        raise SceneError(sorted(faults, key=lambda fault: fault.line or last), source.file)
    rest = builder.rest(speed_curve, effects)
    if converter.faults:
        raise SceneError(converter.faults, source.file)
    return {
        "stated": values,
        "source": source.having(converter.contents),
        "files": tuple(sorted(converter.hashes.items())),
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
    """Builds the engine's objects from the valid values of a scene.

    Parameters
    ----------
    converter : converts the values and collects the faults.
    earlier : attributes of the scene of which this one is an edit; empty for a new scene.
    """

    def __init__(self, converter: SceneConverter, earlier: Attributes) -> None:
        self.converter = converter
        self.values = converter.values
        self._earlier = earlier
        self._mm = converter.values.mm
        self._schema = schema_for(converter.values.scene.plain)

    def _unchanged(self, *tables: str) -> bool:
        """Whether the scene is an edit that left these tables and the units as they were."""
        if not self._earlier:
            return False
        # Edits share unchanged tables as objects, so identity decides without comparing values.
        now, then = self.values.scene.exact, self._earlier["stated"].scene.exact
        return all(now.get(name) is then.get(name) for name in ("units", *tables))

    def reuse(self, name: str, make: Callable[[Builder], Built]) -> Built:
        """What `make` builds, or the attribute `name` of the earlier scene if nothing that this was
        built from has changed.

        `make` reads the scene by its builder alone. What is built from files is built again.
        """
        reads = self.values.reads
        if name in reads:
            attribute: Built = self._earlier[name]
            return attribute
        if not (self._earlier and self.values.flawless):
            return make(self)
        # Reads are recorded only if no value is wrong by itself: otherwise `valid` depends on
        # values that are never read.
        converter, recording = self.converter.recorder()
        built = make(Builder(converter, self._earlier))
        self.converter.take(converter)
        if not converter.contents:  # what depends on files may change while the values do not
            reads[name] = recording.recorded
        return built

    def plan(self) -> MotionPlan | None:
        """The motion plan; None if the motion is not valid."""
        values = self.values
        if not values.valid("motion") or not values.valid("follower", "kind"):
            return None
        earlier = self._earlier
        if self._unchanged("motion") and earlier["stated"].angular == values.angular:
            for index in range(values.segments):
                if values.has("motion", index, "file"):
                    # The scene states hash and content of its files, also where the plan is reused.
                    self.converter.read(("motion", index, "file"))
            plan: MotionPlan = earlier["plan"]
            return plan
        requests = MotionRequests(self.converter)
        if self.converter.faults:
            return None
        return self._engine(("motion",), lambda: plan_motion(requests.all, requests.unit))

    def speed_curve(self) -> SpeedCurve | None:
        """How the speed varies; None if it does not, or its file is not valid."""
        key = ("cam", "speed_curve")
        if self.values.get(*key) is None:
            return None
        data = self.converter.read(key)
        if data is None:
            return None
        if self._unchanged("cam"):
            curve: SpeedCurve | None = self._earlier["speed_curve"]
            return curve
        from camgeo.kinematics.time_course import SpeedCurve  # few scenes have one

        name: str = self.values.get(*key)
        return self._engine(key, lambda: SpeedCurve.read(data, name))

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
        kind = FOLLOWERS[self.values.get("follower", "kind")]
        mount: Mount = kind.mount(self._table("follower", "return"))
        return mount

    def returning(self, mount: Mount, follower: Follower) -> Follower | None:
        """The return roller of a conjugate pair; None if it cannot work."""
        return self._engine(("follower",), lambda: mount.roller(follower))

    def _yoke(self) -> Yoke | None:
        if self.values.get("follower", "yoke") is None:
            return None

        return Yoke(**self.converter.table(("follower", "yoke"), definition("yoke")))

    def linkage(self) -> Linkage | None:
        """The linkage; None if there is none, or it cannot work.

        Of a slider-crank the follower's kind decides which member makes the demanded motion.
        """
        if self.values.get("linkage") is None:
            return None
        kind = LINKAGES[self.values.get("linkage", "kind")]
        table, unit = self._table("linkage"), self.values.lift_unit
        if unit not in kind.members:
            return None  # which is reported
        earlier = self._earlier
        if self._unchanged("linkage") and linkage_far_end(earlier["stated"]) == linkage_far_end(
            self.values
        ):
            linkage: Linkage = earlier["linkage"]
            return linkage
        return self._engine(("linkage",), lambda: kind.build(table, unit))

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
        # The sense of the follower at the farthest end of the motion, position alone: the three
        # derivatives of the jet are 0.
        jet = np.array([[farthest], [0.0], [0.0], [0.0]])
        swing = float(linkage.transform(jet)[0, 0])
        if swing * farthest * arm_side * SIGNS[stated] < 0.0:
            direction = "inward" if stated == "outward" else "outward"
            self.converter.fault(
                ("follower", "direction"),
                f"contradicts the linkage, which moves the {follower.touching} {direction}",
                f'leave it out, write "{direction}", or turn one of the linkage\'s choices',
            )

    def effects(self, faulted: Collection[str] = ()) -> dict[str, dict[str, Any]]:
        """The tables of the effects that the scene names, in internal units.

        No further faults are reported for those whose keys are among `faulted`.
        """
        if not self.values.has("effects"):
            return {}
        from camgeo.scene.effects import effect_tables  # few scenes name an effect

        return effect_tables(self.converter, faulted)

    def rest(self, speed_curve: SpeedCurve | None, effects: Attributes) -> dict[str, Any]:
        """The remaining attributes of a scene all of whose values are valid; an attribute is None,
        with a fault, if its numbers are too large or too small to compute with.
        """
        get = self.values.get
        speed = get("cam", "speed")
        if speed_curve is not None:
            # The mean speed, from the duration of one turn; in rev/min like `cam.speed`.
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
            "limits": self.reuse("limits", Builder._limits),
            "part": self.reuse("part", lambda own: own.part(effects)),
            "model": get("state", "motion"),
            "contour": get("state", "contour"),
            "flank": get("state", "flank"),
            "train": get("state", "output") or "elastic",
            "state_speed": get("state", "speed"),
            "printing": self.reuse("printing", Builder._printing),
            "drawing": self.reuse("drawing", Builder._drawing),
        }

    def _limits(self) -> Limits | None:
        return self._engine(("limits",), lambda: Limits(**self._top("limits")))

    def _drawing(self) -> DrawingSpec | None:
        return self._engine(
            ("drawing",), lambda: instance_from_table(DrawingSpec, self._top("drawing"))
        )

    def part(self, effects: Attributes) -> PartSpec | None:
        """The part; the `effects` are those that the scene names."""
        self.values.raw(EFFECTS_KEY)  # records that `effects` are read, see `kept`
        if not self.values.has("part"):
            return None
        top, name = self._top("part"), self.values.get("name")

        def build() -> PartSpec:
            spec = PartSpec.from_table(top, name)
            if WEIGHING not in effects:
                return spec
            from camgeo.scene.effects import with_density  # few scenes name an effect

            return with_density(spec, effects[WEIGHING], self.converter)

        return self._engine(("part",), build)

    def _printing(self) -> PrintSpec | None:
        if self.values.get("print") is None:
            return None

        from camgeo.part.compensation import PrintSpec  # few scenes print

        return self._engine(("print",), lambda: instance_from_table(PrintSpec, self._top("print")))

    def output(self) -> OutputSpec:
        """The options of the output; the defaults for what is not stated or not valid."""
        tables = self._top("output")
        options: dict[str, Any] = {}
        for form in self._schema.formats:
            table = tables.pop(form.name, None)
            if table is not None and None not in table.values():  # a file that cannot be read
                place = ("output", form.name)
                options[form.name] = self._engine(place, partial(form.parse, table))
        ripple = tables.pop("accuracy", {}).get("ripple", False)
        return OutputSpec(options=Options(options), accuracy_ripple=ripple, **tables)

    def milling(self, output: OutputSpec, faulted: Collection[str] = ()) -> MillingSpec | None:
        """What the scene says on milling; None if it says nothing, or nothing valid.

        No further faults are reported if one of its keys is among those `faulted`. `output` is that
        of the scene.
        """
        self.values.raw(OUTPUT)  # records that `output` is read, see `kept`
        named = any(self.values.has(name) for name in MILLING)
        if not (named or "gcode" in output.options.by_format):
            return None
        if any((parse_path(key) or ("",))[0] in MILLING for key in faulted):
            return None
        from camgeo.scene.milling import MillingBuilder  # few scenes mill

        return MillingBuilder(self.converter).spec(output.options.by_format.get("gcode"))

    def _top(self, name: str) -> dict[str, Any]:
        """One of the scene's tables in internal units; empty if it is missing or not valid."""
        if self.values.get(name) is None:
            return {}
        return self.converter.table((name,), self._schema.root["properties"][name])

    def _engine(self, table: KeyPath, make: Callable[[], Built]) -> Built | None:
        """The object that `make` builds; None, with a fault at the key of the `table`, if it raises
        GeometryError.
        """
        try:
            return make()
        except GeometryError as error:
            path = parse_path(error.key) or ()
            if path[: len(table)] != table:  # the engine names keys relative to their table
                path = table + path
            self.converter.fault(path, error.message)
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

    def __init__(self, converter: SceneConverter) -> None:
        values = converter.values
        self.converter = converter
        self.values = values
        self.all: list[Request] = []
        self._scale = math.radians(1.0) if values.angular else values.mm
        self.unit = PositionUnit("deg" if values.angular else values.unit, self._scale)
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
        end_position = self._scale * table["to"]
        if table["law"] == "points":
            return self._points(place, table, span, end_position, end)
        inflection = table.get(INFLECTION)
        balance = inflection.removeprefix(EQUAL) if isinstance(inflection, str) else ""
        return MoveRequest(
            span=span,
            to=end_position,
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
        end_position: float,
        end: dict[str, float | None],
    ) -> PointsRequest | None:
        shares: list[float] = []
        last = Decimal(0)
        for index in range(len(table["points"])):
            angle = self.values.exact(*place, "points", index, "at")
            assert angle is not None  # the scene is valid
            if not last < angle < span:
                self.converter.fault(
                    (*place, "points", index, "at"),
                    f"must ascend and be less than the span of {span.normalize():f} degrees",
                )
                return None
            shares.append(float(angle / span))
            last = angle
        boundaries = {
            index: (self._scaled(point.get("velocity")), self._scaled(point.get("acceleration")))
            for index, point in enumerate(table["points"])
        }
        return PointsRequest(
            span=span,
            to=end_position,
            shares=np.array(shares),
            positions=np.array([self._scale * point["to"] for point in table["points"]]),
            boundaries={
                index: boundary for index, boundary in boundaries.items() if boundary != FREE
            },
            **end,
        )

    def _table(self, place: KeyPath, table: dict[str, Any], span: Decimal) -> TableRequest | None:
        from camgeo.kinematics.tables import TwoColumns  # few scenes have one

        key = (*place, "file")
        data = self.converter.read(key)
        if data is None:
            return None
        try:
            rows = TwoColumns.of_lifts(data, table["file"], float(span), periodic=span == FULL_TURN)
        except GeometryError as error:
            self.converter.fault(key, error.message)
            return None
        wanted = "deg" if self.values.angular else self.values.unit
        if rows.unit and rows.unit.lower() not in UNITS[wanted]:
            self.converter.fault(
                key, f"states the lift in {rows.unit}; the scene expects it in {wanted}"
            )
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


# -- identity -------------------------------------------------------------------------------------
# The identity of a scene: SHA-256 of all its values, however they are written.
#
# The values are brought into one form: keys in alphabetical order, numbers exactly, as digits and
# an exponent, defaults of the schema filled in (but for keys that came later: the hashes of scenes
# of before must not change), and the name of a file replaced by the SHA-256 of its content. Only
# zero keeps its sign, which can decide on which side an angle lies.
#
# Files of earlier versions name the hash of the scene's text instead, without the tables of
# effects, which change no file. Such files are still verified.


FORM: Final = "camgeo scene 1"
"""Version of the canonical text that is hashed; a change of it changes all hashes."""

REPORTED_ONLY: Final = (
    ("effects",),
    ("state",),
    ("output", "accuracy"),
    ("part", "material"),
    ("part", "density"),
    ("sweep",),
    ("optimise",),
    ("tolerance",),
)
"""Tables and keys that affect only what is computed and reported, not drawings, programs or bodies.

An effect adds its columns to a value table; so that a scene's other files stay the same to the last
byte with and without it, the hash in them does not depend on it either.
"""

Digests = Callable[[str], str]
"""Function from the name of a file, as in the scene, to the SHA-256 of its content, hexadecimal."""


def scene_identity(tree: Tree, digests: Digests) -> str:
    """SHA-256 of all that a scene states, hexadecimal."""
    return _hash("all", tree, digests)


def output_hash(tree: Tree, digests: Digests) -> str:
    """SHA-256 of all that decides the bytes of the files made from it, hexadecimal."""
    for path in REPORTED_ONLY:
        tree = without(tree, path)
    return _hash("made", tree, digests)


def _hash(what: str, tree: Tree, digests: Digests) -> str:
    text = _Canonical(tree, digests).text(tree, schema_of_all(tree))
    return hashlib.sha256(f"{FORM}, {what}: {text}".encode()).hexdigest()


def schema_of_all(values: Mapping[str, Any]) -> Node:
    """Return the schema for these values with the tables of all formats of camgeo."""
    output = values.get(OUTPUT)
    table = output if isinstance(output, dict) else {}
    listed = table.get("formats")
    words = [*FORMATS, *(listed if isinstance(listed, list) else ())]
    return schema_for({**values, OUTPUT: {**table, "formats": words}}).root


class _Canonical:
    """Writes values as text that differs for different values."""

    def __init__(self, tree: Tree, digests: Digests) -> None:
        self._tree = tree
        self._digests = digests

    def text(self, value: Any, node: Node) -> str:
        """The value, at which the schema has `node`."""
        node = resolved(node)
        if isinstance(value, dict):
            keys = table_keys(node, value)
            filled = {**self._defaults(keys, value), **value}
            texts = {name: self.text(filled[name], keys.get(name, {})) for name in sorted(filled)}
            pairs = [f"{json.dumps(name)}:{text}" for name, text in texts.items()
                     if not self._is_silent(text, keys.get(name, {}))]  # fmt: skip
            return f"{{{','.join(pairs)}}}"
        if isinstance(value, list):
            return f"[{','.join(self.text(item, node.get('items', {})) for item in value)}]"
        if isinstance(value, bool):
            return "true" if value else "false"
        if isinstance(value, int | float | Decimal):
            return _number(value)
        if _names_a_file(node, value):
            return f"<{self._digests(value)}>"
        return json.dumps(value)

    def _is_silent(self, text: str, node: Node) -> bool:
        """Whether a key that was added after `FORM` has its default, the meaning of its absence: it
        is left out, so that the hashes of older scenes stay as they are.
        """
        node = resolved(node)
        return "x-added" in node and text == self.text(node["default"], node)

    def _defaults(self, keys: Mapping[str, Node], table: Tree) -> Tree:
        """The defaults of keys that the table lacks, where the default is a value."""
        values = {name: self._default(resolved(keys[name]), table) for name in keys.keys() - table}
        return {name: value for name, value in values.items() if value is not None}

    def _default(self, node: Node, table: Tree) -> Any:
        if "x-default-mm" in node:  # no number of inches is the same to the last digit
            inches = tree_value(self._tree, ("units", "length")) == "inch"
            return None if inches else node["x-default-mm"]
        if "x-default-by-law" in node:
            return node["x-default-by-law"].get(table.get("law"))
        main = tree_value(self._tree, parse_path(node.get("x-default-key", "")) or ("",))
        return node.get("default") if main is None else main


def _names_a_file(node: Node, value: str) -> bool:
    """Whether the value at a resolved node is the name of a file in the scene's folder."""
    return ("x-file" in node or "x-path" in node) and value not in node.get("x-values", ())


def _number(value: float | Decimal) -> str:
    """Significant digits without zeros at either end, and an exponent: 40, 40.0 and 4e1 are 4e1."""
    number = Decimal(repr(value)) if isinstance(value, float) else Decimal(value)
    sign, digits, exponent = number.as_tuple()
    text = "".join(map(str, digits)).lstrip("0")
    significant = text.rstrip("0")
    assert isinstance(exponent, int)  # a scene has finite numbers only
    # Each trailing zero that is cut off raises the exponent by one; 0 has the exponent 0.
    return (
        f"{'-' if sign else ''}{significant or 0}"
        f"e{exponent + len(text) - len(significant) if significant else 0}"
    )


def scene_file_hashes(path: Path, known: Mapping[str, str]) -> Iterator[str]:
    """The hashes by which files may name the scene file at `path`: of its text, and of its values.

    Nothing if it is not TOML; OSError, or ValueError, if it, or a file that it names, cannot be
    read or is larger than allowed. Files whose SHA-256 is `known`, by name, are not read again.
    """

    def digest(name: str) -> str:
        return (
            known.get(name) or hashlib.sha256(read_limited(path.parent / name, TABLE)).hexdigest()
        )

    data = read_limited(path, SCENE)
    try:
        scene = document(data)
    except SceneError:
        return
    yield scene_text_hash(data, scene)
    if not scene.faults:
        yield output_hash(scene.exact, digest)


def scene_text_hash(data: bytes, scene: Document) -> str:
    """SHA-256 of the bytes of a scene file without its effects, hexadecimal.

    `scene` is the parsed file.
    """
    return hashlib.sha256(without_effects(data, scene)).hexdigest()


def without_effects(data: bytes, scene: Document) -> bytes:
    """The bytes of a scene without the lines of what is under ``[effects]``.

    With these go the comments directly above and the empty lines below, or at the end of the file
    the empty lines above. A scene without effects is left as it is, and so is one in which
    these lines cannot be identified.
    """
    if EFFECTS_KEY not in scene.exact or not any(path[0] == EFFECTS_KEY for path in scene.lines):
        return data
    lines = data.splitlines(keepends=True)
    starts = sorted({line - 1 for line in scene.lines.values()})
    effect_lines = {line - 1 for path, line in scene.lines.items() if path[0] == EFFECTS_KEY}
    keeps = [True] * len(lines)
    for number, start in enumerate(starts):
        if start not in effect_lines:
            continue
        end = starts[number + 1] if number + 1 < len(starts) else len(lines)
        last = max((k for k in range(start, end) if not _idle(lines[k])), default=start)
        block_end = last + 1
        while block_end < end and not lines[block_end].strip():
            block_end += 1
        block_start = start
        while block_start and lines[block_start - 1].lstrip().startswith(b"#"):
            block_start -= 1
        for k in range(block_start, block_end):
            keeps[k] = False
    # Where the effects ended the file, the empty lines that separated them from the rest go as
    # well.
    if effect_lines and lines and not keeps[-1]:
        k = len(lines) - 1
        while k >= 0 and (not keeps[k] or not lines[k].strip()):
            keeps[k] = False
            k -= 1
    return b"".join(line for line, keep in zip(lines, keeps, strict=True) if keep)


def _idle(line: bytes) -> bool:
    """Whether a line is empty or a comment."""
    text = line.strip()
    return not text or text.startswith(b"#")


# -- load -----------------------------------------------------------------------------------------
# Reading a scene file: all its faults are reported at once.


def load_scene(path: str | PathLike[str]) -> Scene:
    """Read the scene file at `path`.

    Raises
    ------
    SceneError
        If the file cannot be read or anything in it is wrong; it lists all faults.
    """
    return Scene.from_text(read_file(path, SCENE.size), str(path))


def read_file(path: str | PathLike[str], most: int) -> bytes:
    """The bytes of the file at `path`, one more than `most` if it has more.

    Raises
    ------
    SceneError
        If it cannot be read.
    """
    try:
        if Path(path).is_dir():
            raise IsADirectoryError(errno.EISDIR, "it is a folder")
        with Path(path).open("rb") as stream:
            return stream.read(most + 1)
    except FileNotFoundError as error:
        raise SceneError([Fault("", "", "there is no such file")], str(path)) from error
    except (OSError, ValueError) as error:
        fault = Fault("", "", f"the file cannot be read: {unreadable(error)}")
        raise SceneError([fault], str(path)) from error


def parse_scene(text: str, file: str = "", folder: str | Path | None = None) -> Scene:
    """Read a scene from its TOML; `file` is the path it came from, for messages.

    `folder` holds the files that the scene names, if it is not that of `file`. Raises SceneError
    as `load_scene` does.
    """
    try:
        data = encode_scene(text)
    except SceneError as error:
        raise SceneError(error.faults, file) from error
    return Scene.from_text(data, file, folder)
