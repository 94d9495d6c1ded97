"""The error tree: wrong input raises, a poor design is a `Finding` (see `camgeo.check.finding`).

Every class also derives from the built-in error that it specialises, so that callers that do not
know camgeo can catch it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import KW_ONLY, dataclass
from typing import Any

from camgeo.units import LengthUnit, counted, in_unit


class CamgeoError(Exception):
    """Root of all errors that camgeo raises on purpose; each can be pickled, as pools require."""

    def restate(self, unit: LengthUnit) -> None:
        """Put the lengths in its texts into the unit of a scene; other attributes stay in mm."""
        self.args = tuple(
            in_unit(argument, unit) if isinstance(argument, str) else argument
            for argument in self.args
        )
        for name in ("message", "reason"):
            if isinstance(text := getattr(self, name, None), str):
                setattr(self, name, in_unit(text, unit))

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (type(self), self.args), self.__dict__


def _again(kind: type[CamgeoError], arguments: tuple[Any, ...]) -> CamgeoError:
    """An error created without its class's `__init__`, whose results are in its state."""
    return kind.__new__(kind, *arguments)


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing that is wrong in a scene.

    Attributes
    ----------
    key : path of the key, e.g. ``motion[2].span``; empty for the file as a whole.
    value : what was given, as written; empty if nothing was given.
    message : what is wrong and what is allowed, one sentence without the key.
    hint : a suggestion ("did you mean ..."), or empty.
    line : line in the file, counted from 1, or None if it is not known.
    """

    key: str
    value: str
    message: str
    hint: str = ""
    line: int | None = None

    def __str__(self) -> str:
        place = f"line {self.line}: " if self.line is not None else ""
        value = f" = {self.value}" if self.value else ""
        name = f"{self.key}{value}: " if self.key else ""
        hint = f" ({self.hint})" if self.hint else ""
        return f"{place}{name}{self.message}{hint}"


class SceneError(CamgeoError, ValueError):
    """The scene is invalid; it reports all its faults at once, and nothing is written."""

    def __init__(self, faults: tuple[Fault, ...] | list[Fault], file: str = "") -> None:
        self.faults = tuple(faults)
        self.file = file
        head = f"{file}: " if file else ""
        lines = "\n".join(f"  {fault}" for fault in self.faults)
        super().__init__(f"{head}{counted(len(self.faults), 'fault')}\n{lines}")


class GeometryError(CamgeoError, ValueError):
    """The mechanism or the curve does not exist as asked, e.g. a linkage that cannot close.

    Raised by the stages below the scene, with the key names of the scene in the message; the scene
    loader turns it into a `SceneError`.
    """

    def __init__(self, message: str, key: str = "", value: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.key = key
        self.value = value

    def __str__(self) -> str:
        return str(Fault(self.key, self.value, self.message))


class UndercutError(GeometryError):
    """A contour was requested of a flank with a cusp or undercut, which is no outline of a disc."""


class UnsafeError(GeometryError):
    """A milling program would damage part, tool or machine, or drop what it cuts free."""


class ToleranceError(CamgeoError, ArithmeticError):
    """A contour or file cannot be brought within the tolerance.

    Attributes
    ----------
    reason : what cannot follow which curve.
    asked : tolerance requested [mm].
    reached : smallest deviation reached [mm].
    """

    def __init__(self, message: str, asked: float, reached: float) -> None:
        least, most = distinct_texts(asked, reached)
        super().__init__(f"{message}: tolerance {least} mm requested, {most} mm reached")
        self.reason = message
        self.asked = asked
        self.reached = reached


class FileError(CamgeoError, ValueError):
    """A file cannot be used: damaged, not what its writer makes, or beyond what is allowed of a
    file that is read (`camgeo.reading`).
    """


class OutputError(CamgeoError, OSError):
    """A file could not be written; files of the set already written have been removed."""


class CycleError(CamgeoError, RecursionError):
    """Quantities depend on each other in a cycle.

    Attributes
    ----------
    way : from a quantity through what it depends on back to itself.
    """

    def __init__(self, way: tuple[str, ...]) -> None:
        self.way = way
        super().__init__(f"depends on itself: {' -> '.join(way)}")


class VersionError(CamgeoError, ValueError):
    """A pickle is from another version of camgeo and is not read."""


class Cancelled(CamgeoError, RuntimeError):
    """A computation was cancelled before it was done."""


class UnknownNameError(CamgeoError, KeyError):
    """There is no effect, format, plot, ... of the name asked for.

    Attributes
    ----------
    message : the name, the names that there are, and the nearest one if it is near.
    name : that was asked for.
    names : that there are.
    """

    def __init__(self, what: str, name: str, names: Iterable[str]) -> None:
        self.name = name
        self.names = tuple(names)
        hint = meant(name, self.names, '"')
        self.message = f'there is no {what} "{name}"' + (f" ({hint})" if hint else "")
        self.message += f"; there are {', '.join(self.names)}"
        super().__init__(self.message)

    def __str__(self) -> str:
        return self.message  # a KeyError would put it in quotes


@dataclass(eq=False, repr=False)
class EffectError(CamgeoError, ArithmeticError):
    """An effect has no answer for this design, e.g. a follower that jams has no contact force.

    Attributes
    ----------
    message : one sentence, with value, limit and place.
    finding : name of the finding that reports it; empty for the effect's own.
    value, limit, unit, cam_angle, cam_range : as of `camgeo.check.finding.Finding`.
    """

    message: str
    _: KW_ONLY
    finding: str = ""
    value: float | None = None
    limit: float | None = None
    unit: str = ""
    cam_angle: float | None = None
    cam_range: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        super().__init__(self.message)


def distinct_texts(one: float, other: float) -> tuple[str, str]:
    """Two numbers with as many digits as it takes to see which is larger, six at least."""
    pairs = [(f"{one:.{digits}g}", f"{other:.{digits}g}") for digits in range(6, 18)]
    return next((pair for pair in pairs if pair[0] != pair[1]), pairs[0])


def unreadable(error: Exception) -> str:
    """Why a file cannot be read or written; a path that no file can have is a ValueError."""
    return getattr(error, "strerror", None) or str(error)


def nearest(word: str, words: Iterable[str]) -> str:
    """Return the word that was probably meant, or nothing."""
    import difflib  # only errors need it

    by_lower = {item.lower(): item for item in words}
    close = difflib.get_close_matches(word[:100].lower(), by_lower, n=1)
    return by_lower[close[0]] if close else ""


def meant(word: str, words: Iterable[str], mark: str = "") -> str:
    """The hint that one of `words` was probably meant, enclosed in `mark`; or nothing."""
    near = nearest(word, words)
    return f"did you mean {mark}{near}{mark}?" if near else ""
