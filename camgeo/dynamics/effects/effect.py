"""What an effect is, which machines it is for, what it receives and what it returns.

Internal units are mm, s, t (1000 kg) and N, with the derived units N mm, MPa = N/mm^2 and, for
moments of inertia, t mm^2. They are consistent, so formulas need no conversion factors.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from inspect import signature
from typing import TYPE_CHECKING, Any, Final, Generic, Literal, TypeVar

import numpy as np

from camgeo.check.finding import Finding
from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.values import MEMBER_UNITS, Member, Touching
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.record import Displayed

if TYPE_CHECKING:  # each effect imports the modules that it computes with
    from camgeo.cam.cam import Cam, Drive
    from camgeo.dynamics.state.state import Model, Train, Used
    from camgeo.dynamics.state.written import Contours, HasPart, State, Writing
    from camgeo.kinematics.mechanism.linkages import SliderCrank
    from camgeo.kinematics.time_course import TimeCourse
    from camgeo.part.spec import PartSpec
    from camgeo.units import LengthUnit, LiftUnit

Quantity = Callable[[FloatArray, Side], FloatArray]
"""(n,) values at n cam angles [rad], approached from the given side."""


@dataclass(frozen=True)
class Subject:
    """The design that effects are computed for.

    Attributes
    ----------
    drive : what moves the follower.
    lift_unit : of the follower's own motion.
    unit : unit of length of the scene, for messages; values are in mm.
    part_spec : what the scene says of the part.
    model : whose motion the effects are computed for, where that makes a difference (`state`).
    output : whether the forces are those of the elastic train, where the scene has one.
    disc : the disc of the cam; None if there is no follower.
    returning : the return disc of a conjugate pair, or the disc at the second side of a yoke, with
        the same motion; None without one.
    contours : those whose motion is meant by the model "written"; None for another model.
    course : how the cam turns, if not as `drive` says.
    """

    drive: Drive
    lift_unit: LiftUnit
    unit: LengthUnit
    part_spec: PartSpec | None
    model: Model = "demanded"
    output: Train = "elastic"
    disc: HasPart | None = field(default=None, repr=False, compare=False)
    returning: Subject | None = None
    contours: Contours | None = None
    course: TimeCourse | None = None

    @cached_property
    def state(self) -> State:
        """The motion that the effects are computed for.

        That of the outline, if that is the `model`, follows from the disc where a single flank is
        trimmed. Otherwise it is the demanded motion: where the flank is whole, where there is no
        disc, where the lift jumps, and where the far end of a linkage cannot follow. So it is, too,
        for a follower that is held both ways, in a groove, between two discs or by a yoke.
        """
        if self.contours is not None:
            return self.contours.written_state(self.cam)
        from camgeo.dynamics.state.state import Demanded

        cam, course = None if self.disc is None else self.disc.cam, self.drive.time_course
        demanded = Demanded(self.drive, cam, course)
        if cam is None or self.model == "demanded" or self.returning is not None:
            return demanded
        if cam.contact.closed_by_form or cam.yoke is not None:
            return demanded
        flank = cam.contact.main
        try:
            if not cam.disc.outline(flank).is_trimmed:
                return demanded
            replay = cam.disc.replay(flank)
        except GeometryError:  # the checks report it
            return demanded
        # Where the lift itself jumps there is no velocity to compute with.
        if len(replay.drops):
            return demanded
        from camgeo.dynamics.state.written import OutlineState  # few discs are trimmed

        outline_state = OutlineState(cam, replay, course)
        return outline_state if outline_state.is_followed else demanded

    def with_written_contours(self, writing: Writing, sense: int) -> Subject:
        """The same design with the motion of its contours as they are written; on the side `sense`
        if the follower is held both ways.
        """
        from camgeo.dynamics.state.written import Contours  # only if it is asked for

        other = self.returning
        discs = (self.disc, None if other is None else other.disc)
        contours = Contours(tuple(disc for disc in discs if disc is not None), writing, sense)
        if other is not None:
            other = replace(other, model="written", contours=contours)
        return replace(self, model="written", contours=contours, returning=other)

    def turning(self, course: TimeCourse) -> Subject:
        """The same design with the cam turning as `course` says."""
        other = None if self.returning is None else self.returning.turning(course)
        turned = replace(self, returning=other, course=course)
        vars(turned)["state"] = self.state.turning(course)  # the same motion, which may be dear
        return turned

    @property
    def required_disc(self) -> HasPart:
        """The disc as it is made; GeometryError with key "follower" if there is no follower."""
        if self.disc is None:
            raise GeometryError("needs [follower]", key="follower")
        return self.disc

    @property
    def cam(self) -> Cam:
        """The cam; GeometryError with key "follower" if there is no follower."""
        return self.required_disc.cam

    @property
    def paired(self) -> bool:
        """Whether `returning` is a second disc."""
        return self.returning is not None and self.cam.yoke is None


def driving_slider(subject: Subject) -> SliderCrank | None:
    """The linkage if its slider makes the demanded motion, else None."""
    from camgeo.kinematics.mechanism.linkages import SliderCrank

    linkage = subject.drive.linkage
    return linkage if isinstance(linkage, SliderCrank) else None


Answer = TypeVar("Answer")
Answer_co = TypeVar("Answer_co", covariant=True)


class Key(str, Generic[Answer_co]):
    """The name of an effect, and the type of its result."""

    __slots__ = ()


class Results:
    """The results that an effect receives: those it needs, and those it uses if they are named."""

    def __init__(self, by_name: Mapping[str, Any]) -> None:
        self._by_name = by_name

    def __getitem__(self, key: Key[Answer]) -> Answer:
        result: Answer = self._by_name[key]
        return result

    def get(self, key: Key[Answer]) -> Answer | None:
        """The result of the effect `key`; None if it is optional and not in the scene."""
        return self._by_name.get(key)


TOLERANCE: Final = 1e-6
"""Default for numerical effects, relative to the largest magnitude of the result."""


Data = TypeVar("Data")


@dataclass(frozen=True, slots=True)
class Request(Generic[Data]):
    """The input of an effect; `Data` is what its `parse` returns.

    Attributes
    ----------
    subject : the design.
    data : what `Effect.parse` makes of the table ``[effects.NAME]``, or of an empty table if the
        effect is computed only because another one needs it.
    results : by key, of the effects that it needs, and of those it uses if the scene names them.
    tolerance : largest permitted error of each figure, relative to the scale of its `Bound`; only
        numerical effects use it.
    near : what the effect has found for almost the same input, for which a search may look beside
        it; None if nothing is known.
    """

    subject: Subject
    data: Data
    results: Results
    tolerance: float
    near: Any = None

    @property
    def course(self) -> TimeCourse:
        """How the cam turns, for effects that declare the speed among their keys.

        Raises GeometryError with the key if the scene gives no speed. This happens only if the
        effect is requested by another effect or by a caller: a scene that names it has a speed.
        """
        course = self.subject.state.course
        if course is None:
            raise GeometryError("is missing: the speed of the cam is needed", key="cam.speed")
        return course


@dataclass(frozen=True, slots=True, eq=False)
class Column:
    """A quantity over the cam angle, for tables and pictures.

    Attributes
    ----------
    name : e.g. "contact force".
    unit : of the values: "N", "N m", "MPa", "mm", "mm/s", "deg", "" ... Lengths are in mm here and
        are shown in the unit of the scene.
    values : the quantity in `unit`.
    limit : drawn as a line, in `unit`; None for no limit.
    borders : (k,) cam angles [rad] in [0, 2 pi) where the quantity may jump, besides the borders of
        the motion.
    """

    name: str
    unit: str
    values: Quantity
    limit: float | None = None
    borders: FloatArray = field(default_factory=lambda: np.empty(0))


def scaled(values: Quantity, factor: float) -> Quantity:
    """`factor` times the `values`."""
    return lambda phi, side: factor * values(phi, side)


@dataclass(frozen=True, slots=True)
class DataFile:
    """A file that the scene names in the table of an effect.

    Attributes
    ----------
    name : as written in the scene.
    data : its bytes, up to one more than the size of a `camgeo.reading.TABLE`.
    """

    name: str
    data: bytes = field(repr=False)


@dataclass(frozen=True, slots=True)
class Bound:
    """How far a figure may be off.

    Attributes
    ----------
    error : estimated largest error, in the unit of the figure.
    scale : magnitude that the tolerance refers to, in the same unit; 0 if there is none.
    """

    error: float
    scale: float

    @property
    def share(self) -> float:
        """The error relative to the scale."""
        return self.error / self.scale if self.scale > 0.0 else 0.0

    def times(self, factor: float) -> Bound:
        """The bound of `factor` times the figure."""
        return Bound(abs(factor) * self.error, abs(factor) * self.scale)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Result(Displayed):
    """The result of an effect; subclasses add what the effect offers to others.

    Attributes
    ----------
    findings : all values found, good and bad; from `camgeo.dynamics.effects.graph` with those that
    say what
        the others do not hold for.
    columns : the quantities over the cam angle.
    errors : by the names of findings and columns; figures without an entry are exact to rounding.
    state : for which the graph of effects had it computed; None outside of it.
    """

    findings: Sequence[Finding] = ()
    columns: tuple[Column, ...] = ()
    errors: Mapping[str, Bound] = field(default_factory=dict)
    state: Used | None = None

    @property
    def error(self) -> float | None:
        """The largest of the errors, each relative to its scale; None if all is exact."""
        return max((bound.share for bound in self.errors.values()), default=None)


# -- rules ----------------------------------------------------------------------------------------
# Which machines an effect, or keys of its table, can be used with.
#
# A rule checks the table of one effect against the machine before anything is computed. Most rules
# are data, `Only`, from which the descriptions in the schema of the scene are generated too.


@dataclass(frozen=True, slots=True)
class MachineTraits:
    """The properties of a machine that rules depend on.

    Attributes
    ----------
    lift : unit of the follower's lift, "mm" in a guide, "rad" for a rocker; None if unknown.
    touching : what touches the cam, "roller" or "face"; None if unknown.
    edged : whether it is a knife edge.
    far : the far end of its linkage, empty if there is no linkage; None if unknown.
    paired : whether a return disc holds the follower back.
    yoked : whether the follower has a second contact beyond the cam axis.
    """

    lift: LiftUnit | None
    touching: Touching | None
    edged: bool = False
    far: Member | Literal[""] | None = ""
    paired: bool = False
    yoked: bool = False

    @property
    def demanded(self) -> LiftUnit | None:
        """Unit of the demanded motion; None if unknown."""
        return MEMBER_UNITS[self.far] if self.far else None if self.far is None else self.lift

    @property
    def straight(self) -> bool | None:
        """Whether it has a guided follower or a slider; None if unknown."""
        units = (self.lift, self.demanded)
        return True if "mm" in units else None if None in units else False


@dataclass(frozen=True, slots=True)
class EffectTable:
    """The table of an effect in a scene.

    Attributes
    ----------
    values : by key; None where the value is known to be wrong.
    meant : missing keys that a misspelt key was probably meant to be.
    """

    values: Mapping[str, Any]
    meant: Collection[str] = field(default=())

    def lacks(self, key: str) -> bool:
        """Whether the key is missing, and no misspelt key was meant to be it."""
        return key not in self.values and key not in self.meant


Rule = Callable[[MachineTraits, EffectTable], Iterator[tuple[str, str]]]
"""Yields the keys of the table at fault, empty for the effect as a whole, with the reason."""


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of machine.

    Attributes
    ----------
    attribute : the attribute of `MachineTraits` that distinguishes it.
    others : values of this attribute that certainly mean another kind.
    message : the message for a scene with another kind of machine.
    description : the same, as a sentence for the schema.
    barring : key of [follower] in the scene that makes it another kind; empty if there is none.
    """

    attribute: str
    others: tuple[str | bool, ...]
    message: str
    description: str
    barring: str = ""


@dataclass(frozen=True, slots=True, init=False)
class Only:
    """The effect, or the named keys of its table, apply to one kind of machine only."""

    kind: Kind
    keys: tuple[str, ...]

    def __init__(self, kind: Kind, *keys: str) -> None:
        object.__setattr__(self, "kind", kind)
        object.__setattr__(self, "keys", keys)

    def __call__(self, machine: MachineTraits, table: EffectTable) -> Iterator[tuple[str, str]]:
        """See `Rule`."""
        if getattr(machine, self.kind.attribute) in self.kind.others:
            for key in self.keys or ("",):
                if not key or key in table.values:
                    yield key, self.kind.message


# -- effect ---------------------------------------------------------------------------------------
# The declaration of an effect.


Premise = Literal["contact", "motion", "disc"]
"""What must be true for the figures of an effect: that the follower touches the cam all round and
makes the motion of the `Subject.state`; that it makes this motion; or nothing but the disc itself.
"""


@dataclass(frozen=True, slots=True)
class Refinement:
    """Another effect that, in the same scene, computes what this one takes as simpler than it is.

    Attributes
    ----------
    effect : name of the other effect.
    assumption : what the figures of this effect hold for, as in "a rigid follower".
    caution : what differs, where one can tell, e.g. "an elastic one leaves the cam earlier".
    followed : whether this effect takes it into account unless the scene states a simpler state.
    """

    effect: str
    assumption: str
    caution: str = ""
    followed: bool = False


SPEED: Final = ("cam.speed", "cam.speed_curve")
"""Keys of the scene, one of which gives the speed of the cam."""


@dataclass(frozen=True, slots=True, eq=False)
class Effect:
    """The declaration of an effect: all that is known about it without computing it.

    Attributes
    ----------
    name : its table in the scene is ``[effects.NAME]``.
    title : what it computes, in a few words.
    compute : "module:function" that makes the result from a `Request`, imported when it is first
        needed. It raises GeometryError with the key of the scene if data are missing or
        contradictory, `EffectError` if there is no answer for this design.
    schema : JSON Schema of its table, an object. It may refer to the definitions of the scene's
        schema, as {"$ref": "#/$defs/length"}; a number with an "x-unit" is given in that unit.
    parse : checks the table and converts it to `Request.data`, a frozen dataclass; a table that
        needs no more checks than its schema is the data itself. Numbers of the table are in the
        units of this module, angles in radians, files are `DataFile`. It raises GeometryError with
        the key in the table, e.g. "preload", if data are missing or contradictory.
    rules : which machines the effect, or keys of its table, cannot be combined with.
    needs : effects whose results are required.
    uses : effects whose results are taken into account if the scene names them.
    keys : data of the scene that are required: at least one key of each entry, e.g. ("cam.speed",
        "cam.speed_curve") or ("effects.inertia",).
    tabled : whether the scene must have its table; if not, it is computed with an empty table for
        other effects that need it.
    numerical : whether it takes a tolerance and estimates its error.
    of_drive : whether it needs no follower, only the drive.
    premise : what its figures rely on.
    of_plan : whether its figures are of the segments of the demanded motion, whatever motion the
        disc makes.
    regardless : names of its findings that hold even where the premise does not.
    refined_by : effects that have a better model, if the scene names them too.
    """

    name: str
    title: str
    compute: str
    schema: Mapping[str, Any]
    parse: Callable[[Mapping[str, Any]], Any] = dict
    rules: tuple[Rule, ...] = ()
    needs: tuple[str, ...] = ()
    uses: tuple[str, ...] = ()
    keys: tuple[tuple[str, ...], ...] = ()
    tabled: bool = False
    numerical: bool = False
    of_drive: bool = False
    premise: Premise = "contact"
    of_plan: bool = False
    regardless: tuple[str, ...] = ()
    refined_by: tuple[Refinement, ...] = ()


def build_data(kind: Callable[..., Data], table: Mapping[str, Any]) -> Data:
    """The dataclass `kind` with the values of `table`; missing keys keep their defaults.

    Keys that are not its fields are ignored, such as the tolerance, which is in `Request`.
    """
    return kind(**{key: table[key] for key in signature(kind).parameters if key in table})
