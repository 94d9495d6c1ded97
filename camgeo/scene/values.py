"""The values of a scene: as a tree, in internal units, and as rules see them."""

from __future__ import annotations

import datetime as dt
import itertools
import math
import os
import pathlib
import re
import tomllib
from collections.abc import Collection, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, Self, TypeAlias

from jsonschema_rs import ValidationError

from camgeo.cam.cam import Contact
from camgeo.errors import (
    CamgeoError,
    Fault,
    FileError,
    GeometryError,
    SceneError,
    meant,
    nearest,
    unreadable,
)
from camgeo.kinematics.mechanism.declared.registry import FOLLOWERS, LINKAGES
from camgeo.kinematics.mechanism.values import MEMBER_UNITS, FollowerKind, Member
from camgeo.reading import SCENE, TABLE, check_toml
from camgeo.record import Brief, allowed
from camgeo.scene.keys import (
    KeyPath,
    key_lines,
    nearest_line,
    parse_path,
    quoted,
    spelled,
    tree_value,
)
from camgeo.scene.schema import (
    Composed,
    Node,
    definition,
    referred,
    resolved,
    schema,
    schema_for,
    table_keys,
)
from camgeo.units import MM_PER, RPM, LengthUnit, LiftUnit, in_unit, listed

Broken: TypeAlias = tuple[KeyPath, str]
"""What a rule finds: the place at fault, and why."""


class ValidValues:
    """A scene without the values that are known to be wrong.

    A rule reads what it compares and reports nothing where anything is missing, so that no fault
    is a consequence of another one.

    Attributes
    ----------
    scene : the document, with the values that are wrong too. Rules must not read it directly: such
        reads would not be recorded, see `RecordingValues`.
    flawless : whether no value is wrong by itself.
    reads : the places that each rule, and each builder by its name, has read, where recorded.
    """

    def __init__(
        self, scene: Document, bad: Collection[KeyPath] = (), meant: Collection[KeyPath] = ()
    ) -> None:
        self.scene = scene
        self._bad = frozenset(bad)
        # All ancestors of bad values, so that `valid` need not search for a fault below a table.
        self._around_bad = {path[:end] for path in bad for end in range(len(path) + 1)}
        self._meant = frozenset(meant)
        self.flawless = not (bad or meant)
        self.reads: dict[Hashable, Reads] = {}

    def valid(self, *path: str | int) -> bool:
        """Whether nothing is wrong at `path`, around it or in it."""
        if not self._bad:
            return True
        if path in self._around_bad:
            return False
        return not any(path[:end] in self._bad for end in range(len(path) + 1))

    def has(self, *path: str | int) -> bool:
        """Whether the scene names the key, with a valid value or not."""
        return self.scene.exact_value(path) is not None

    def lacks(self, *path: str | int) -> bool:
        """Whether the scene neither names the key nor has a misspelt one meant to be it."""
        meant = any(path[:end] in self._meant for end in range(1, len(path) + 1))
        return not meant and not self.has(*path)

    def get(self, *path: str | int) -> Any:
        """Value at `path`; None if it is absent or not valid."""
        return self.raw(*path) if self.valid(*path) else None

    def raw(self, *path: str | int) -> Any:
        """Value at `path`, valid or not; None if it is absent, or can be the value of no scene."""
        return tree_value(self.scene.plain, path)

    def exact(self, *path: str | int) -> Decimal | None:
        """Number at `path` exactly as written; None if it is absent or not valid."""
        if self.get(*path) is None:
            return None
        return Decimal(self.scene.exact_value(path))

    @property
    def unit(self) -> LengthUnit:
        """The scene's unit of length, mm if it is not valid."""
        return "inch" if self.get("units", "length") == "inch" else "mm"

    @property
    def mm(self) -> float:
        """Millimetres per unit of length."""
        return MM_PER[self.unit]

    @property
    def segments(self) -> int:
        """Number of segments of the motion, 0 if `motion` is not a list."""
        motion = self.raw("motion")
        return len(motion) if isinstance(motion, list) else 0

    @property
    def follower_kind(self) -> FollowerKind | None:
        """What kind of follower it is; None if that is not known."""
        return FOLLOWERS.get(self.get("follower", "kind") or "")

    @property
    def contact(self) -> Contact | None:
        """The flank on which the follower runs; None if that is not known."""
        if not self.valid("follower", "contact"):
            return None
        return Contact(self.get("follower", "contact") or Contact.INNER)

    @property
    def flat(self) -> bool:
        """Whether the follower has a flat face."""
        return self.follower_kind is not None and self.follower_kind.touching == "face"

    @property
    def slides(self) -> bool:
        """Whether the follower is a translating one."""
        return self.follower_kind is not None and self.follower_kind.unit == "mm"

    @property
    def lift_unit(self) -> LiftUnit:
        """Unit of the follower's motion; without a follower, that of the linkage or the scene."""
        if self.follower_kind is not None:
            return self.follower_kind.unit
        if self.has("linkage"):
            linkage = LINKAGES.get(self.get("linkage", "kind"))
            return "mm" if linkage is None else next(iter(linkage.members))
        return "rad" if self.get("units", "motion") == "degrees" else "mm"

    @property
    def angular(self) -> bool:
        """Whether positions of the motion are angles: of the follower, or of a linkage's end."""
        if self.lacks("linkage"):
            return self.lift_unit == "rad"
        far_end = linkage_far_end(self)
        return far_end is not None and MEMBER_UNITS[far_end] == "rad"


def linkage_far_end(values: ValidValues) -> Member | None:
    """The member whose motion a linkage's far end makes; None without one, or if not known."""
    linkage, follower = values.get("linkage", "kind"), values.follower_kind
    if linkage is None or (follower is None and values.has("follower")):
        return None
    return LINKAGES[linkage].members.get(values.lift_unit)


def present_tables(values: ValidValues, *names: str) -> dict[str, Any]:
    """The scene's tables of these names, as far as it states them, valid or not."""
    return {name: values.raw(name) for name in names if values.has(name)}


class RecordingValues(ValidValues):
    """Valid values of a scene that record which of them are read.

    Attributes
    ----------
    recorded : the places read so far.
    """

    def __init__(self, scene: Document) -> None:
        super().__init__(scene)
        self.recorded = Reads()

    def valid(self, *_: str | int) -> bool:
        """True for all paths: nothing in such a scene is wrong by itself."""
        return True

    def has(self, *path: str | int) -> bool:
        """Whether the scene names the key; records that it was asked."""
        self.recorded.note_presence(path)
        return super().has(*path)

    def raw(self, *path: str | int) -> Any:
        """Value at `path`, or None; records that it was read."""
        self.recorded.note(path)
        return super().raw(*path)


# -- converter ------------------------------------------------------------------------------------
# The values of a scene in internal units, with the files that it names, and their faults.


SCALES: Final[dict[str, float]] = {
    "kg": 1e-3,
    "kg m^2": 1e3,
    "kg/m^3": 1e-12,
    "N": 1.0,
    "N m": 1e3,
    "N/mm": 1.0,
    "N m/rad": 1e3,
    "N s/mm": 1.0,
    "N m s/rad": 1e3,
    "MPa": 1.0,
    "mm/s": 1.0,
    "m/min": 1e3,
    "Hz": 2.0 * math.pi,
    "hours": 3600.0,
    "s": 1.0,
    "rev/min": RPM,
    "degrees": math.pi / 180.0,
}
"""From the units of a scene to mm, s, t, N and rad (rad/s for Hz), by the schema's `x-unit`.

Cutting speeds are in mm/min, as feeds are."""

LENGTHS: Final = ("#/$defs/length", "#/$defs/coordinate")
"""References of numbers in the scene's unit of length, unless they have a default in mm."""

FILE: Final = "#/$defs/file"


NO_FOLDER: Final = (
    "names a file, which needs a folder: load the scene from a file, or with folder=..."
)


class SceneConverter:
    """Converts the values of a scene to internal units and reads its files; collects all faults.

    Parameters
    ----------
    values : of the scene.
    folder : in which its files lie, absolute and without links; None if there is none.
    known : contents of files, by their names; these files are not read again.

    Attributes
    ----------
    faults : what geometry and files forbid.
    contents : of the files that were read, by the names that the scene gives them.
    hashes : SHA-256 of data, hexadecimal, by the same names.
    """

    def __init__(
        self,
        values: ValidValues,
        folder: pathlib.Path | None = None,
        known: Mapping[str, bytes] | None = None,
    ) -> None:
        self.values = values
        self.faults: list[Fault] = []
        self.contents: dict[str, bytes] = {}
        self.hashes: dict[str, str] = {}
        self._folder = folder
        self._known = known or {}

    def recorder(self) -> tuple[SceneConverter, RecordingValues]:
        """A converter of the same values, and the values themselves, which record what it reads; no
        value of the scene may be wrong.
        """
        recording = RecordingValues(self.values.scene)
        return SceneConverter(recording, self._folder, {**self._known, **self.contents}), recording

    def take(self, other: SceneConverter) -> None:
        """Take over the faults, the contents of files and their hashes from another converter."""
        self.faults += [fault for fault in other.faults if fault not in self.faults]
        self.contents |= other.contents
        self.hashes |= other.hashes

    def fault(self, path: KeyPath, message: str, hint: str = "") -> None:
        """Report a fault of the value at `path`, which need not exist; equal faults count once."""
        reported = self.values.scene.fault(path, message, hint)
        if reported not in self.faults:
            self.faults.append(reported)

    def read(self, key: KeyPath) -> bytes | None:
        """The content of the file that the scene names at `key`; None, with a fault, if it cannot
        be read. Of a file that is too large it has one byte more than allowed, for the parser to
        refuse.
        """
        if self.path(key) is None:
            return None
        import hashlib  # few scenes name a file

        name: str = self.values.get(*key)
        data = self.contents[name]
        self.hashes[name] = hashlib.sha256(data).hexdigest()
        return data

    def path(self, key: KeyPath) -> str | None:
        """Path of the file that the scene names at `key`; None, with a fault, if it cannot be read.

        Its present content is kept in `contents`.
        """
        name: str = self.values.get(*key)
        if self._folder is None:
            self.fault(key, NO_FOLDER)
            return None
        path = (self._folder / name).resolve()
        if not path.is_relative_to(self._folder):
            self.fault(key, "must not leave the folder of the scene")
            return None
        data = self.contents.get(name, self._known.get(name))
        if data is None:
            try:
                with path.open("rb") as stream:
                    data = stream.read(TABLE.size + 1)
            except (OSError, ValueError) as error:
                self.fault(key, f"cannot be read: {unreadable(error)}")
                return None
        self.contents[name] = data
        return str(path)

    def table(self, path: KeyPath, node: Mapping[str, Any]) -> dict[str, Any]:
        """The valid table at `path`, by its schema `node`; None where a file cannot be read."""
        converted: dict[str, Any] = self._value(path, self.values.get(*path), dict(node))
        return converted

    def _value(self, path: KeyPath, value: Any, node: Node) -> Any:
        if isinstance(value, dict):
            inner = node.get("properties", {})
            return {
                key: self._value((*path, key), item, inner.get(key, {}))
                for key, item in value.items()
            }
        if isinstance(value, list):
            of_items: Node = node.get("items", {})
            return tuple(
                self._value((*path, index), item, of_items) for index, item in enumerate(value)
            )
        reference = node.get("$ref", "")
        if reference == FILE:
            from camgeo.dynamics.effects.effect import DataFile  # few scenes name a file

            data = self.read(path)
            return None if data is None else DataFile(value, data)
        if "x-path" in node and value not in node.get("x-values", ()):
            return self.path(path)
        if isinstance(value, str | bool):
            return value
        if node.get("type") == "integer":
            return int(value)
        if "x-exact" in node:
            return self.values.exact(*path)
        if reference in LENGTHS or "x-default-mm" in node:
            return float(value) * self.values.mm
        # Keywords beside a reference take precedence over those of the definition.
        unit = {**schema()["$defs"].get(reference.rpartition("/")[2], {}), **node}.get("x-unit", "")
        return float(value) * (_scale(path, unit) if unit else 1.0)


def _scale(path: KeyPath, unit: str) -> float:
    """The factor from `unit` to the internal unit; CamgeoError if there is no such unit."""
    if unit in SCALES:
        return SCALES[unit]
    raise CamgeoError(
        f'{spelled(path)}: the x-unit "{unit}" of its schema is unknown; known: {", ".join(SCALES)}'
    )


# -- named ----------------------------------------------------------------------------------------
# Files that a scene may name, and whether they have changed.


LONGEST: Final = 1024
"""Characters of a text that may be the name of a file; longer ones are none."""

Stamp = tuple[int, int, int] | None
"""Identifies one state of a file: its inode number, time of last change [ns] and size [bytes]; None
if there is no such file. A file that is replaced, as editors do on saving, has another inode."""


def stamp(path: Path) -> Stamp:
    """The present state of one file."""
    try:
        return stamp_from_stat(path.stat())
    except (OSError, ValueError):
        return None


def stamp_from_stat(status: os.stat_result) -> Stamp:
    """The state of a file, from what the system reports about it."""
    return status.st_ino, status.st_mtime_ns, status.st_size


def named_files(text: str, folder: Path) -> tuple[Path, ...] | None:
    """Files in `folder` that the scene in a text may name: any of its texts; None if it is no TOML.

    A scene may be broken for the moment, and a file may be missing: neither matters here.
    """
    try:
        check_toml(text)
        tree = tomllib.loads(text)
    except (FileError, ValueError, RecursionError):
        return None
    return tuple(sorted({folder / name for name in _texts(tree)}))


def _texts(value: Any) -> Iterator[str]:
    """All texts in a TOML value that may be names of files of a folder, or below it."""
    if isinstance(value, str):
        if 0 < len(value) <= LONGEST and value.isprintable() and _is_inside(value):
            yield value
    elif isinstance(value, dict | list):
        for item in value.values() if isinstance(value, dict) else value:
            yield from _texts(item)


def _is_inside(name: str) -> bool:
    """Whether a name stays within the folder; a scene must not name files elsewhere."""
    path = Path(name)
    return not path.is_absolute() and ".." not in path.parts


# -- tree -----------------------------------------------------------------------------------------
# The values of a scene as tables, lists and single values: taken from Python, shown, edited.
#
# A tree consists of dicts, lists, text, booleans, integers and Decimals, and is never changed:
# an edit makes a new one, which shares all unchanged parts with the first.


DEEPEST: Final = 16
"""Largest depth of nesting that is read; a scene needs 4."""

MOST_VALUES: Final = 1_000_000
"""Single values, lists and tables of the largest scene; a file of allowed size has no more."""

Tree = dict[str, Any]


class Taking:
    """Copies values that come from Python; a float becomes the decimal number that Python prints.

    A value that no scene may have stays as it is, to be reported among the scene's faults.
    """

    def __init__(self) -> None:
        self._count = 0

    def take(self, value: Any, path: KeyPath = ()) -> Any:
        """An independent tree; SceneError if it is too deep or too large, or a name is not text."""
        self._count += 1
        if len(path) > DEEPEST:
            raise scene_error("is nested too deeply for a scene")
        if self._count > MOST_VALUES:
            raise scene_error("has too many values")
        if isinstance(value, Mapping):
            return {self._name(key, path): self.take(value[key], (*path, key)) for key in value}
        if isinstance(value, list | tuple):
            return [self.take(item, (*path, index)) for index, item in enumerate(value)]
        if isinstance(value, float):
            return Decimal(float.__repr__(value))
        if isinstance(value, int) and not isinstance(value, bool):
            return int(value)
        return str.__str__(value) if isinstance(value, str) else value

    def _name(self, key: Any, path: KeyPath) -> str:
        if isinstance(key, str):
            return str.__str__(key)
        message = "the names of keys must be text"
        raise SceneError([Fault(spelled(path), repr(key)[:60], message)])


def with_edits(tree: Tree, edits: Mapping[str, Any]) -> Tree:
    """The tree with other values at keys that are spelled as messages do; None removes a key.

    Missing tables are created; a new key follows the one that the previous edit set in
    its table. Values are set before any are removed, so that positions are those in the tree as it
    was.

    Raises
    ------
    SceneError
        With each key that is invalid, or leads into something other than a table or list.
    """
    taking = Taking()
    faults: list[Fault] = []
    removed: list[KeyPath] = []
    last: KeyPath = ()
    for key, value in edits.items():
        try:
            path = _path(tree, key)
            if value is None:
                removed.append(path)
            else:
                tree = _with_value(tree, path, taking.take(value, path), last)
                last = path
        except _NoPlaceError as error:
            faults.append(Fault(str(key), "", str(error)))
    if faults:
        raise SceneError(faults)
    for path in sorted(removed, key=_order, reverse=True):
        tree = without(tree, path)
    return tree


class _NoPlaceError(Exception):
    """A key leads nowhere."""


def _path(tree: Tree, key: Any) -> KeyPath:
    """The path of `key`; a position may be written as a name too, motion.2.law."""
    path = parse_path(key) if isinstance(key, str) else None
    if not path:
        raise _NoPlaceError("is not a key; write it as messages do, e.g. motion[2].law")
    node: Any = tree
    prefix: KeyPath = ()
    for step in path:
        if isinstance(node, list):
            if isinstance(step, str) and step.isdecimal():
                step = int(step) - 1
            if not isinstance(step, int) or not 0 <= step < len(node):
                positions = f"its positions are 1 to {len(node)}"
                raise _NoPlaceError(f"{spelled(prefix)} is a list: {positions}")
            node = node[step]
        elif isinstance(node, dict | None):
            if isinstance(step, int):
                raise _NoPlaceError(f"{spelled(prefix) or 'the scene'} is not a list")
            node = None if node is None else node.get(step)
        else:
            raise _NoPlaceError(f"{spelled(prefix)} is not a table")
        prefix = (*prefix, step)
    return prefix


def _with_value(node: Any, path: KeyPath, value: Any, last: KeyPath) -> Any:
    """The node with a value at `path`; a new key follows `last`, if that is in the same table."""
    if not path:
        return value
    step, rest = path[0], path[1:]
    below = last[1:] if last[:1] == path[:1] else ()
    if isinstance(step, int):
        return [*node[:step], _with_value(node[step], rest, value, below), *node[step + 1 :]]
    table = node or {}
    changed = {**table, step: _with_value(table.get(step), rest, value, below)}
    if step in table or len(last) != 1 or last[0] not in table:
        return changed
    names = [name for name in changed if name != step]
    names.insert(names.index(last[0]) + 1, step)
    return {name: changed[name] for name in names}


def without(node: Any, path: KeyPath) -> Any:
    """The node without what is at `path`, if there is anything."""
    step, rest = path[0], path[1:]
    if isinstance(step, int):
        return [*node[:step], *([without(node[step], rest)] if rest else []), *node[step + 1 :]]
    if not node or step not in node:
        return node
    if rest:
        return {**node, step: without(node[step], rest)}
    return {key: item for key, item in node.items() if key != step}


def _order(path: KeyPath) -> list[tuple[int, str]]:
    return [(step, "") if isinstance(step, int) else (-1, step) for step in path]


def scene_error(message: str, line: int | None = None) -> SceneError:
    """An error of the scene as a whole."""
    return SceneError([Fault("", "", f"the scene {message}", line=line)])


# -- noted ----------------------------------------------------------------------------------------
# What has been read of a scene, and whether an edit changes it.


ABSENT: Final = object()


class Reads:
    """Places in a scene that have been read.

    What depends on these values alone is the same for every scene that has the same there.
    """

    def __init__(self) -> None:
        self._places: set[KeyPath] = set()
        self._around: set[KeyPath] = set()

    def note(self, path: KeyPath) -> None:
        """Record that the value at `path` was read, or its absence, with all that is in it."""
        if path not in self._places:
            self._places.add(path)
            self.note_presence(path)

    def note_presence(self, path: KeyPath) -> None:
        """Record that it was asked whether there is a value at `path`, whatever it is."""
        # A table around it that is added, removed or replaced may change the answer too.
        self._around.update(path[:end] for end in range(len(path) + 1))

    def touched(self, change: KeyPath) -> bool:
        """Whether a change at the path `change` concerns a recorded place: around it, at it or in
        it.
        """
        if change in self._around:
            return True
        return any(change[:end] in self._places for end in range(len(change) + 1))


def unchanged(earlier: ValidValues, now: ValidValues) -> dict[Hashable, Reads]:
    """The reads of an `earlier` scene whose values are the same `now`, by rule or builder."""
    changed = list(changes(earlier.scene.exact, now.scene.exact))
    return {
        name: reads for name, reads in earlier.reads.items() if not any(map(reads.touched, changed))
    }


def changes(then: Any, now: Any, path: KeyPath = ()) -> Iterator[KeyPath]:
    """The places at which two trees differ; parts that both share as objects are not searched."""
    if then is now:
        return
    if isinstance(then, dict) and isinstance(now, dict):
        for key in {**then, **now}:
            yield from changes(then.get(key, ABSENT), now.get(key, ABSENT), (*path, key))
    elif isinstance(then, list) and isinstance(now, list) and len(then) == len(now):
        # Of lists of different lengths positions do not correspond: the list as a whole differs.
        for place, (old, new) in enumerate(zip(then, now, strict=True)):
            yield from changes(old, new, (*path, place))
    else:
        yield path


# -- document -------------------------------------------------------------------------------------
# The content of a scene as a tree of plain values, with numbers as written, and their lines.


LONGEST_VALUE: Final = 60
"""Characters shown of a value."""

INTEGER_BITS: Final = 64
"""Bits of TOML's integers; a longer one is no size of a cam, and slow to print."""

BYTE_ORDER_MARK: Final = "\ufeff"

NOTHING: Final = (ABSENT, None)

TOML_PLACE: Final = re.compile(r" \(at (?:line (?P<line>\d+), column \d+|end of document)\)$")
"""The place that tomllib appends to its messages."""


@dataclass(frozen=True, slots=True)
class Document(Brief):
    """The values of a scene, right or wrong.

    Attributes
    ----------
    exact : the tree with each decimal number as a Decimal, exactly as written.
    plain : the same tree with floats; None stands for a value that no scene may have.
    faults : what is wrong at those places.
    bad : the paths of those places.
    lines : of the keys, if the scene came from a text.
    """

    exact: Tree
    plain: Tree
    faults: tuple[Fault, ...]
    bad: frozenset[KeyPath]
    lines: dict[KeyPath, int] = field(default_factory=dict)

    def fault(self, path: KeyPath, message: str, hint: str = "") -> Fault:
        """A fault of the value at `path`, which need not exist, with its line; the message states
        lengths in mm, the fault in the unit of the scene.
        """
        message = in_unit(message, self.unit)
        return Fault(spelled(path), written(self.exact_value(path)), message, hint, self.line(path))

    @property
    def unit(self) -> LengthUnit:
        """The unit of length, mm if it is not valid."""
        return "inch" if self.exact_value(("units", "length")) == "inch" else "mm"

    def line(self, path: KeyPath) -> int | None:
        """Line of the key at `path`, or of the nearest table or list around it."""
        return nearest_line(path, self.lines)

    def exact_value(self, path: KeyPath) -> Any:
        """The exact value at `path`, or None if there is none."""
        return tree_value(self.exact, path)

    @classmethod
    def from_values(cls, values: Mapping[str, Any]) -> Document:
        """Take values from Python, see `camgeo.scene.values.Taking`; raises SceneError as that
        does.
        """
        if not isinstance(values, Mapping):
            raise scene_error(f"must be a mapping of its tables, and not {type(values).__name__}")
        return document_of_tree(Taking().take(values))


@dataclass(frozen=True, slots=True)
class Source(Brief):
    """What a scene was made from, in addition to its values.

    Attributes
    ----------
    file : path of the scene file as given; empty without one.
    folder : in which the files lie that the scene names, absolute; None if there is none.
    text : TOML whose comments and order the scene keeps; empty if it was made from values.
    contents : of the files that the scene names, by these names, as they were read.
    """

    file: str = ""
    folder: pathlib.Path | None = None
    text: str = ""
    contents: Mapping[str, bytes] = field(default_factory=lambda: MappingProxyType({}))

    @classmethod
    def from_file(cls, file: str, folder: str | pathlib.Path | None, text: str = "") -> Self:
        """The source of a scene in `folder`, or in the folder of its file."""
        if folder is None:
            return cls(file, pathlib.Path(file).resolve().parent if file else None, text)
        return cls(file, pathlib.Path(folder).resolve(), text)

    def having(self, contents: Mapping[str, bytes]) -> Self:
        """The source with these contents of its files."""
        return replace(self, contents=MappingProxyType(dict(contents)))


def encode_scene(text: str) -> bytes:
    """The bytes of a scene's text; raises SceneError if it is none."""
    try:
        return text.encode()
    except UnicodeEncodeError as error:
        raise scene_error("is not text that UTF-8 can encode") from error


def document(data: bytes) -> Document:
    """Parse the bytes of a TOML file; raises SceneError if they are not valid TOML."""
    text = _text(data)
    try:
        check_toml(text)
    except FileError as error:
        raise scene_error(str(error)) from None
    try:
        exact = tomllib.loads(text, parse_float=Decimal)
        parsed = document_of_tree(exact, key_lines(text.replace("\r\n", "\n")))
    except tomllib.TOMLDecodeError as error:
        place = TOML_PLACE.search(str(error))
        message = TOML_PLACE.sub("", str(error))
        line = int(place["line"]) if place and place["line"] else None
        if place and line is None:
            message += " before the end of the file"
        raise scene_error(f"is not valid TOML: {message}", line) from error
    except RecursionError as error:
        raise scene_error("is nested too deeply for a scene") from error
    except (ValueError, ArithmeticError) as error:
        # Python refuses to convert an integer of more than 4300 digits.
        raise scene_error("holds a number with too many digits") from error
    if not exact:
        raise scene_error("is empty; `camgeo new` writes a scene to start from")
    return parsed


def document_of_tree(
    exact: Tree, lines: dict[KeyPath, int] | None = None, earlier: Document | None = None
) -> Document:
    """The document of a tree, which must not be changed afterwards, with the lines of its keys.

    What the tree shares with that of an `earlier` document without faults is taken from there.
    """
    troubles: dict[KeyPath, str] = {}
    known = NOTHING if earlier is None else (earlier.exact, earlier.plain)
    plain = _plain(exact, (), troubles, known)
    draft = Document(exact, plain, (), frozenset(troubles), lines or {})
    return replace(draft, faults=tuple(itertools.starmap(draft.fault, troubles.items())))


def written(value: Any) -> str:
    """Return a value as it stands in TOML, cut if it is long; nothing for a table or for None."""
    if value is None or isinstance(value, dict):
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        text = '"' + value[: LONGEST_VALUE + 1].replace("\\", "\\\\").replace('"', '\\"') + '"'
        text = "".join(c if c.isprintable() else f"\\u{ord(c):04X}" for c in text)
    elif isinstance(value, list):
        if any(isinstance(item, dict | list) for item in value):
            return ""
        text = "[" + ", ".join(written(item) for item in value[:LONGEST_VALUE]) + "]"
    elif isinstance(value, int) and value.bit_length() > INTEGER_BITS:
        text = hex(value)
    elif not isinstance(value, int | Decimal | dt.date | dt.time):
        text = f"<{type(value).__name__}>"
    else:
        text = str(value).lower().replace("infinity", "inf").replace("e+", "e")
    return text if len(text) <= LONGEST_VALUE else text[:LONGEST_VALUE] + "..."


def _text(data: bytes) -> str:
    if len(data) > SCENE.size:
        raise scene_error(f"is larger than {SCENE.size:,} bytes, too large for a scene")
    try:
        text = data.decode("utf-8").removeprefix(BYTE_ORDER_MARK)
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise scene_error("is not UTF-8 text; save it in that encoding", line) from error
    if not text.strip():
        raise scene_error("is empty; `camgeo new` writes a scene to start from")
    return text


def _trouble(value: Any) -> str:
    """Why a single value cannot be a value of any scene; empty if it can."""
    if isinstance(value, Decimal):
        if not value.is_finite():
            return "must be a finite number"
        if not abs(float(value)) < float("inf"):
            return "is too large for a number"
    elif isinstance(value, int):
        if value.bit_length() > INTEGER_BITS:
            return "is too large for a number"
    elif isinstance(value, str):
        if not value.isascii() and value != value.encode(errors="replace").decode():
            return "is not text that UTF-8 can encode"
    elif isinstance(value, dt.date | dt.time):
        return "a date or time has no place in a scene"
    else:
        return "must be text, a number, true or false, a list or a table"
    return ""


def _plain(
    value: Any, path: KeyPath, troubles: dict[KeyPath, str], known: tuple[Any, Any] = NOTHING
) -> Any:
    """The value with floats, None for what no scene may have; the reason goes into `troubles`.

    `known` is a value without troubles and what was made of it.
    """
    if len(path) > DEEPEST:
        raise RecursionError
    if value is known[0]:
        return known[1]
    if isinstance(value, dict):
        exact, plain = known if isinstance(known[0], dict) else ({}, {})
        return {
            key: _plain(item, (*path, key), troubles, (exact.get(key, ABSENT), plain.get(key)))
            for key, item in value.items()
        }
    if isinstance(value, list):
        return [_plain(item, (*path, index), troubles) for index, item in enumerate(value)]
    if trouble := _trouble(value):
        troubles[path] = trouble
        return None
    return float(value) if isinstance(value, Decimal) else value


# -- paths ----------------------------------------------------------------------------------------
# Paths of keys that a scene may have, whether or not it states them.


CONTAINERS: Final = {"object": "table", "array": "list"}
"""Types of the schema that are no single value, and their names."""


def value_path(tree: Tree, key: str) -> KeyPath:
    """The path of a single value of a scene with this tree, spelled as messages do.

    Positions are counted from 1, as in motion[2].law or motion.2.law. The path must be one that the
    schema has; the scene need not state it, but a list has no positions beyond those stated.

    Raises
    ------
    SceneError
        If there is no such key, with the nearest name; if it is a table or a list.
    """
    path = parse_path(key)
    if not path:
        raise _key_error(
            key, "is not a key of a scene; write it as messages do, e.g. motion[2].law"
        )
    node: Node = resolved(schema_for(tree).root)
    value: Any = tree
    prefix: KeyPath = ()
    for step in path:
        keys = table_keys(node, value if isinstance(value, dict) else {})
        if isinstance(value, list) or "items" in node:
            prefix = (*prefix, _position(key, step, value, prefix))
            node, value = resolved(node.get("items", {})), value[prefix[-1]]
            continue
        if isinstance(step, int):
            raise _key_error(key, f"{_name(prefix)} is not a list")
        if keys and step not in keys:
            hint = meant(spelled((*prefix, step)), [spelled((*prefix, name)) for name in keys])
            raise _key_error(
                key, f"is not a key of a scene; {_name(prefix)} has {listed(sorted(keys))}", hint
            )
        if not keys and prefix and _single(node):
            raise _key_error(key, f"is not a key of a scene; {_name(prefix)} is a single value")
        prefix = (*prefix, step)
        node = resolved(keys.get(step, {}))
        value = value.get(step) if isinstance(value, dict) else None
    kind = CONTAINERS.get(str(node.get("type"))) or _container(value)
    if kind is not None:
        example = "one of its keys" if kind == "table" else "a position in it"
        raise _key_error(
            key, f"is a {kind}: name {example}, as {spelled(prefix)}{_example_step(node, kind)}"
        )
    return prefix


def _position(key: str, step: str | int, value: Any, found: KeyPath) -> int:
    """The position of a list that a step names, from 0; it may be written as a name."""
    if isinstance(step, str) and step.isdecimal():
        step = int(step) - 1
    count = len(value) if isinstance(value, list) else 0
    if not isinstance(step, int) or not 0 <= step < count:
        positions = f"its positions are 1 to {count}" if count else "the scene states none of it"
        raise _key_error(key, f"{_name(found)} is a list: {positions}")
    return step


def _name(path: KeyPath) -> str:
    return spelled(path) or "the scene"


def _single(node: Node) -> bool:
    return node.get("type") in ("number", "integer", "string", "boolean") or "enum" in node


def _container(value: Any) -> str | None:
    return "table" if isinstance(value, dict) else "list" if isinstance(value, list) else None


def _example_step(node: Node, kind: str) -> str:
    """An example of what may follow the name of a table or a list in a key."""
    if kind == "list":
        return "[1]"
    return "." + next(iter(table_keys(node, {})), "KEY")


def _key_error(key: str, message: str, hint: str = "") -> SceneError:
    return SceneError([Fault(key, "", message, hint)])


# -- schema faults ---------------------------------------------------------------------------------
# The faults of a scene against its schema, in terms that a designer uses.


UNKNOWN: Final = "additionalProperties"
"""What the validator calls an unknown key."""

MOST_FAULTS: Final = 1000
"""Most faults reported of one scene; a file with more is probably not a scene."""


@dataclass(frozen=True, slots=True)
class SchemaVerdict:
    """The faults of a scene against the schema.

    Attributes
    ----------
    faults : in words.
    bad : paths of the values that are at fault; no conclusions may be drawn from them.
    meant : paths of missing keys that a misspelt key was meant to be.
    """

    faults: tuple[Fault, ...]
    bad: frozenset[KeyPath]
    meant: frozenset[KeyPath]


def check_schema(scene: Document, schema: Composed) -> SchemaVerdict:
    """Check a document against a schema, which for a scene is that of what it names."""
    schema_errors = itertools.islice(schema.validator.iter_errors(scene.plain), MOST_FAULTS)
    errors = [(tuple(error.instance_path), error, _failing_node(schema.root, error.evaluation_path))
              for error in schema_errors]  # fmt: skip
    faults: list[Fault] = []
    bad = set(scene.bad)
    meant: set[KeyPath] = set()
    excused: set[KeyPath] = set()
    # Unknown keys first: one of them may be a misspelt key that is missing.
    for path, error, node in sorted(errors, key=lambda failed: failed[1].kind.name != UNKNOWN):
        if error.kind.name == UNKNOWN:
            for name in error.kind.as_dict()["unexpected"][:MOST_FAULTS]:
                fault, known, sibling = _unknown_key(scene, path, name, node)
                faults.append(fault)
                bad.add((*path, name))
                meant |= {(*path, known)} if known else set()
                excused |= {path} if sibling else set()
        elif error.kind.name == "required":
            name = str(error.kind.as_dict()["property"])
            bad.add((*path, name))
            if (*path, name) not in meant and path not in excused:
                faults.append(_missing(scene, (*path, name), node))
        elif path not in scene.bad:
            bad.add(path)
            fault = _refusal(scene, path, error, node)
            if fault not in faults:
                faults.append(fault)
    if len(errors) == MOST_FAULTS or len(faults) >= MOST_FAULTS:
        # Errors beyond the limit were not examined, so any value may be wrong: the path () makes
        # the whole scene count as not valid, and no rule draws conclusions.
        bad.add(())
        faults = [
            *faults[:MOST_FAULTS],
            Fault("", "", "there are more faults than are listed here"),
        ]
    return SchemaVerdict(tuple(faults), frozenset(bad), frozenset(meant))


def _failing_node(root: Node, evaluation: list[str | int]) -> Node:
    """The schema node whose last keyword failed, by the validator's evaluation path from `root`."""
    node: Any = root
    for step in evaluation[:-1]:
        node = referred(node) if step == "$ref" else node[step]
    return node if isinstance(node, dict) else {}


def _missing(scene: Document, path: KeyPath, table: Node) -> Fault:
    node = resolved(table.get("properties", {}).get(path[-1], {}))
    return scene.fault(path, f"is missing: {node.get('description', 'it is needed')}".rstrip("."))


def _refusal(scene: Document, path: KeyPath, error: ValidationError, node: Node) -> Fault:
    value = scene.exact_value(path)
    hint = ""
    choices: list[Any] = node.get("enum") or node.get("x-values") or []
    values = [str(item) for item in choices]
    if isinstance(value, str):
        close = node.get("x-hints", {}).get(value) or meant(value, values, '"')
        if close:
            hint = close
        elif error.kind.name == "type" and _reads_as_number(value):
            hint = "leave out the quotes"
    known = {
        "x-allowed",
        "enum",
        "type",
    } & node.keys()  # a declaration of another distribution may have none
    return scene.fault(path, allowed(node) if known else str(error.message), hint)


def _unknown_key(scene: Document, path: KeyPath, name: str, node: Node) -> tuple[Fault, str, bool]:
    """The fault, the key of the same table that was meant, and whether a sibling's key was."""
    place = (*path, name)
    if "x-unknown" in node:
        return scene.fault(place, node["x-unknown"]), "", False
    siblings = [definition(sibling) for sibling in node.get("x-siblings", [])]
    for sibling in siblings:
        if name in sibling["properties"]:
            message = f"belongs to {sibling['title']}; this is {node['title']}"
            return scene.fault(place, message), "", False
    table: Any = scene.exact_value(path)
    free = [key for key in node["properties"] if key not in table]
    known = nearest(name, free)
    if known:
        return scene.fault(place, "is not a known key", meant(name, free)), known, False
    for sibling in siblings:
        hint = meant(name, sibling["properties"])
        if hint:
            return scene.fault(place, "is not a known key", hint), "", True
    if path and name in schema()["properties"]:
        message = f"belongs to the top of the file; it stands in [{quoted(str(path[0]))}] here"
        return scene.fault(place, message), "", False
    keys = ", ".join(node["properties"]) or "none"
    return scene.fault(place, f"is not a known key; known here: {keys}"), "", False


def _reads_as_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


# -- varied ----------------------------------------------------------------------------------------
# What may vary in a family of designs, and what values it may take: the one definition, for tables
# of a scene as for the options of commands.


Value = int | float | str | bool
"""A value at a key of a scene, in the units of the scene."""

Rows = Sequence[tuple[Value, ...]]
"""Values of a list, each for all keys that are tied together."""

SWEEP: Final = "sweep"
OPTIMISE: Final = "optimise"
FAMILIES: Final = (SWEEP, OPTIMISE)
"""Tables of the scene that state families; no design of a family has them."""

LARGEST_WHOLE: Final = 2**53
"""Whole numbers below it are written without a fraction, as a key for a whole number needs."""


def plain(number: float) -> int | float:
    """The number, as an integer if it is whole."""
    if number.is_integer() and abs(number) < LARGEST_WHOLE:
        return int(number)
    return number


def design_path(tree: Tree, key: str, seen: set[str]) -> KeyPath:
    """The path of a key that varies, which is added to those `seen`.

    Raises
    ------
    SceneError
        For a key that there is not, with the nearest one.
    GeometryError
        If no design has the key, or it is among those that vary already.
    """
    path = value_path(tree, key)
    if path[0] in FAMILIES:
        raise GeometryError("is not a key of a design", key)
    name = spelled(path)
    if name in seen:
        raise GeometryError("varies twice", name)
    seen.add(name)
    return path


def faults_of_range(start: Decimal, stop: Decimal, count: int | None) -> Iterator[tuple[str, str]]:
    """What is wrong with a range of `count` numbers, None for any number: the key of its table that
    is at fault, and why.
    """
    if count is not None and count < 1:
        yield "count", "is an empty range: there must be at least 1 number"
    elif start == stop and count != 1:
        yield "to", "is an empty range: both ends are the same"
    elif start != stop and count == 1:
        yield "count", "is one number for two ends: there must be at least 2"
    elif not all(math.isfinite(float(number)) for number in (start, stop, stop - start)):
        yield "to", "is too large a number"


def variable_rows(values: Sequence[Any], keys: int) -> Rows:
    """The values of a list in a table of a scene; a single one is for all tied keys."""
    rows = ((entry if isinstance(entry, tuple | list) else (entry,) * keys) for entry in values)
    return [tuple(_value(value) for value in row) for row in rows]


def faults_of_list(rows: Rows, keys: int) -> Iterator[tuple[int, str]]:
    """What is wrong with a list: at which place, from 0, and why."""
    seen = set()
    for place, row in enumerate(rows):
        if len(row) != keys:
            yield place, f"must have a value for each of {keys} keys"
        if any(isinstance(value, str) and not _encodable(value) for value in row):
            yield place, "has a text that UTF-8 cannot encode"
        if repr(row) in seen:
            yield place, "is listed twice"
        seen.add(repr(row))


def variable_keys(table: Mapping[str, Any]) -> tuple[str, ...]:
    """The keys of a variable that a table of a scene states."""
    return tuple(table["keys"]) if "keys" in table else (table["key"],)


def _value(value: Any) -> Value:
    if isinstance(value, Decimal | float):
        return plain(float(value))
    single: Value = value
    return single


def _encodable(text: str) -> bool:
    """Whether UTF-8, in which scenes and stores are written, has a form of the text."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True
