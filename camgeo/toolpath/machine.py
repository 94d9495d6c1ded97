"""Machine profiles: what a controller wants to read, as data."""

from __future__ import annotations

import difflib
import math
import tomllib
from dataclasses import MISSING, dataclass, fields, is_dataclass
from importlib.resources import files
from pathlib import Path
from types import UnionType
from typing import Any, get_args, get_type_hints

from camgeo.errors import Fault, GeometryError, SceneError
from camgeo.numeric.checked import hold, instance, number, shown, whole
from camgeo.toolpath.machining_time import Dynamics
from camgeo.units import LengthUnit

KEY = "output.gcode.machine"
"""Key of the scene that names the profile."""

SMALLEST_SWEEP, LARGEST_SWEEP = 1.0, 180.0
"""No arc of a program exceeds half a turn [degrees]: controllers grow strict beyond. No controller
wants them divided finely."""

MOST_DECIMALS = 10
"""More decimals than a controller's double holds of a length of metres."""

LONGEST_LINE = 10_000
"""Characters; no controller takes as many."""


@dataclass(frozen=True, slots=True)
class UnitWords:
    """Words that switch to a unit of length."""

    mm: str
    inch: str

    def __post_init__(self) -> None:
        _hold(self, "unit.")


@dataclass(frozen=True, slots=True)
class CommentStyle:
    """Brackets of a comment (`close` may be empty) and the longest line, in characters."""

    open: str
    close: str
    line_length: int

    def __post_init__(self) -> None:
        _hold(self, "comment.")
        brackets = len(self.open) + len(self.close)
        whole("comment.line_length", self.line_length, brackets + 1, LONGEST_LINE)


@dataclass(frozen=True, slots=True)
class Decimals:
    """Least number of decimals of a coordinate, by unit."""

    mm: int
    inch: int

    def __post_init__(self) -> None:
        _hold(self, "decimals.")
        for key in ("mm", "inch"):
            whole(f"decimals.{key}", getattr(self, key), 1, MOST_DECIMALS)


@dataclass(frozen=True, slots=True)
class ArcLimits:
    """Arcs that the controller takes, in mm.

    Attributes
    ----------
    smallest_radius, largest_radius : arcs beyond are written as chords.
    radius_tolerance : largest difference of an arc's radii at its two ends.
    largest_sweep : [degrees] from 1 to 180; larger arcs are divided.
    interpolation : how far the path that the controller runs leaves the arc.
    """

    smallest_radius: float
    largest_radius: float
    radius_tolerance: float
    largest_sweep: float = 180.0
    interpolation: float = 0.0

    def __post_init__(self) -> None:
        _hold(self, "arcs.")
        number("arcs.largest_sweep", self.largest_sweep, least=SMALLEST_SWEEP, most=LARGEST_SWEEP)

    @property
    def largest_turn(self) -> float:
        """`largest_sweep` [rad]."""
        return math.radians(self.largest_sweep)


@dataclass(frozen=True, slots=True)
class Blending:
    """Path blending: `on` with {p} in program units, or `off` for the exact path.

    Attributes
    ----------
    share : P as a share of the tolerance.
    smallest : P [mm] below which the exact path is asked for instead.
    """

    on: str
    off: str
    share: float
    smallest: float

    def __post_init__(self) -> None:
        _hold(self, "blending.")


@dataclass(frozen=True, slots=True)
class Machine:
    """One controller; its blocks are written with {unit}, {tool} and {speed} filled in.

    `dynamics` is None where a profile does not tell it: then there is no machining time. Like all
    of its tables it raises GeometryError, with the key of the profile, for a value of another type,
    a negative number, or a block that cannot be filled in.
    """

    name: str
    preamble: tuple[str, ...]
    tool_change: tuple[str, ...]
    spindle_on: tuple[str, ...]
    end: tuple[str, ...]
    unit: UnitWords
    comment: CommentStyle
    decimals: Decimals
    arcs: ArcLimits
    blending: Blending
    dynamics: Dynamics | None = None

    def __post_init__(self) -> None:
        _hold(self, "")
        lists = ("preamble", "tool_change", "spindle_on", "end")
        texts = [(key, block) for key in lists for block in getattr(self, key)]
        for key, text in (*texts, ("blending.on", self.blending.on)):
            try:
                text.format(unit="", tool="", speed="", p="")
            except (ValueError, LookupError, AttributeError):
                message = "must hold no braces but {unit}, {tool}, {speed} and, for blending, {p}"
                raise GeometryError(message, key, repr(text)) from None

    def unit_word(self, unit: LengthUnit) -> str:
        """Word that switches to `unit`."""
        return self.unit.mm if unit == "mm" else self.unit.inch

    def least_decimals(self, unit: LengthUnit) -> int:
        """Least number of decimals in `unit`."""
        return self.decimals.mm if unit == "mm" else self.decimals.inch


def names() -> list[str]:
    """Names of the profiles that come with the package."""
    folder = files("camgeo.toolpath").joinpath("machines")
    return sorted(
        entry.name.removesuffix(".toml")
        for entry in folder.iterdir()
        if entry.name.endswith(".toml")
    )


def load(machine: str) -> Machine:
    """The profile of that name or file; raises SceneError with all that is wrong in it."""
    known = names()
    if machine in known:
        resource = files("camgeo.toolpath").joinpath("machines", f"{machine}.toml")
        return parse(resource.read_text(encoding="utf-8"), f"{machine}.toml")
    if not machine.endswith(".toml"):
        near = difflib.get_close_matches(machine, known, 1)
        hint = f"did you mean {near[0]}?" if near else ""
        message = f"no such machine profile; allowed: {', '.join(known)}, or a .toml file"
        raise SceneError([Fault(KEY, repr(machine), message, hint)])
    try:
        text = Path(machine).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        message = f"the profile cannot be read: {error}"
        raise SceneError([Fault(KEY, repr(machine), message)]) from None
    return parse(text, machine)


def parse(text: str, file: str) -> Machine:
    """The profile in `text`; `file` is its name for messages."""
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SceneError([Fault("", "", f"not TOML: {error}")], file) from None
    faults: list[Fault] = []
    machine: Machine | None = _build(Machine, table, "", faults)
    if machine is None or faults:
        raise SceneError(faults, file)
    return machine


def _build(kind: Any, table: dict[str, Any], path: str, faults: list[Fault]) -> Any:
    """An object of the dataclass `kind` from a TOML table; what is wrong goes to `faults`."""
    hints = get_type_hints(kind)
    optional = {field.name for field in fields(kind) if field.default is not MISSING}
    for key, given in table.items():
        if key not in hints:
            near = difflib.get_close_matches(key, list(hints), 1)
            hint = f"did you mean {near[0]}?" if near else ""
            faults.append(Fault(path + key, repr(given), "unknown key", hint))
    values: dict[str, Any] = {}
    for key, kinds in hints.items():
        if key not in table:
            if key not in optional:
                faults.append(Fault(path + key, "", "missing"))
            continue
        given = table[key]
        inner = next((each for each in _kinds(kinds) if is_dataclass(each)), None)
        try:
            if inner is None or not isinstance(given, dict):
                values[key] = _checked(kinds, given, path + key)
            else:
                values[key] = _build(inner, given, f"{path}{key}.", faults)
        except GeometryError as error:
            faults.append(Fault(error.key, error.value, error.message))
    if faults:
        return None
    try:
        return kind(**values)
    except GeometryError as error:
        faults.append(Fault(error.key, error.value, error.message))
        return None


def _hold(owner: object, path: str) -> None:
    """Check the fields of a dataclass by their types, see `_checked`."""
    for key, kind in get_type_hints(type(owner)).items():
        hold(owner, **{key: _checked(kind, getattr(owner, key), path + key)})


def _checked(kind: Any, given: Any, path: str) -> Any:
    """`given` as one of a field's types; numbers are not negative."""
    wanted, *others = _kinds(kind)
    if given is None and others:
        return None
    if wanted is float:
        return number(path, given, least=0.0)
    if wanted is int:
        return whole(path, given, 1, LONGEST_LINE)
    if wanted is str:
        return instance(path, given, str, "a text")
    if isinstance(wanted, type) and is_dataclass(wanted):
        return instance(path, given, wanted, "a table")
    if isinstance(given, list | tuple) and all(isinstance(line, str) for line in given):
        return tuple(given)
    raise GeometryError("must be a list of texts", path, shown(given))


def _kinds(kind: Any) -> tuple[Any, ...]:
    """The types that a field may have: itself, or those of a union."""
    return get_args(kind) if isinstance(kind, UnionType) else (kind,)
