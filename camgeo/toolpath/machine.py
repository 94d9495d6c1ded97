"""Machine profiles: what a controller wants to read, as data."""

from __future__ import annotations

import difflib
import math
import tomllib
from dataclasses import MISSING, dataclass, fields, is_dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any, get_args, get_type_hints

from camgeo.errors import Fault, SceneError
from camgeo.toolpath.machining_time import Dynamics
from camgeo.units import LengthUnit

KEY = "output.gcode.machine"
"""Key of the scene that names the profile."""

LARGEST_SWEEP = 180.0
"""No arc of a program exceeds half a turn [degrees]: controllers grow strict beyond."""


@dataclass(frozen=True, slots=True)
class UnitWords:
    """Words that switch to a unit of length."""

    mm: str
    inch: str


@dataclass(frozen=True, slots=True)
class CommentStyle:
    """Brackets of a comment (`close` may be empty) and the longest line, in characters."""

    open: str
    close: str
    line_length: int


@dataclass(frozen=True, slots=True)
class Decimals:
    """Least number of decimals of a coordinate, by unit."""

    mm: int
    inch: int


@dataclass(frozen=True, slots=True)
class ArcLimits:
    """Arcs that the controller takes, in mm.

    Attributes
    ----------
    smallest_radius, largest_radius : arcs beyond are written as chords.
    radius_tolerance : largest difference of an arc's radii at its two ends.
    largest_sweep : [degrees] in (0, 180]; larger arcs are divided.
    interpolation : how far the path that the controller runs leaves the arc.
    """

    smallest_radius: float
    largest_radius: float
    radius_tolerance: float
    largest_sweep: float = 180.0
    interpolation: float = 0.0

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


@dataclass(frozen=True, slots=True)
class Machine:
    """One controller; its blocks are written with {unit}, {tool} and {speed} filled in.

    `dynamics` is None where a profile does not tell it: then there is no machining time.
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
    machine = _build(Machine, table, "", faults)
    if not faults:
        faults = _out_of_range(machine)
    if faults:
        raise SceneError(faults, file)
    checked: Machine = machine
    return checked


def _out_of_range(machine: Machine) -> list[Fault]:
    """Numbers that no machine has."""
    faults = []
    sweep = machine.arcs.largest_sweep
    if not 0.0 < sweep <= LARGEST_SWEEP:
        message = f"must be an angle above 0, at most {LARGEST_SWEEP:g} degrees"
        faults.append(Fault("arcs.largest_sweep", repr(sweep), message))
    for key in fields(Dynamics) if machine.dynamics else ():
        value = getattr(machine.dynamics, key.name)
        if value <= 0.0:
            faults.append(Fault(f"dynamics.{key.name}", repr(value), "must be above 0"))
    return faults


def _build(kind: Any, table: dict[str, Any], path: str, faults: list[Fault]) -> Any:
    """An object of the dataclass `kind` from a TOML table; what is wrong goes to `faults`."""
    hints = get_type_hints(kind)
    expected = [field.name for field in fields(kind)]
    optional = {field.name for field in fields(kind) if field.default is not MISSING}
    for key, given in table.items():
        if key not in expected:
            near = difflib.get_close_matches(key, expected, 1)
            hint = f"did you mean {near[0]}?" if near else ""
            faults.append(Fault(path + key, repr(given), "unknown key", hint))
    values: dict[str, Any] = {}
    for key in expected:
        if key in table:
            values[key] = _value(hints[key], table[key], path + key, faults)
        elif key not in optional:
            faults.append(Fault(path + key, "", "missing"))
    return kind(**values) if values.keys() | optional >= set(expected) else None


def _value(kind: Any, given: Any, path: str, faults: list[Fault]) -> Any:
    if type(None) in get_args(kind):  # a table that may be left out
        kind = get_args(kind)[0]
    if is_dataclass(kind):
        if isinstance(given, dict):
            return _build(kind, given, path + ".", faults)
        faults.append(Fault(path, repr(given), "must be a table"))
    elif kind is str:
        if isinstance(given, str):
            return given
        faults.append(Fault(path, repr(given), "must be a text"))
    elif kind in (int, float):
        numeric = isinstance(given, int if kind is int else int | float)
        if numeric and not isinstance(given, bool) and 0 <= given < float("inf"):
            return kind(given)
        noun = "a whole number" if kind is int else "a number"
        faults.append(Fault(path, repr(given), f"must be {noun}, not negative"))
    elif isinstance(given, list) and all(isinstance(line, str) for line in given):
        return tuple(given)
    else:
        faults.append(Fault(path, repr(given), "must be a list of texts"))
    return None
