"""The result of verifying a file: checks, each with its value and its limit, and a verdict.

Verifiers register as entry points of the group ``camgeo.verifiers``; the entry point's name is the
ending of the files that it reads, without the dot, and it loads an object that is a `Verifier`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Protocol

from camgeo.formats.format import LARGEST_TOLERANCE, SMALLEST_TOLERANCE
from camgeo.product.product import Product
from camgeo.reading import number_of
from camgeo.units import LengthUnit
from camgeo.writing.write import KIND


@dataclass(frozen=True, slots=True)
class Check:
    """One thing that was checked.

    Attributes
    ----------
    name : what was checked, e.g. "deviation".
    of : the boundary or operation checked; empty for the whole file.
    value : what was found; None if it could not be determined.
    expected : what it should be; None if only `limit` bounds it.
    limit : largest value, or largest difference from `expected`; None if it must be equal.
    unit : of the numbers, or empty.
    ok : whether it passes; None for information only.
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

    def record(self) -> dict[str, Any]:
        """As data; what is empty is left out."""
        fields = {key: getattr(self, key) for key in ("of", "value", "expected", "limit", "unit")}
        kept = {key: value for key, value in fields.items() if value not in ("", None)}
        end = {"note": self.note} if self.note else {}
        return {"name": self.name, **kept, "ok": self.ok, **end}


def at_most(
    name: str, value: float, limit: float, unit: str, of: str = "", note: str = ""
) -> Check:
    """The check that `value` does not exceed `limit`; NaN and infinity fail, and are not shown."""
    kept = value if math.isfinite(value) else None
    return Check(name, of, kept, None, limit, unit, value <= limit, note)


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


def unit_check(unit: str, reading: Reading, ours: str, note: str) -> Check:
    """The unit of a file, which must be `ours` if camgeo wrote it, else the user's."""
    if reading.ours:
        return equal("unit", unit, ours, note=note)
    if reading.unit is not None:
        return equal("unit", unit, reading.unit, note="the file is not in the unit of --unit")
    return reported("unit", unit)


def failed(name: str, note: str, of: str = "") -> Check:
    """A check that could not even be measured, and why."""
    return Check(name, of, ok=False, note=note)


@dataclass(frozen=True, slots=True)
class Origin:
    """What a file states about itself.

    Attributes
    ----------
    ours : whether it states that camgeo wrote it.
    scene : hash of the scene that it names, or its first digits; empty if it names none.
    tolerance : [mm] that it names, or None.
    damage : why it cannot be read at all; empty if it can.
    """

    ours: bool = False
    scene: str = ""
    tolerance: float | None = None
    damage: str = ""


def length_of(text: str) -> float | None:
    """The tolerance in `text` [mm], e.g. "0.001" or "0.001 mm"; None if no file can have it."""
    value = number_of(text.strip().removesuffix("mm"))
    return value if value is not None and SMALLEST_TOLERANCE <= value <= LARGEST_TOLERANCE else None


@dataclass(frozen=True, slots=True)
class Reading:
    """How to read a file.

    Attributes
    ----------
    name : of the file, for messages.
    ours : whether camgeo wrote it; then it must hold everything that our writer puts in.
    layer : the one read in a drawing; None for CUT if it exists, else for all layers.
    unit : of the file if it does not state one; None if the user has not given it either.
    origin : of a drawing: where the cam axis lies in its axes [mm].
    """

    name: str
    ours: bool
    layer: str | None = None
    unit: LengthUnit | None = None
    origin: complex = 0j


class Verifier(Protocol):
    """Reads one format and compares it with a design."""

    @property
    def format(self) -> str:
        """Name of the format."""

    def origin(self, data: bytes) -> Origin:
        """What the file states about itself; raises nothing."""

    def checks(
        self, product: Product, data: bytes, reading: Reading, tolerance: float
    ) -> tuple[Check, ...]:
        """All checks, against `tolerance` [mm]; what cannot be measured fails."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """One file with all its checks.

    Attributes
    ----------
    file : its name.
    format : name of its format.
    sha256 : of its bytes, hexadecimal.
    size : in bytes.
    scene : name and hash of the scene it was compared with; empty if it was not measured.
    tolerance : [mm] that applied, and where it is from; None if it was not measured.
    checks : in the order of the report.
    crashed : whether an error in camgeo itself, not the file, prevented the verdict.
    length : unit of the scene, in which the checks are told.
    """

    file: str
    format: str
    sha256: str
    size: int
    scene: tuple[str, str]
    tolerance: tuple[float, str] | None
    checks: tuple[Check, ...]
    crashed: bool = False
    length: LengthUnit = "mm"

    @property
    def passed(self) -> bool:
        """True if nothing fails."""
        return all(check.ok is not False for check in self.checks)

    @property
    def measured(self) -> bool:
        """True if it was compared with its scene."""
        return self.tolerance is not None

    @property
    def deviation(self) -> float | None:
        """Largest proved deviation [mm]; None if one could not be proved, or there is none."""
        found = [check.value for check in self.checks if check.name == "deviation"]
        numbers = [value for value in found if isinstance(value, float)]
        return max(numbers) if numbers and len(numbers) == len(found) else None

    def record(self) -> dict[str, Any]:
        """As data."""
        record: dict[str, Any] = {
            "file": self.file,
            "format": self.format,
            "sha256": self.sha256,
            "bytes": self.size,
        }
        if self.tolerance is not None:
            name, sha256 = self.scene
            record["scene"] = {"name": name, "sha256": sha256}
            record["tolerance_mm"], record["tolerance_from"] = self.tolerance
            record["deviation_mm"] = self.deviation
        return record | {
            "passed": self.passed,
            "checks": [check.record() for check in self.checks],
        }


def document(version: str, verdicts: tuple[Verdict, ...]) -> dict[str, Any]:
    """All verdicts as data: what the certificate holds and what `--json` prints."""
    return {
        "kind": KIND,
        "camgeo": version,
        "passed": all(verdict.passed for verdict in verdicts),
        "files": [verdict.record() for verdict in verdicts],
    }
