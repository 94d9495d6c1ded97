"""Errors of camgeo: wrong input raises; a poor design has findings, see `camgeo.check.finding`.

Every class also derives from the built-in error that it specialises, so that callers that do not
know camgeo can catch it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import KW_ONLY, dataclass
from typing import Any

from camgeo.units import LengthUnit, counted, in_unit


class CamgeoError(Exception):
    """Base of all errors that camgeo raises on purpose; they can be pickled, as pools require."""

    def restate(self, unit: LengthUnit) -> None:
        """Convert the lengths in the texts to the unit of a scene; other attributes stay in mm."""
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
    """An unpickled error: `__init__` is not called again, as its results are in the state."""
    return kind.__new__(kind, *arguments)


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing that is wrong in a scene.

    Attributes
    ----------
    key : path of the key, e.g. ``motion[2].span``; empty for the file as a whole.
    value : the stated value as written; empty if none was stated.
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
    """The requested mechanism or curve does not exist, e.g. because a linkage cannot close.

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
    """A contour was requested of a flank with a cusp or undercut, which cannot bound a disc."""


class UnsafeError(GeometryError):
    """A milling program would damage part, tool or machine, or let a cut-off piece drop."""


class ToleranceError(CamgeoError, ArithmeticError):
    """A contour or file cannot be brought within the tolerance.

    Attributes
    ----------
    reason : which contour cannot follow which curve.
    asked : requested tolerance [mm].
    reached : smallest deviation reached [mm].
    """

    def __init__(self, message: str, asked: float, reached: float) -> None:
        least, most = distinct_texts(asked, reached)
        super().__init__(f"{message}: tolerance {least} mm requested, {most} mm reached")
        self.reason = message
        self.asked = asked
        self.reached = reached


class FileError(CamgeoError, ValueError):
    """A file cannot be used: it is damaged, of another kind, or exceeds the limits for files that
    are read (`camgeo.reading`).
    """


class OutputError(CamgeoError, OSError):
    """A file could not be written; files of the set already written have been removed."""


class CycleError(CamgeoError, RecursionError):
    """Quantities depend on each other in a cycle.

    Attributes
    ----------
    way : names of the quantities from the first through its dependencies back to itself.
    """

    def __init__(self, way: tuple[str, ...]) -> None:
        self.way = way
        super().__init__(f"depends on itself: {' -> '.join(way)}")


class VersionError(CamgeoError, ValueError):
    """A pickle is from another version of camgeo and is not read."""


class Cancelled(CamgeoError, RuntimeError):
    """A computation was cancelled before it had finished."""


class UnknownNameError(CamgeoError, KeyError):
    """There is no effect, format, plot, ... of the requested name.

    Attributes
    ----------
    message : states the name, the most similar one if any, and all that exist.
    name : the requested name.
    names : all names that exist.
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
    """An effect has no result for this design, e.g. no contact force for a follower that jams.

    Attributes
    ----------
    message : one sentence, with value, limit and place.
    finding : name of the finding that reports the error; empty for the one named like the effect.
    value, limit, unit, cam_angle, cam_range : as in `camgeo.check.finding.Finding`.
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
    """Two numbers as texts, with at least six digits and as many as show which one is larger."""
    # 17 digits distinguish any two doubles.
    pairs = [(f"{one:.{digits}g}", f"{other:.{digits}g}") for digits in range(6, 18)]
    return next((pair for pair in pairs if pair[0] != pair[1]), pairs[0])


def unreadable(error: Exception) -> str:
    """Why a file cannot be read or written, from an OSError, or a ValueError for an impossible
    path.
    """
    return getattr(error, "strerror", None) or str(error)


def nearest(word: str, words: Iterable[str]) -> str:
    """The word that was probably meant; empty if none is similar."""
    import difflib  # only errors need it

    by_lower = {item.lower(): item for item in words}
    close = difflib.get_close_matches(word[:100].lower(), by_lower, n=1)
    return by_lower[close[0]] if close else ""


def meant(word: str, words: Iterable[str], mark: str = "") -> str:
    """The hint that one of `words` was probably meant, between two `mark`s; empty if none was."""
    near = nearest(word, words)
    return f"did you mean {mark}{near}{mark}?" if near else ""
