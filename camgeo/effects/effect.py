"""What an effect is, what it is given, and what it answers.

Units inside are mm, s, t (1000 kg), N, and what follows from them: N mm, MPa = N/mm^2, and t mm^2
for moments of inertia, so that no factor stands in any formula.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from inspect import signature
from typing import TYPE_CHECKING, Any, Final, Generic, Protocol, TypeVar

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.rules import Machine, Rule
from camgeo.errors import GeometryError
from camgeo.motion.motion import Side
from camgeo.numeric.arrays import FloatArray

if TYPE_CHECKING:  # an effect imports what it computes with itself
    from camgeo.cam.cam import Cam
    from camgeo.cam.drive import Drive, LiftUnit
    from camgeo.mechanism.slider_crank import SliderCrank
    from camgeo.motion.time_course import TimeCourse
    from camgeo.part.part import Part
    from camgeo.part.spec import PartSpec
    from camgeo.units import LengthUnit

GROUP: Final = "camgeo.effects"
"""Entry points of effects that come with other distributions; the name is the effect's."""

Quantity = Callable[[FloatArray, Side], FloatArray]
"""(n,) values at n cam angles [rad], from the side asked for."""


class HasPart(Protocol):
    """A disc, which makes its part when it is asked for."""

    @property
    def cam(self) -> Cam: ...

    @property
    def part(self) -> Part: ...


@dataclass(frozen=True, slots=True)
class Subject:
    """What effects are computed of.

    Attributes
    ----------
    drive : what moves the follower.
    lift_unit : of the follower's own motion.
    unit : of length of the scene, for sentences; values are in mm.
    part_spec : what the scene says of the part.
    disc : of the cam; None if there is no follower.
    returning : the return disc of a conjugate pair, of the same motion; None if there is none.
    """

    drive: Drive
    lift_unit: LiftUnit
    unit: LengthUnit
    part_spec: PartSpec | None
    disc: HasPart | None = field(default=None, repr=False, compare=False)
    returning: Subject | None = None

    @property
    def made(self) -> HasPart:
        """The disc, which gives the part; GeometryError with key "follower" if there is none."""
        if self.disc is None:
            raise GeometryError("needs [follower]", key="follower")
        return self.disc

    @property
    def cam(self) -> Cam:
        """The cam; GeometryError with key "follower" if there is none."""
        return self.made.cam


def driving_slider(subject: Subject) -> SliderCrank | None:
    """The linkage whose slider makes the demanded motion; None without one, or with another."""
    from camgeo.mechanism.slider_crank import SliderCrank

    linkage = subject.drive.linkage
    return linkage if isinstance(linkage, SliderCrank) else None


def machine_of(subject: Subject) -> Machine:
    """The machine as the rules of effects see it."""
    follower, linkage = subject.cam.follower, subject.drive.linkage
    return Machine(
        lift=follower.lift_unit,
        touching=follower.touching,
        edged=follower.has_edge,
        far="" if linkage is None else linkage.member,
        paired=subject.returning is not None,
        yoked=subject.cam.yoke is not None,
    )


Answer = TypeVar("Answer")
Answer_co = TypeVar("Answer_co", covariant=True)


class Key(str, Generic[Answer_co]):
    """The name of an effect, and the type of its result."""

    __slots__ = ()


class Results:
    """The results that an effect is given: of what it needs, and of what it uses that is named."""

    def __init__(self, by_name: Mapping[str, Any]) -> None:
        self._by_name = by_name

    def __getitem__(self, key: Key[Answer]) -> Answer:
        found: Answer = self._by_name[key]
        return found

    def get(self, key: Key[Answer]) -> Answer | None:
        """The result of the effect `key`; None if it is only used, and the scene names none."""
        return self._by_name.get(key)


Spec = TypeVar("Spec")


@dataclass(frozen=True, slots=True)
class Request(Generic[Spec]):
    """What an effect is given; `Spec` is what its `parse` makes.

    Attributes
    ----------
    subject : the design.
    spec : what `Effect.parse` makes of the scene's table ``[effects.NAME]``; of an empty table if
        the effect is computed for another one that needs it.
    results : of the effects that it needs, and of those it uses that the scene names, by key.
    tolerance : largest error that is allowed, as a share of the largest magnitude of what the
        effect gives; only numerical effects look at it.
    """

    subject: Subject
    spec: Spec
    results: Results
    tolerance: float

    @property
    def course(self) -> TimeCourse:
        """How the cam turns; for effects that declare a speed among their keys.

        Raises GeometryError with the key if the scene gives none and names no such effect, which
        is then asked for by another one or from outside.
        """
        course = self.subject.drive.time_course
        if course is None:
            raise GeometryError("is missing: the speed of the cam is needed", key="cam.speed")
        return course


@dataclass(frozen=True, slots=True)
class Column:
    """A quantity over the cam angle, for tables and pictures.

    Attributes
    ----------
    name : e.g. "contact force".
    unit : of the values: "N", "N m", "MPa", "mm", "mm/s", "deg", "" ... Lengths are in mm here and
        shown in the unit of the scene.
    values : the quantity in `unit`.
    limit : to be drawn as a line, in `unit`; None if there is none.
    borders : (k,) cam angles [rad] in [0, 2 pi), besides the borders of the motion, where it may
        jump.
    """

    name: str
    unit: str
    values: Quantity
    limit: float | None = None
    borders: FloatArray = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True, slots=True)
class DataFile:
    """A file that the scene names in the table of an effect.

    Attributes
    ----------
    name : as the scene has it.
    data : its bytes, up to one more than `camgeo.motion.two_columns.MOST_BYTES`.
    """

    name: str
    data: bytes = field(repr=False)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Result:
    """What an effect answers; what else it offers to others is its own, in a class made of this.

    Attributes
    ----------
    findings : its values, the good with the bad.
    columns : what it is over the cam angle.
    error : estimate of the largest error, as a share of the largest magnitude of what it gives;
        None if it is exact but for rounding.
    """

    findings: tuple[Finding, ...] = ()
    columns: tuple[Column, ...] = ()
    error: float | None = None


SPEED: Final = ("cam.speed", "cam.speed_curve")
"""Keys of a scene of which one gives the speed of the cam."""


@dataclass(frozen=True, slots=True, eq=False)
class Effect:
    """The declaration of one effect: all that is known of it without computing it.

    Attributes
    ----------
    name : its table in the scene is ``[effects.NAME]``.
    title : what it gives, a few words.
    compute : "module:function" that makes the result of a `Request`, imported when it is first
        computed. It raises GeometryError with the key of the scene if data are missing or
        contradict each other, `EffectError` if there is no answer for this design.
    schema : JSON Schema of its table, an object. It may refer to the definitions of the scene's
        schema, as {"$ref": "#/$defs/length"}; a number with an "x-unit" is given in that unit.
    parse : from the table to what `compute` gets as `Request.spec`, a frozen dataclass, which
        `spec_of` makes where nothing else is to be held against the table. Numbers of the table
        are in the units of this module, angles in radians, files are `DataFile`. It raises
        GeometryError with the key in the table, e.g. "preload", if data are missing or contradict
        each other.
    rules : what does not go together with a machine that has it.
    needs : effects whose results it cannot do without.
    uses : effects whose results it takes into account if the scene names them.
    keys : data without which it cannot be: for each entry the scene has one of its keys at least,
        e.g. ("cam.speed", "cam.speed_curve") or ("effects.inertia",).
    tabled : whether it is computed only if the scene has its table; if not, other effects that need
        it get it with an empty one.
    numerical : whether it takes a tolerance and estimates its error.
    of_drive : whether it needs no follower, only what moves it.
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


def spec_of(kind: Callable[..., Spec], table: Mapping[str, Any]) -> Spec:
    """The dataclass `kind` of the keys of `table` that are its fields; others have their defaults.

    The tolerance of a numerical effect is none of them: it is in `Request`.
    """
    return kind(**{key: table[key] for key in signature(kind).parameters if key in table})
