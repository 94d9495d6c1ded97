"""Machine profiles: the program format of a controller, as data."""

from __future__ import annotations

import functools
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from functools import partial
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Any, Final, get_args, get_origin, get_type_hints

from camgeo.errors import Fault, FileError, GeometryError, SceneError, meant, unreadable
from camgeo.numeric.checked import check_fields, instance, instances, one_of, shown
from camgeo.reading import MACHINE, check_toml, read_within
from camgeo.toolpath.look_ahead import Dynamics
from camgeo.toolpath.machine_fields import Text, WorkOffsets
from camgeo.toolpath.machine_options import Compensation, Smoothing
from camgeo.toolpath.machine_reading import Reading
from camgeo.toolpath.machine_schema import faults_of
from camgeo.toolpath.machine_tables import (
    ArcLimits,
    Coolant,
    Dwell,
    Evidence,
    NumberForm,
    ProgramFrame,
    Retract,
    Spindle,
    TextForm,
    ToolChange,
    UnitWords,
    Words,
)
from camgeo.toolpath.tool import COMPUTED
from camgeo.units import MM_PER, LengthUnit

KEY: Final = "output.gcode.machine"
"""Key of the scene that names the profile."""

DIALECTS: Final = ("iso", "klartext")

ROUNDING_SHARE: Final = 0.3
"""Share of the tolerance for printed numbers; it decides the number of decimals: four at 1 um."""

ROUNDING_UNITS: Final = 3.0
"""Deviation by rounding, in units of the last decimal: end points and centre each move by at most
half a diagonal, 0.71, and the radii at an arc's two ends then differ by at most 1.42."""


def _evidence(key: str, given: Any) -> tuple[Evidence, ...]:
    instance(key, given, tuple, "a tuple of `Evidence`")
    return instances(key, given, (Evidence,), "`Evidence`")


@dataclass(frozen=True, slots=True)
class Machine:
    """One controller: what programs for it look like, and what it accepts.

    The tables and their keys are those of a profile, see docs/machines.md. `compensation` and
    `smoothing` are None if the controller has none, `dynamics` if the profile does not give them:
    then there is no machining time.

    Attributes
    ----------
    name : in messages and in the comments of a program.
    controller : for which controllers it is meant, in one sentence.
    dialect : "iso", of G and M words, or "klartext".
    extension : ending of the program's file, with its point.
    evidence : what the profile rests on.
    work_offsets : words that select a work offset, by its name in scenes; the first is the default.

    Raises
    ------
    GeometryError
        With the key of the profile, for an invalid value.
    """

    name: Text
    controller: Text
    dialect: Annotated[str, partial(one_of, choices=DIALECTS)]
    extension: Text
    text: TextForm
    numbers: NumberForm
    unit: UnitWords
    program: ProgramFrame
    work_offsets: WorkOffsets
    tool_change: ToolChange
    retract: Retract
    spindle: Spindle
    coolant: Coolant
    dwell: Dwell
    arcs: ArcLimits
    words: Words
    reading: Reading = field(default_factory=Reading)
    evidence: Annotated[tuple[Evidence, ...], _evidence] = ()
    compensation: Compensation | None = None
    smoothing: Smoothing | None = None
    dynamics: Dynamics | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        if not (self.extension.startswith(".") and self.extension[1:].isalnum()):
            message = "must be a point and up to eight letters or digits"
            raise GeometryError(message, "extension", shown(self.extension))
        compensation = self.compensation
        if compensation is None or not compensation.nominal:
            return
        blocks = (compensation.left, compensation.right, *self.tool_change.change)
        if not any("{nominal}" in block for block in blocks):
            message = "must stand as {nominal} in compensation.left and right or tool_change.change"
            raise GeometryError(message, "compensation.nominal", shown(compensation.nominal))
        called = any("{nominal}" in block for block in self.tool_change.change)
        if called and not self.tool_change.repeat:
            message = "must be true where tool_change.change has {nominal}: it holds up to the next"
            raise GeometryError(message, "tool_change.repeat", "false")

    @property
    def compensations(self) -> tuple[str, ...]:
        """Those of `camgeo.toolpath.spec.COMPENSATIONS` that it allows, "computed" first."""
        return (COMPUTED, *(self.compensation.modes if self.compensation else ()))

    def decimals(self, unit: LengthUnit, tolerance: float) -> int:
        """Of the coordinates in a program within `tolerance` [mm]: as many as the controller
        writes, more where that needs them, and no more than it resolves.
        """
        finest = ROUNDING_SHARE * tolerance / (ROUNDING_UNITS * MM_PER[unit])
        numbers, needed = self.numbers, math.ceil(-math.log10(finest))
        return min(max(numbers.decimals.of(unit), needed), numbers.most_decimals.of(unit))

    def smoothed(self, tolerance: float, most: float = math.inf) -> float | None:
        """By how much the controller may leave the path within `tolerance` [mm], `most` at most;
        None if it runs the exact path.
        """
        smoothing = self.smoothing
        if smoothing is None:
            return None
        found = min(smoothing.share * tolerance, smoothing.largest, most)
        return found if found > 0.0 and found >= smoothing.smallest * (1.0 - 1e-9) else None


@functools.cache
def names() -> tuple[str, ...]:
    """Names of the profiles in the package."""
    folder = files("camgeo.toolpath").joinpath("machines")
    return tuple(
        sorted(
            entry.name.removesuffix(".toml")
            for entry in folder.iterdir()
            if entry.name.endswith(".toml")
        )
    )


def load(machine: str, key: str = KEY) -> Machine:
    """The profile of that name or file; raises SceneError with all its faults.

    `key` is what messages call the name of the profile.
    """
    known = names()
    if machine in known:
        return _own(machine)
    if not machine.endswith(".toml"):
        message = f"no such machine profile; allowed: {', '.join(known)}, or a .toml file"
        raise SceneError([Fault(key, repr(machine), message, meant(machine, known))])
    try:
        text = read_within(Path(machine), MACHINE).decode("utf-8-sig")
    except (OSError, ValueError) as error:  # the latter also for a path that no file can have
        message = f"the profile cannot be read: {unreadable(error)}"
        raise SceneError([Fault(key, repr(machine), message)]) from None
    return parse(text, machine)


@functools.cache
def _own(name: str) -> Machine:
    """A profile in the package, which does not change."""
    resource = files("camgeo.toolpath").joinpath("machines", f"{name}.toml")
    return parse(resource.read_text(encoding="utf-8"), f"{name}.toml")


def parse(text: str, file: str) -> Machine:
    """The profile in `text`; `file` is its name for messages."""
    try:
        check_toml(text)
        table = tomllib.loads(text)
    except FileError as error:
        raise SceneError([Fault("", "", str(error))], file) from None
    except RecursionError:
        raise SceneError([Fault("", "", "is nested too deeply for a profile")], file) from None
    except ValueError as error:  # also of an integer of thousands of digits
        raise SceneError([Fault("", "", f"not TOML: {error}")], file) from None
    if faults := faults_of(table):
        raise SceneError(faults, file)
    faults = []
    machine: Machine | None = _build(Machine, table, faults)
    if machine is None or faults:
        raise SceneError(faults, file)
    return machine


def _build(kind: Any, table: Mapping[str, Any], faults: list[Fault]) -> Any:
    """An object of the dataclass `kind` from a table that fits the schema; None with `faults`."""
    hints = _hints(kind)
    values: dict[str, Any] = {}
    for own in fields(kind):
        if own.name not in table:
            continue
        given, hint = table[own.name], hints[own.name]
        kinds = (hint, *get_args(hint))
        inner = next((each for each in kinds if is_dataclass(each)), None)
        if inner is not None and get_origin(hint) is tuple:
            values[own.name] = tuple(_build(inner, each, faults) for each in given)
        elif inner is None:
            values[own.name] = tuple(given) if isinstance(given, list) else given
        else:
            values[own.name] = _build(inner, given, faults)
    if faults:
        return None
    try:
        return kind(**values)
    except GeometryError as error:
        faults.append(Fault(error.key, error.value, error.message))
        return None


@functools.cache
def _hints(kind: Any) -> dict[str, Any]:
    """The types of the fields of a dataclass; a profile has many objects of some."""
    return get_type_hints(kind)
