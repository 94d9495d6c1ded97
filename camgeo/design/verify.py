"""Files compared with their certificate, their scene, and what camgeo writes of it."""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib.metadata import entry_points
from itertools import zip_longest
from pathlib import Path
from typing import Any, Final, Protocol

from camgeo.design.product import Product, disc_of
from camgeo.design.writing import (
    CERTIFICATE,
    KIND,
    find_writer,
    interrupted,
    is_verification,
    pieces_of,
    write_set,
)
from camgeo.errors import CamgeoError, Fault, FileError, SceneError, unreadable
from camgeo.reading import CERTIFICATE as CERTIFIED
from camgeo.reading import VERIFIED, number_of, read_within
from camgeo.scene.formats.format import LARGEST_TOLERANCE, SMALLEST_TOLERANCE
from camgeo.units import LengthUnit, in_unit

GROUP: Final = "camgeo.verifiers"

LONGEST_NOTE: Final = 200
"""Characters of an unexpected error in a note."""

SHORT: Final = 16
"""Digits of a hash that are shown."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """What the user asks for.

    Attributes
    ----------
    tolerance : [mm], or None for what the files, their certificate or the scene state.
    layer, unit, origin : as of `Reading`.
    """

    tolerance: float | None = None
    layer: str | None = None
    unit: LengthUnit | None = None
    origin: complex = 0j


@dataclass(frozen=True, slots=True)
class Against:
    """What files are compared with.

    Attributes
    ----------
    discs : of the design, the main one first.
    tolerance : of its scene [mm].
    hash_before : hash of the scene's text, which files of earlier versions name; empty if it has
        no text.
    """

    discs: Sequence[Product]
    tolerance: float
    hash_before: str = ""

    def hash_like(self, named: str) -> str:
        """The scene's hash: that of its text if a file or certificate names that one."""
        before = self.hash_before
        return before if named and before.startswith(named) else self.discs[0].scene_hash


Scenes = Callable[[Path, str], Against]
"""Folder of a file, and the hash of its scene, or its first digits, or nothing -> the design;
raises SceneError if it is not found."""


def endings() -> tuple[str, ...]:
    """Endings of the files that can be verified, sorted, with their dots."""
    return tuple(f".{name}" for name in sorted(entry_points(group=GROUP).names))


def _ending(path: Path) -> str:
    """The end of a file's name that is one of `endings`, the longest; else its suffix."""
    known = [each for each in endings() if path.name.lower().endswith(each)]
    return path.name[-len(max(known, key=len)) :] if known else path.suffix


def files_in(folder: Path) -> tuple[Path, ...]:
    """The files of `folder` that can be verified or that its certificate names, sorted."""
    known = endings()
    found = {p for p in folder.iterdir() if p.name.lower().endswith(known) and p.is_file()}
    certificate = certificate_in(folder)
    named = certificate.hashes if certificate is not None else {}
    return tuple(sorted(found | {folder / name for name in named if Path(name).name == name}))


def verify_files(paths: tuple[Path, ...], scenes: Scenes, wanted: Wanted) -> tuple[Verdict, ...]:
    """One verdict per file; a fault in one file does not affect the verdicts on the others.

    Raises
    ------
    SceneError
        If no file can be judged except by its bytes, because its format cannot be read, or its
        scene is not found or wrong.
    """
    certificates = {folder: certificate_in(folder) for folder in {path.parent for path in paths}}
    verdicts: list[Verdict] = []
    refused: list[SceneError] = []
    judged = False
    for path in paths:
        verifier: Verifier | None = None
        try:
            certificate = certificates[path.parent]
            verifier = _verifier(path, certificate)
            verdict = _verdict(path, verifier, certificate, scenes, wanted)
            judged = judged or verifier is not None
        except SceneError as error:
            refused.append(error)
            message = "; ".join(map(str, error.faults))
            verdict = _unread(path, verifier, failed("scene", message))
        except Exception as error:  # the net: a fault of ours in one file must not hide the others
            what = " ".join(f"{type(error).__name__}: {error}".split())[:LONGEST_NOTE]
            note = f"cannot be read: internal error ({what}); please report it with the file"
            verdict = replace(_unread(path, verifier, failed("file", note)), crashed=True)
            judged = True
        verdicts.append(verdict)
    if refused and not judged:
        raise refused[0]
    return tuple(verdicts)


def _unread(path: Path, verifier: Verifier | None, check: Check) -> Verdict:
    """The verdict on a file that was not read; `check` says why."""
    return Verdict(path.name, _format(path, verifier), "", 0, ("", ""), None, (check,))


def _format(path: Path, verifier: Verifier | None) -> str:
    """The name of its format; its ending if it has no verifier."""
    return _ending(path).removeprefix(".").lower() if verifier is None else verifier.format


def _verifier(path: Path, certificate: Certificate | None) -> Verifier | None:
    """The verifier of a file, by its ending or by the format that its certificate names."""
    found = entry_points(group=GROUP, name=_ending(path).removeprefix(".").lower())
    if found:
        verifier: Verifier = next(iter(found)).load()
        return verifier
    form = "" if certificate is None else certificate.formats.get(path.name, "")
    known = (entry.load() for entry in entry_points(group=GROUP)) if form else ()
    return next((each for each in known if each.format == form), None)


def _verdict(
    path: Path,
    verifier: Verifier | None,
    certificate: Certificate | None,
    scenes: Scenes,
    wanted: Wanted,
) -> Verdict:
    certified = certificate is not None and path.name in certificate.hashes
    if verifier is None and not certified:
        allowed = ", ".join(endings())
        message = f"the name must end in one of {allowed}, unless {CERTIFICATE} here names the file"
        message = message if os.path.lexists(path) else "there is no such file or folder"
        raise SceneError([Fault("FILE", str(path), message)])
    try:
        data, size, sha256 = _contents(path, verifier)
    except FileError as error:
        return _unread(path, verifier, failed("file", str(error)))
    except (OSError, ValueError) as error:
        reason = unreadable(error)
        if not (certified and isinstance(error, FileNotFoundError)):
            fault = Fault("FILE", str(path), f"cannot be read: {reason}")
            raise SceneError([fault]) from error
        missing = f"{CERTIFICATE} names it, but it is not there"
        return _unread(path, verifier, failed("file", missing))
    kind = _format(path, verifier)
    checks = [_bytes(path.name, sha256, certificate)]

    def without_scene() -> Verdict:
        return Verdict(path.name, kind, sha256, size, ("", ""), None, tuple(checks))

    if verifier is None:
        return without_scene()
    origin = verifier.origin(data)
    if origin.damage:
        checks.append(failed("file", origin.damage))
        return without_scene()
    named = origin.scene
    if certificate is not None and (not named or certificate.scene.startswith(named)):
        named = certificate.scene  # in full, where the file has only its first digits
    against = scenes(path.parent, named)
    product, present = (
        disc_of(against.discs, path.name.removesuffix(_ending(path))),
        against.hash_like(named),
    )
    checks += _scene(product, present, origin, certificate)
    tolerance = _tolerance(path.name, wanted, origin, certificate, against)
    certain = None if certificate is None else certificate.tolerances.get(path.name)
    if origin.tolerance is not None and certain is not None:
        note = f"the file names a different tolerance from {CERTIFICATE}"
        checks.append(equal("tolerance", origin.tolerance, certain, note=note))
    if origin.version:
        stated = origin.tolerance or certain
        checks.append(
            _written_again(
                path.name, verifier, data, origin, against, stated, vouched=checks[0].ok is True
            )
        )
    reading = Reading(path.name, wanted.layer, wanted.unit, wanted.origin)
    try:
        checks += verifier.checks(product, data, reading, tolerance[0])
    except CamgeoError as error:
        checks.append(failed("deviation", str(error)))
    scene, unit = (product.name, present), against.discs[0].unit
    told = tuple(each.in_unit(unit) for each in checks)
    return Verdict(path.name, kind, sha256, size, scene, tolerance, told, length=unit)


def _contents(path: Path, verifier: Verifier | None) -> tuple[bytes, int, str]:
    """Bytes, size and SHA-256 of a file; no bytes of one that is not measured."""
    if verifier is not None:
        data = read_within(path, VERIFIED)
        return data, len(data), hashlib.sha256(data).hexdigest()
    with path.open("rb") as stream:
        if not path.is_file():  # a device may have no end
            raise OSError("it is not a file")
        sha256 = hashlib.file_digest(stream, "sha256").hexdigest()
        return b"", stream.tell(), sha256


def _bytes(name: str, sha256: str, certificate: Certificate | None) -> Check:
    """The file's bytes against its certificate."""
    if certificate is None:
        note = f"no {CERTIFICATE} next to the file: only its geometry is checked"
        return reported("sha256", sha256[:SHORT], note=note)
    if certificate.damage:
        return failed("sha256", f"{CERTIFICATE} {certificate.damage}")
    certain = certificate.hashes.get(name)
    if not certain:
        note = f"{CERTIFICATE} does not name the file: only its geometry is checked"
        return reported("sha256", sha256[:SHORT], note=note)
    ok = sha256 == certain
    note = "" if ok else f"the file is not the one that {CERTIFICATE} certifies: it was changed"
    return Check("sha256", "", sha256[:SHORT], certain[:SHORT], ok=ok, note=note)


def _scene(
    product: Product, present: str, origin: Origin, certificate: Certificate | None
) -> list[Check]:
    """The scene that the file is compared with, against those that file and certificate name."""
    checks = []
    if origin.scene:
        digits = present[: len(origin.scene)]
        note = "the file was made from another scene, or another version of it"
        ok = origin.scene == digits
        checks.append(
            Check("scene", "", digits[:SHORT], origin.scene[:SHORT], ok=ok, note="" if ok else note)
        )
    elif origin.version:
        checks.append(failed("scene", "the file names no scene"))
    else:
        checks.append(reported("scene", present[:SHORT], note="not from camgeo: only measured"))
    if certificate is None or certificate.damage:
        return checks
    if certificate.scene != present:
        note = f"{CERTIFICATE} belongs to another scene, or to another version of it"
        checks.append(failed("scene", note, "certificate"))
    if certificate.scene_files != product.scene_files:
        note = f"a file that the scene reads is not the one that {CERTIFICATE} names"
        checks.append(failed("scene", note, "data"))
    return checks


def _tolerance(
    name: str,
    wanted: Wanted,
    origin: Origin,
    certificate: Certificate | None,
    against: Against,
) -> tuple[float, str]:
    """The tolerance that applies to the file [mm], and where it is from."""
    certain = None if certificate is None else certificate.tolerances.get(name)
    said = (
        (wanted.tolerance, "--tolerance"),
        (origin.tolerance, "the file"),
        (certain, CERTIFICATE),
    )
    return next(
        ((value, who) for value, who in said if value is not None),
        (against.tolerance, "the scene"),
    )


# -- written again --------------------------------------------------------------------------------
# Files of the running version compared with what it writes of their scene: the same scene gives the
# same bytes, so whatever else a file holds was changed.


WRITTEN: Final = "written again"

NUMBER: Final = re.compile(r"([A-Za-z]?)([-+]?(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][-+]?\d++)?)")
"""A number, behind the letter of its word if it has one; read once, however long it is."""

SHOWN: Final = 60
"""Characters of a token that are shown."""


def _written_again(
    name: str,
    verifier: Verifier,
    data: bytes,
    origin: Origin,
    against: Against,
    tolerance: float | None,
    *,
    vouched: bool,
) -> Check:
    """The file against the one that is written now, with the `tolerance` [mm] that it, or its
    certificate, states.

    A difference is a fault unless something else explains it: where the certificate has `vouched`
    for the bytes, another processor or library has rounded otherwise, and where no tolerance is
    stated, it may have been another one than the scene's.
    """
    product = against.discs[0]
    if origin.version != product.version:
        note = f"it is of camgeo {origin.version}: only measured"
        return reported(WRITTEN, "no", note=note)
    if not (origin.scene and product.scene_hash.startswith(origin.scene)):
        return reported(WRITTEN, "no", note="it is not of this scene: only measured")
    found: list[Difference] = []
    try:
        writer = find_writer(origin.format or verifier.format)
        pieces = [each for disc in against.discs for each in pieces_of(writer, disc)]
        ending = writer.format.ending(product.options)
        # One of another name may be any of them.
        pieces = [each for each in pieces if each.name + ending == name] or pieces
        for piece in pieces:
            written = writer.write(piece, tolerance or against.tolerance).data
            difference = first_difference(verifier, data, written)
            if difference is None:
                return Check(WRITTEN, "", "the same", ok=True)
            found.append(difference)
        note = (
            max(found, key=lambda each: each.number).sentence if found else "there is no such file"
        )
    except CamgeoError as error:
        note = f"the scene cannot be written: {error}"
    if vouched:
        return reported(WRITTEN, "differs", note=f"{note}; {CERTIFICATE} vouches for the file")
    if tolerance is None:
        return reported(WRITTEN, "differs", note=f"{note}; its tolerance is not known")
    return Check(WRITTEN, "", "differs", ok=False, note=note)


@dataclass(frozen=True, slots=True)
class Difference:
    """The first token in which two files differ.

    Attributes
    ----------
    number : of the token, from 0.
    place : of it.
    found, written : the token in the file, and in the one that is written again.
    """

    number: int
    place: str
    found: str
    written: str

    @property
    def sentence(self) -> str:
        """Place, and both tokens."""
        found, written = (
            repr(each[:SHOWN]) if each else "the end" for each in (self.found, self.written)
        )
        return f"{self.place}: {found} where camgeo writes {written}"


def first_difference(verifier: Verifier, data: bytes, written: bytes) -> Difference | None:
    """Where a file first differs from the one that is written again; None if it does not.

    Texts must be equal, numbers within the verifier's `slack` times their size, or times 1 where
    they are less.
    """
    if data == written:
        return None
    pairs = zip_longest(verifier.tokens(data), verifier.tokens(written), fillvalue=("", ""))
    for number, ((place, found), (other, expected)) in enumerate(pairs):
        if found != expected and not _alike(found, expected, verifier.slack):
            return Difference(number, place or other, found, expected)
    return None


def _alike(one: str, other: str, slack: float) -> bool:
    """Whether two words are the same letter with numbers that agree within the slack."""
    found, expected = NUMBER.fullmatch(one), NUMBER.fullmatch(other)
    if found is None or expected is None or found[1] != expected[1]:
        return False
    value, wanted = float(found[2]), float(expected[2])
    return abs(value - wanted) <= slack * max(1.0, abs(wanted))


def write_verification(
    path: Path, version: str, verdicts: tuple[Verdict, ...], *, force: bool
) -> Path:
    """Write the verdicts to `path`, overwriting at most an earlier verification of camgeo's.

    Raises
    ------
    OutputError
        If something else is there and `force` is not set, or on any disk error; in both cases
        nothing has been changed.
    """
    text = json.dumps(document(version, verdicts), indent=2, allow_nan=False) + "\n"
    replace = force or is_verification(path)
    (written,) = write_set(path.parent, {path.name: text.encode()}, force=replace)
    return written


def scene_file(
    folders: tuple[Path, ...],
    sha256: str,
    hashes: Callable[[Path, Mapping[str, str]], Iterable[str]],
) -> Path:
    """The TOML file with this hash, or these first digits of it, in one of `folders`.

    Parameters
    ----------
    folders : first that of the files to be verified; what its certificate states of the scene's own
        files applies, so that a scene is found even if its files have changed since.
    hashes : all hashes by which files may name a scene file, given the SHA-256 of the files that it
        reads where known; OSError or ValueError if it cannot be read.

    Raises
    ------
    SceneError
        If there is none.
    """
    if sha256:
        certificate = certificate_in(folders[0])
        known = {} if certificate is None else certificate.scene_files
        for folder in dict.fromkeys(folder.resolve() for folder in folders):
            for path in sorted(folder.glob("*.toml")):
                try:
                    if any(found.startswith(sha256) for found in hashes(path, known)):
                        return path
                except (OSError, ValueError):  # it, or a file that it names, is not readable
                    continue
        places = "its folder, the folder above it and the current one"
        message = f"no scene with SHA-256 {sha256[:SHORT]}... in {places}; name it with --scene"
    else:
        message = "the file names no scene; give the scene to compare it with (--scene)"
    raise SceneError([Fault("", "", message)])


# -- certificate ----------------------------------------------------------------------------------
# The certificate of a set of files, read back.


LONGEST: Final = 200
"""Most characters shown of the reason why a certificate is invalid."""

HASH: Final = re.compile(r"[0-9a-f]{64}")


@dataclass(frozen=True, slots=True)
class Certificate:
    """The contents of `certificate.json`.

    Attributes
    ----------
    scene : SHA-256 of what decides the files in the scene; earlier ones: of the scene's text.
    scene_files : SHA-256 of the files that the scene reads, by their names.
    tolerances : [mm] of each file, by its name.
    hashes : SHA-256 of each file, by its name, in their order.
    formats : of the files, by their names.
    damage : why it cannot be read; empty if it can.
    """

    scene: str = ""
    scene_files: Mapping[str, str] = field(default_factory=dict)
    tolerances: Mapping[str, float] = field(default_factory=dict)
    hashes: Mapping[str, str] = field(default_factory=dict)
    formats: Mapping[str, str] = field(default_factory=dict)
    damage: str = ""


def certificate_in(folder: Path) -> Certificate | None:
    """The certificate in `folder`; None if there is none."""
    if interrupted(folder):
        return Certificate(damage="is not valid: a run that wrote here was interrupted")
    try:
        data = read_within(folder / CERTIFICATE, CERTIFIED)
    except FileNotFoundError:
        return None
    except FileError as error:
        return Certificate(damage=f"cannot be used: {error}")
    except (OSError, ValueError) as error:
        return Certificate(damage=f"cannot be read: {unreadable(error)}")
    try:
        document = json.loads(data)
        scene, files = document["scene"], document["files"]
        return Certificate(
            _hash(scene["sha256"]),
            {_name(name): _hash(sha256) for name, sha256 in scene.get("files", {}).items()},
            {_name(file["file"]): _certified_tolerance(file["tolerance_mm"]) for file in files},
            {_name(file["file"]): _hash(file["sha256"]) for file in files},
            {_name(file["file"]): str(file.get("format", "")) for file in files},
        )
    except RecursionError:
        return Certificate(damage="is not a certificate of camgeo: it is nested too deeply")
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        what = f"{type(error).__name__}: {error}"[:LONGEST]
        return Certificate(damage=f"is not a certificate of camgeo: {what}")


def _name(value: object) -> str:
    """The name of a file; ValueError if it is not one that a file may have."""
    if not isinstance(value, str) or not value.isprintable():
        raise ValueError(f"{value!r:.60} is not the name of a file")
    return value


def _hash(value: object) -> str:
    """A SHA-256; ValueError if it is none."""
    if not isinstance(value, str) or not HASH.fullmatch(value):
        raise ValueError(f"{value!r:.60} is no SHA-256")
    return value


def _certified_tolerance(value: object) -> float:
    """A tolerance [mm]; ValueError if no file can have it."""
    if not isinstance(value, float | int) or not 0.0 < value <= LARGEST_TOLERANCE:  # or NaN
        raise ValueError(f"{value!r:.60} is not a tolerance in mm")
    return float(value)


# -- verification ---------------------------------------------------------------------------------
# The result of verifying a file: checks, each with its value and its limit, and a verdict.
#
# Verifiers register as entry points of the group ``camgeo.verifiers``; the entry point's name is
# the ending of the files that it reads, without the dot, and it loads an object that is a
# `Verifier`.


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

    def in_unit(self, length: LengthUnit) -> Check:
        """The check with the lengths in its texts in the unit of a scene; its numbers stay."""
        found = ((name, getattr(self, name)) for name in ("of", "value", "expected", "note"))
        texts: dict[str, Any] = {
            name: in_unit(each, length) for name, each in found if isinstance(each, str)
        }
        return replace(self, **texts)

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


def unit_check(unit: str, reading: Reading) -> Check:
    """The unit of a file, which must be the user's if one is given."""
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
    version : of camgeo, if it states that camgeo wrote it; else empty.
    scene : hash of the scene that it names, or its first digits; empty if it names none.
    tolerance : [mm] that it names, or None.
    damage : why it cannot be read at all; empty if it can.
    format : that it was written in, if it is not the verifier's.
    """

    version: str = ""
    scene: str = ""
    tolerance: float | None = None
    damage: str = ""
    format: str = ""


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
    layer : the one read in a drawing; None for CUT if it exists, else for all layers.
    unit : of the file if it does not state one; None if the user has not given it either.
    origin : of a drawing: where the cam axis lies in its axes [mm].
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
        """By how much numbers of files of one scene may differ where another processor has
        computed them, as a share of their size.
        """

    def tokens(self, data: bytes) -> Iterator[tuple[str, str]]:
        """The words and numbers of a file that is not damaged, each with its place."""

    def origin(self, data: bytes) -> Origin:
        """What the file states about itself; raises nothing."""

    def checks(
        self, product: Product, data: bytes, reading: Reading, tolerance: float
    ) -> tuple[Check, ...]:
        """All checks of a file of any origin, against `tolerance` [mm]; what cannot be measured
        fails.
        """


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
    length : unit of the scene, in which the texts of the checks are.
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
