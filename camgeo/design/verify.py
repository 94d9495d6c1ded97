"""Checks of a file that is verified, each with value and limit, and the protocol of a verifier.

Verifiers register as entry points of the group ``camgeo.verifiers``; the entry point's name is the
ending of the files that it reads, without the dot, and it loads an object that is a `Verifier`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Protocol

from camgeo.design.product import Product
from camgeo.reading import parse_number
from camgeo.scene.formats.format import LARGEST_TOLERANCE, SMALLEST_TOLERANCE
from camgeo.units import LengthUnit, in_unit


@dataclass(frozen=True, slots=True)
class Check:
    """The result of one check of a file.

    Attributes
    ----------
    name : name of the checked property, e.g. "deviation".
    of : the boundary or operation checked; empty for the whole file.
    value : value in the file; None if it could not be determined.
    expected : value that it should be; None if only `limit` bounds it.
    limit : largest value, or largest difference from `expected`; None if it must be equal.
    unit : unit of the numbers, or empty.
    ok : whether the check passes; None for information only.
    note : a sentence or a place, or empty.
    """

    name: str
    of: str = ""
    value: float | str | None = None
    expected: float | str | None = None
    limit: float | None = None
    unit: str = ""
    ok: bool | None = None
    note: str = ""

    def in_unit(self, length: LengthUnit) -> Check:
        """The check with the lengths in its texts in the unit of a scene; its numbers remain."""
        fields = ((name, getattr(self, name)) for name in ("of", "value", "expected", "note"))
        texts: dict[str, Any] = {
            name: in_unit(text, length) for name, text in fields if isinstance(text, str)
        }
        return replace(self, **texts)

    def record(self) -> dict[str, Any]:
        """The check as data for JSON; fields that are empty are left out."""
        fields = {key: getattr(self, key) for key in ("of", "value", "expected", "limit", "unit")}
        stated = {key: value for key, value in fields.items() if value not in ("", None)}
        end = {"note": self.note} if self.note else {}
        return {"name": self.name, **stated, "ok": self.ok, **end}


def at_most(
    name: str, value: float, limit: float, unit: str, of: str = "", note: str = ""
) -> Check:
    """The check that `value` does not exceed `limit`; NaN and infinity fail, and are not shown."""
    finite_value = value if math.isfinite(value) else None
    return Check(name, of, finite_value, None, limit, unit, value <= limit, note)


def near(
    name: str, value: float, expected: float, limit: float, unit: str, of: str = "", note: str = ""
) -> Check:
    """The check that `value` is `expected` to within `limit`."""
    return Check(name, of, value, expected, limit, unit, abs(value - expected) <= limit, note)


def equal(
    name: str, value: float | str, expected: float | str, of: str = "", note: str = ""
) -> Check:
    """The check that `value` is `expected`; the note says what it means if it is not."""
    ok = value == expected
    return Check(name, of, value, expected, None, "", ok, "" if ok else note)


def reported(name: str, value: float | str, unit: str = "", of: str = "", note: str = "") -> Check:
    """A figure reported without a requirement."""
    return Check(name, of, value, None, None, unit, None, note)


def unit_check(unit: str, reading: ReadingOptions) -> Check:
    """The unit of a file, which must be the user's if one is given."""
    if reading.unit is not None:
        return equal("unit", unit, reading.unit, note="the file has another unit than --unit")
    return reported("unit", unit)


def failed(name: str, note: str, of: str = "") -> Check:
    """A check whose value could not be measured; `note` says why."""
    return Check(name, of, ok=False, note=note)


@dataclass(frozen=True, slots=True)
class Origin:
    """What a file states about itself.

    Attributes
    ----------
    version : version of camgeo, if the file states that camgeo wrote it; else empty.
    scene : hash of the scene that it names, or its first digits; empty if it names none.
    tolerance : tolerance that it names [mm], or None.
    damage : why it cannot be read at all; empty if it can.
    format : format that it was written in, if that is not the verifier's.
    """

    version: str = ""
    scene: str = ""
    tolerance: float | None = None
    damage: str = ""
    format: str = ""


def parse_tolerance(text: str) -> float | None:
    """The tolerance in `text` [mm], e.g. "0.001" or "0.001 mm"; None if no file can have it."""
    value = parse_number(text.strip().removesuffix("mm"))
    return value if value is not None and SMALLEST_TOLERANCE <= value <= LARGEST_TOLERANCE else None


@dataclass(frozen=True, slots=True)
class ReadingOptions:
    """How to read a file.

    Attributes
    ----------
    name : name of the file, for messages.
    layer : the layer to read in a drawing; None for CUT if it exists, else for all layers.
    unit : unit of a file that does not state one; None if the user has not given it either.
    origin : place of the cam axis in the axes of a drawing [mm].
    """

    name: str
    layer: str | None = None
    unit: LengthUnit | None = None
    origin: complex = 0j


class Verifier(Protocol):
    """Reads one format and compares it with a design."""

    @property
    def format(self) -> str:
        """Name of the format."""

    @property
    def slack(self) -> float:
        """Largest difference of numbers in two files of one scene, as a share of their size, if
        different processors have computed them.
        """

    def tokens(self, data: bytes) -> Iterator[tuple[str, str]]:
        """The words and numbers of a file that is not damaged, each with its place."""

    def origin(self, data: bytes) -> Origin:
        """What the file states about itself; raises nothing."""

    def checks(
        self, product: Product, data: bytes, reading: ReadingOptions, tolerance: float
    ) -> tuple[Check, ...]:
        """All checks of a file of any origin, against `tolerance` [mm]; what cannot be measured
        fails.
        """
