"""Machine profiles: the program format of a controller, as data."""

from __future__ import annotations

import math
import tomllib
from dataclasses import MISSING, dataclass, fields, is_dataclass
from functools import partial
from importlib.resources import files
from pathlib import Path
from string import Formatter
from typing import Annotated, Any, get_args, get_type_hints

from camgeo.errors import Fault, FileError, GeometryError, SceneError, meant, unreadable
from camgeo.numeric.checked import check_fields, checks_of, instance, number, shown, whole
from camgeo.reading import MACHINE, check_toml, read_within
from camgeo.toolpath.machining_time import Dynamics
from camgeo.units import LengthUnit

KEY = "output.gcode.machine"
"""Key of the scene that names the profile."""

SMALLEST_SWEEP, LARGEST_SWEEP = 1.0, 180.0
"""No arc of a program exceeds half a turn [degrees], beyond which controllers are strict. No
controller needs finely divided arcs."""

MOST_DECIMALS = 10
"""More decimals than a controller's double holds for a length of metres."""

FILLED = ("unit", "tool", "speed", "p")
"""Names in braces that blocks may have."""

MOST_SHOWN = 60
"""Characters shown of a block."""

LONGEST_LINE = 10_000
"""Characters; no controller accepts as many."""


def _blocks(key: str, given: Any) -> tuple[str, ...]:
    if isinstance(given, list | tuple) and all(isinstance(line, str) for line in given):
        return tuple(given)
    raise GeometryError("must be a list of texts", key, shown(given))


Text = Annotated[str, partial(instance, kind=str, what="a text")]
Blocks = Annotated[tuple[str, ...], _blocks]
Size = Annotated[float, partial(number, least=0.0)]
LineLength = Annotated[int, partial(whole, least=1, most=LONGEST_LINE)]
DecimalCount = Annotated[int, partial(whole, least=1, most=MOST_DECIMALS)]
Sweep = Annotated[float, partial(number, least=SMALLEST_SWEEP, most=LARGEST_SWEEP)]


@dataclass(frozen=True, slots=True)
class UnitWords:
    """Words that switch to a unit of length."""

    mm: Text
    inch: Text

    def __post_init__(self) -> None:
        check_fields(self, "unit.")


@dataclass(frozen=True, slots=True)
class CommentStyle:
    """Brackets of a comment (`close` may be empty) and the longest line, in characters."""

    open: Text
    close: Text
    line_length: LineLength

    def __post_init__(self) -> None:
        check_fields(self, "comment.")
        brackets = len(self.open) + len(self.close)
        whole("comment.line_length", self.line_length, brackets + 1, LONGEST_LINE)


@dataclass(frozen=True, slots=True)
class Decimals:
    """Least number of decimals of a coordinate, by unit."""

    mm: DecimalCount
    inch: DecimalCount

    def __post_init__(self) -> None:
        check_fields(self, "decimals.")


@dataclass(frozen=True, slots=True)
class ArcLimits:
    """Arcs that the controller accepts, in mm.

    Attributes
    ----------
    smallest_radius, largest_radius : arcs beyond are written as chords.
    radius_tolerance : largest difference of an arc's radii at its two ends.
    largest_sweep : [degrees] from 1 to 180; larger arcs are divided.
    interpolation : how far the path that the controller runs departs from the arc.
    """

    smallest_radius: Size
    largest_radius: Size
    radius_tolerance: Size
    largest_sweep: Sweep = 180.0
    interpolation: Size = 0.0

    def __post_init__(self) -> None:
        check_fields(self, "arcs.")

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
    smallest : P [mm] below which the exact path is programmed instead.
    """

    on: Text
    off: Text
    share: Size
    smallest: Size

    def __post_init__(self) -> None:
        check_fields(self, "blending.")


@dataclass(frozen=True, slots=True)
class Machine:
    """One controller; its blocks are written with {unit}, {tool} and {speed} filled in.

    `dynamics` is None if a profile does not give it: then there is no machining time. Like all
    its tables it raises GeometryError, with the key of the profile, for a value of another type,
    a negative number, or a block that cannot be filled in.
    """

    name: Text
    preamble: Blocks
    tool_change: Blocks
    spindle_on: Blocks
    end: Blocks
    unit: UnitWords
    comment: CommentStyle
    decimals: Decimals
    arcs: ArcLimits
    blending: Blending
    dynamics: Dynamics | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        lists = ("preamble", "tool_change", "spindle_on", "end")
        texts = [(key, block) for key in lists for block in getattr(self, key)]
        for key, text in (*texts, ("blending.on", self.blending.on)):
            try:
                found = [each for each in Formatter().parse(text) if each[1] is not None]
            except ValueError:
                found = [("", None, None, None)]
            if any(name not in FILLED or form or kind for _, name, form, kind in found):
                message = "must hold no braces but {unit}, {tool}, {speed} and, for blending, {p}"
                raise GeometryError(message, key, repr(text[:MOST_SHOWN]))

    def unit_word(self, unit: LengthUnit) -> str:
        """Word that switches to `unit`."""
        return self.unit.mm if unit == "mm" else self.unit.inch

    def least_decimals(self, unit: LengthUnit) -> int:
        """Least number of decimals in `unit`."""
        return self.decimals.mm if unit == "mm" else self.decimals.inch


def names() -> list[str]:
    """Names of the profiles in the package."""
    folder = files("camgeo.toolpath").joinpath("machines")
    return sorted(
        entry.name.removesuffix(".toml")
        for entry in folder.iterdir()
        if entry.name.endswith(".toml")
    )


def load(machine: str) -> Machine:
    """The profile of that name or file; raises SceneError with all its faults."""
    known = names()
    if machine in known:
        resource = files("camgeo.toolpath").joinpath("machines", f"{machine}.toml")
        return parse(resource.read_text(encoding="utf-8"), f"{machine}.toml")
    if not machine.endswith(".toml"):
        message = f"no such machine profile; allowed: {', '.join(known)}, or a .toml file"
        raise SceneError([Fault(KEY, repr(machine), message, meant(machine, known))])
    try:
        text = read_within(Path(machine), MACHINE).decode("utf-8")
    except (OSError, ValueError) as error:  # the latter also for a path that no file can have
        message = f"the profile cannot be read: {unreadable(error)}"
        raise SceneError([Fault(KEY, repr(machine), message)]) from None
    return parse(text, machine)


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
    faults: list[Fault] = []
    machine: Machine | None = _build(Machine, table, "", faults)
    if machine is None or faults:
        raise SceneError(faults, file)
    return machine


def _build(kind: Any, table: dict[str, Any], path: str, faults: list[Fault]) -> Any:
    """An object of the dataclass `kind` from a TOML table; faults are added to `faults`."""
    hints = get_type_hints(kind)
    for key, given in table.items():
        if key not in hints:
            faults.append(Fault(path + key, shown(given), "unknown key", meant(key, hints)))
    values: dict[str, Any] = {}
    for field in fields(kind):
        key, kinds = field.name, hints[field.name]
        if key not in table:
            if field.default is MISSING:
                faults.append(Fault(path + key, "", "missing"))
            continue
        inner = next((each for each in (kinds, *get_args(kinds)) if is_dataclass(each)), None)
        try:
            if inner is None:
                check, _, _ = checks_of(kind)[key]
                values[key] = check(path + key, table[key])
            else:
                inside = instance(path + key, table[key], dict, "a table")
                values[key] = _build(inner, inside, f"{path}{key}.", faults)
        except GeometryError as error:
            faults.append(Fault(error.key, error.value, error.message))
    if faults:
        return None
    try:
        return kind(**values)
    except GeometryError as error:
        faults.append(Fault(error.key, error.value, error.message))
        return None
