"""Answer of `camgeo verify`: files compared with the exact curves of their scene."""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.metadata import entry_points
from itertools import zip_longest
from pathlib import Path
from typing import Any, Final

from camgeo._version import __version__
from camgeo.app.answers.answer import BROKEN, CRASHED, FINE, Answer, Key
from camgeo.app.cli.command import (
    FORCE,
    Argument,
    CallError,
    notify,
    number_type,
    origin_option,
    settle,
    show,
)
from camgeo.design.design import Design
from camgeo.design.product import Product, find_disc
from camgeo.design.verify import Check, Origin, ReadingOptions, Verifier, equal, failed, reported
from camgeo.design.writing import (
    CERTIFICATE,
    KIND,
    VERIFICATION,
    file_products,
    find_writer,
    interrupted,
    is_verification,
    write_set,
)
from camgeo.errors import CamgeoError, Fault, FileError, SceneError, unreadable
from camgeo.reading import VERIFIED, Limits, read_limited
from camgeo.scene.formats.format import LARGEST_TOLERANCE
from camgeo.scene.scene import load_scene, scene_file_hashes
from camgeo.units import LengthUnit, in_unit, unit_and_divisor


@dataclass(frozen=True, slots=True)
class Verification(Answer):
    """Files, and the verdicts on them.

    Attributes
    ----------
    paths : of the files.
    verdicts : one per file, in the same order.
    """

    paths: tuple[Path, ...]
    verdicts: tuple[FileVerdict, ...]

    @property
    def passed(self) -> bool:
        """Whether all files pass."""
        return all(verdict.passed for verdict in self.verdicts)

    @property
    def records(self) -> tuple[Mapping[str, Any], ...]:
        """The verdicts as verification.json contains them."""
        return tuple(verdict.record() for verdict in self.verdicts)

    @property
    def exit_code(self) -> int:
        """0 if all files pass, 1 if one does not, CRASHED after an error in camgeo itself."""
        if any(verdict.crashed for verdict in self.verdicts):
            return CRASHED
        return FINE if self.passed else BROKEN


def verify(
    paths: tuple[Path, ...], wanted: Wanted | None = None, *, scene: str | Path | None = None
) -> Verification:
    """Read files back, and compare them with a scene.

    Parameters
    ----------
    paths : of the files.
    wanted : requirements of the user; None for those stated by the files and their scene.
    scene : path of the scene; None for the one whose hash the files name, looked for in their
        folder, the one above and the present one.

    Raises
    ------
    SceneError
        If none of the files can be compared: they are of a format that cannot be read, or their
        scene is not found or wrong.
    """
    return Verification(paths, verify_files(paths, _scenes(scene), wanted or Wanted()))


def _scenes(named: str | Path | None) -> Callable[[Path, str], Reference]:
    """A function that returns the reference of a file; each scene is read only once."""

    @cache
    def load(path: Path) -> Reference:
        design = Design(load_scene(path))
        scene = design.scene
        return Reference(design.discs, scene.output.tolerance, scene.text_hash)

    def find(folder: Path, sha256: str) -> Reference:
        if named is not None:
            return load(Path(named))
        return load(scene_file((folder, folder / "..", Path()), sha256))

    return find


# -- files ----------------------------------------------------------------------------------------
# Files compared with their certificate, their scene, and the files that camgeo writes for it.


GROUP: Final = "camgeo.verifiers"

LONGEST_NOTE: Final = 200
"""Most characters of an unexpected error in a note."""

CERTIFIED: Final = Limits("certificate", 2_000_000)

SHORT: Final = 16
"""Digits of a hash that are printed."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """The requirements that the user states.

    Attributes
    ----------
    tolerance : [mm], or None for what the files, their certificate or the scene state.
    layer, unit, origin : as for `ReadingOptions`.
    """

    tolerance: float | None = None
    layer: str | None = None
    unit: LengthUnit | None = None
    origin: complex = 0j


@dataclass(frozen=True, slots=True)
class Reference:
    """A design with which files are compared.

    Attributes
    ----------
    discs : of the design, the main one first.
    tolerance : of its scene [mm].
    text_hash : hash of the scene's text, which files of earlier versions name; empty if it has
        no text.
    """

    discs: Sequence[Product]
    tolerance: float
    text_hash: str = ""

    def hash_like(self, named: str) -> str:
        """The hash of the scene of the kind that a file or certificate names: of its text, or of
        its values.
        """
        earlier = self.text_hash
        return earlier if named and earlier.startswith(named) else self.discs[0].scene_hash


Scenes = Callable[[Path, str], Reference]
"""Maps the folder of a file and the hash of its scene, or its first digits, or "", to the design;
raises SceneError if there is none."""


def endings() -> tuple[str, ...]:
    """Endings of the files that can be verified, sorted, with their dots."""
    return tuple(f".{name}" for name in sorted(entry_points(group=GROUP).names))


def _ending(path: Path) -> str:
    """The end of a file's name that is one of `endings`, the longest; else its suffix."""
    known = [ending for ending in endings() if path.name.lower().endswith(ending)]
    return path.name[-len(max(known, key=len)) :] if known else path.suffix


def verifiable_files(folder: Path) -> tuple[Path, ...]:
    """The files of `folder` that can be verified or that its certificate names, sorted."""
    known = endings()
    readable = {p for p in folder.iterdir() if p.name.lower().endswith(known) and p.is_file()}
    certificate = read_certificate(folder)
    named = certificate.hashes if certificate is not None else {}
    return tuple(sorted(readable | {folder / name for name in named if Path(name).name == name}))


def verify_files(
    paths: tuple[Path, ...], scenes: Scenes, wanted: Wanted
) -> tuple[FileVerdict, ...]:
    """One verdict per file; a fault in one file does not affect the verdicts on the others.

    Raises
    ------
    SceneError
        If no file can be judged except by its bytes, because its format cannot be read, or its
        scene is not found or wrong.
    """
    # Each certificate is read once, however many files it has.
    certificates = {folder: read_certificate(folder) for folder in {path.parent for path in paths}}
    verdicts: list[FileVerdict] = []
    refused: list[SceneError] = []
    judged = False
    for path in paths:
        verifier: Verifier | None = None
        try:
            certificate = certificates[path.parent]
            verifier = _find_verifier(path, certificate)
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


def _unread(path: Path, verifier: Verifier | None, check: Check) -> FileVerdict:
    """The verdict on a file that was not read; `check` says why."""
    return FileVerdict(path.name, _format(path, verifier), "", 0, ("", ""), None, (check,))


def _format(path: Path, verifier: Verifier | None) -> str:
    """The name of its format; its ending if it has no verifier."""
    return _ending(path).removeprefix(".").lower() if verifier is None else verifier.format


def _find_verifier(path: Path, certificate: Certificate | None) -> Verifier | None:
    """The verifier of a file, by its ending or by the format that its certificate names."""
    registered = entry_points(group=GROUP, name=_ending(path).removeprefix(".").lower())
    if registered:
        verifier: Verifier = next(iter(registered)).load()
        return verifier
    form = "" if certificate is None else certificate.formats.get(path.name, "")
    known = (entry.load() for entry in entry_points(group=GROUP)) if form else ()
    return next((verifier for verifier in known if verifier.format == form), None)


def _verdict(
    path: Path,
    verifier: Verifier | None,
    certificate: Certificate | None,
    scenes: Scenes,
    wanted: Wanted,
) -> FileVerdict:
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

    def without_scene() -> FileVerdict:
        return FileVerdict(path.name, kind, sha256, size, ("", ""), None, tuple(checks))

    if verifier is None:
        return without_scene()
    # The file states which scene and version it is from.
    origin = verifier.origin(data)
    if origin.damage:
        checks.append(failed("file", origin.damage))
        return without_scene()
    named = origin.scene
    if certificate is not None and (not named or certificate.scene.startswith(named)):
        named = certificate.scene  # in full, where the file has only its first digits
    reference = scenes(path.parent, named)
    product, present = (
        find_disc(reference.discs, path.name.removesuffix(_ending(path))),
        reference.hash_like(named),
    )
    checks += _scene(product, present, origin, certificate)
    tolerance = _tolerance(path.name, wanted, origin, certificate, reference)
    certain = None if certificate is None else certificate.tolerances.get(path.name)
    if origin.tolerance is not None and certain is not None:
        note = f"the file names a different tolerance from {CERTIFICATE}"
        checks.append(equal("tolerance", origin.tolerance, certain, note=note))
    if origin.version:
        stated = origin.tolerance or certain
        checks.append(
            _written_again(
                path.name, verifier, data, origin, reference, stated, vouched=checks[0].ok is True
            )
        )
    reading = ReadingOptions(path.name, wanted.layer, wanted.unit, wanted.origin)
    try:
        checks += verifier.checks(product, data, reading, tolerance[0])
    except CamgeoError as error:
        checks.append(failed("deviation", str(error)))
    scene, unit = (product.name, present), reference.discs[0].unit
    restated = tuple(check.in_unit(unit) for check in checks)
    return FileVerdict(path.name, kind, sha256, size, scene, tolerance, restated, length=unit)


def _contents(path: Path, verifier: Verifier | None) -> tuple[bytes, int, str]:
    """Bytes, size and SHA-256 of a file; no bytes of one that is not measured."""
    if verifier is not None:
        data = read_limited(path, VERIFIED)
        return data, len(data), hashlib.sha256(data).hexdigest()
    with path.open("rb") as stream:
        if not path.is_file():  # a device may have no end
            raise OSError("it is not a file")
        sha256 = hashlib.file_digest(stream, "sha256").hexdigest()
        return b"", stream.tell(), sha256


def _bytes(name: str, sha256: str, certificate: Certificate | None) -> Check:
    """The check of the file's hash against that in its certificate."""
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
    """The checks of the present scene against those that the file and its certificate name."""
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
    reference: Reference,
) -> tuple[float, str]:
    """The tolerance that applies to the file [mm], and who states it."""
    certain = None if certificate is None else certificate.tolerances.get(name)
    # In order of precedence; the scene comes last.
    said = (
        (wanted.tolerance, "--tolerance"),
        (origin.tolerance, "the file"),
        (certain, CERTIFICATE),
    )
    return next(
        ((value, who) for value, who in said if value is not None),
        (reference.tolerance, "the scene"),
    )


@dataclass(frozen=True, slots=True)
class FileVerdict:
    """One file with all its checks.

    Attributes
    ----------
    file : its name.
    format : name of its format.
    sha256 : of its bytes, hexadecimal.
    size : in bytes.
    scene : name and hash of the scene it was compared with; empty if it was not measured.
    tolerance : [mm] that applied, and who states it; None if it was not measured.
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
        values = [check.value for check in self.checks if check.name == "deviation"]
        numbers = [value for value in values if isinstance(value, float)]
        return max(numbers) if numbers and len(numbers) == len(values) else None

    def record(self) -> dict[str, Any]:
        """The verdict as JSON data."""
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


# -- written again --------------------------------------------------------------------------------
# Files of the running version compared with those that it writes now for their scene: the same
# scene gives the same bytes, so any difference is a change made afterwards.


WRITTEN: Final = "written again"

NUMBER: Final = re.compile(r"([A-Za-z]?)([-+]?(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][-+]?\d++)?)")
"""A number, behind the letter of its word if it has one; read once, however long it is."""

LONGEST_TOKEN: Final = 60
"""Most characters of a token that are printed."""


def _written_again(
    name: str,
    verifier: Verifier,
    data: bytes,
    origin: Origin,
    reference: Reference,
    tolerance: float | None,
    *,
    vouched: bool,
) -> Check:
    """The check of the file against the one that is written now, within the `tolerance` [mm] that
    the file or its certificate states.

    A difference is a fault unless something else explains it: if the certificate has `vouched` for
    the bytes, another processor or library has rounded differently; if no tolerance is stated, the
    file may have been written within another one than the scene's.
    """
    product = reference.discs[0]
    if origin.version != product.version:
        note = f"it was written by camgeo {origin.version}: only measured"
        return reported(WRITTEN, "no", note=note)
    if not (origin.scene and product.scene_hash.startswith(origin.scene)):
        return reported(WRITTEN, "no", note="it was not made from this scene: only measured")
    differences: list[Difference] = []
    try:
        writer = find_writer(origin.format or verifier.format)
        pieces = [piece for disc in reference.discs for piece in file_products(writer, disc)]
        ending = writer.format.ending(product.options)
        # One of another name may be any of them.
        pieces = [piece for piece in pieces if piece.name + ending == name] or pieces
        for piece in pieces:
            written = writer.write(piece, tolerance or reference.tolerance).data
            difference = first_difference(verifier, data, written)
            if difference is None:
                return Check(WRITTEN, "", "the same", ok=True)
            differences.append(difference)
        note = (
            max(differences, key=lambda difference: difference.number).sentence
            if differences
            else "there is no such file"
        )
    except CamgeoError as error:
        note = f"the scene cannot be written: {error}"
    if vouched:
        return reported(WRITTEN, "differs", note=f"{note}; {CERTIFICATE} certifies these bytes")
    if tolerance is None:
        return reported(WRITTEN, "differs", note=f"{note}; its tolerance is not known")
    return Check(WRITTEN, "", "differs", ok=False, note=note)


@dataclass(frozen=True, slots=True)
class Difference:
    """The first token in which two files differ.

    Attributes
    ----------
    number : of the token, from 0.
    place : of the token in the file, in words.
    token, written : the token in the file, and in the one that is written again.
    """

    number: int
    place: str
    token: str
    written: str

    @property
    def sentence(self) -> str:
        """The place, and both tokens."""
        token, written = (
            repr(text[:LONGEST_TOKEN]) if text else "the end" for text in (self.token, self.written)
        )
        return f"{self.place}: {token} where camgeo writes {written}"


def first_difference(verifier: Verifier, data: bytes, written: bytes) -> Difference | None:
    """Where a file first differs from the one that is written again; None if it does not.

    Texts must be equal, numbers within the verifier's `slack` times their size, or times 1 where
    they are less.
    """
    if data == written:
        return None
    # The end of the shorter file is an empty token, which differs from any other.
    pairs = zip_longest(verifier.tokens(data), verifier.tokens(written), fillvalue=("", ""))
    for number, ((place, token), (other, expected)) in enumerate(pairs):
        if token != expected and not _alike(token, expected, verifier.slack):
            return Difference(number, place or other, token, expected)
    return None


def _alike(one: str, other: str, slack: float) -> bool:
    """Whether two words have the same letter, and numbers that agree within the slack."""
    word, expected = NUMBER.fullmatch(one), NUMBER.fullmatch(other)
    if word is None or expected is None or word[1] != expected[1]:
        return False
    value, wanted = float(word[2]), float(expected[2])
    return abs(value - wanted) <= slack * max(1.0, abs(wanted))


def scene_file(folders: tuple[Path, ...], sha256: str) -> Path:
    """The TOML file with this hash, or these first digits of it, in one of `folders`.

    Parameters
    ----------
    folders : the first is that of the files to be verified. The hashes that its certificate states
        for the scene's data files apply, so that a scene is found even if these have changed since.

    Raises
    ------
    SceneError
        If there is none.
    """
    if sha256:
        certificate = read_certificate(folders[0])
        known = {} if certificate is None else certificate.scene_files
        # The folders may be one and the same.
        for folder in dict.fromkeys(folder.resolve() for folder in folders):
            for path in sorted(folder.glob("*.toml")):
                try:
                    if any(digest.startswith(sha256) for digest in scene_file_hashes(path, known)):
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
"""Most characters of the reason why a certificate is invalid."""

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


def read_certificate(folder: Path) -> Certificate | None:
    """The certificate in `folder`; None if there is none."""
    if interrupted(folder):
        return Certificate(damage="is not valid: a run that wrote here was interrupted")
    try:
        data = read_limited(folder / CERTIFICATE, CERTIFIED)
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
    """A SHA-256; ValueError if the value is none."""
    if not isinstance(value, str) or not HASH.fullmatch(value):
        raise ValueError(f"{value!r:.60} is no SHA-256")
    return value


def _certified_tolerance(value: object) -> float:
    """A tolerance [mm]; ValueError if no file can have it."""
    if not isinstance(value, float | int) or not 0.0 < value <= LARGEST_TOLERANCE:  # or NaN
        raise ValueError(f"{value!r:.60} is not a tolerance in mm")
    return float(value)


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


DOCUMENT: Final = Key(
    "Files read back and compared with the exact curves of their scene.",
    {
        "passed": "Whether all files pass.",
        "files": Key(
            "The files, in the order of the call.",
            {
                "file": Key("Name of the file.", type=str),
                "format": Key("Name of its format.", type=str),
                "sha256": Key("SHA-256 of its bytes, hexadecimal.", type=str),
                "bytes": Key("Size of the file.", type=int),
                "scene": Key(
                    "The scene that it was compared with, if it was measured.",
                    {
                        "name": Key("Name of the scene.", type=str),
                        "sha256": Key(
                            "Hash of the scene as written in the file, hexadecimal.", type=str
                        ),
                    },
                    type=dict[str, Any],
                    optional=True,
                    by_key=True,
                ),
                "tolerance_mm": Key(
                    "The tolerance that was applied, if it was measured.", type=float, optional=True
                ),
                "tolerance_from": Key(
                    "Who states the tolerance: the call, the file, its certificate or the scene.",
                    type=str,
                    optional=True,
                ),
                "deviation_mm": Key(
                    "Largest proved deviation; missing if one could not be proved, or there is"
                    " none.",
                    type=float,
                    optional=True,
                ),
                "passed": Key("Whether no check fails.", type=bool),
                "checks": Key(
                    "All checks.",
                    {
                        "name": Key('What was checked, e.g. "deviation".', type=str),
                        "of": Key(
                            "The boundary or operation concerned; missing for the whole file.",
                            type=str,
                            optional=True,
                        ),
                        "value": Key(
                            "The measured value, in `unit`.", type=float | str, optional=True
                        ),
                        "expected": Key("The expected value.", type=float | str, optional=True),
                        "limit": Key(
                            "Largest value, or largest difference from what is expected.",
                            type=float,
                            optional=True,
                        ),
                        "unit": Key("Unit of the numbers.", type=str, optional=True),
                        "ok": Key(
                            "Whether it passes; null for information alone.", type=bool | None
                        ),
                        "note": Key("A sentence or a place.", type=str, optional=True),
                    },
                    type=tuple[dict[str, Any], ...],
                    by_key=True,
                ),
            },
            of="records",
            by_key=True,
        ),
    },
    type=Verification,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo verify` in words.


MARKS: Final = {True: "ok", False: "FAIL", None: ""}

WIDTHS: Final = (34, 20, 32)
"""Widths of the columns of a check: its name, the value, and what is allowed."""


def text(answer: Verification) -> str:
    """Each file with its result, and its checks below it."""
    lines = []
    for path, verdict in zip(answer.paths, answer.verdicts, strict=True):
        checks = (_line(_divided(check, verdict.length)) for check in verdict.checks)
        lines += [in_unit(_headline(path, verdict), verdict.length), *checks]
    return "\n".join(lines)


def _headline(path: Path, verdict: FileVerdict) -> str:
    """The file and its result."""
    word = "pass" if verdict.passed else "FAIL"
    if verdict.tolerance is None:
        return f"{path}: {word}, {'bytes only' if verdict.passed else 'not measured'}"
    tolerance, who = verdict.tolerance
    deviation = verdict.deviation
    text = "deviation not proved" if deviation is None else f"at most {deviation:.3g} mm off"
    return f"{path}: {word}, {text} (tolerance {tolerance:g} mm, by {who})"


def _divided(check: Check, length: LengthUnit) -> Check:
    """The check with its numbers in the unit of length of the scene."""
    unit, divisor = unit_and_divisor(check.unit, length)

    def convert(value: Any) -> Any:
        return value / divisor if isinstance(value, float) and divisor != 1.0 else value

    figures = {name: convert(getattr(check, name)) for name in ("value", "expected", "limit")}
    return replace(check, **figures, unit=unit)


def _line(check: Check) -> str:
    """One check: name, value, allowed, mark, note."""
    name = f"{check.name} {check.of}".rstrip()
    value = _text(check.value, check.unit)
    if check.expected is not None:
        value, allowed = _long(check.value), _long(check.expected)
        if check.limit is not None:
            allowed += f" +- {check.limit:.3g} {check.unit}"
    else:
        allowed = "" if check.limit is None else f"<= {_text(check.limit, '')}"
    columns = "".join(
        f"{text:{width}} " for text, width in zip((name, value, allowed), WIDTHS, strict=True)
    )
    return f"  {columns}{MARKS[check.ok]:5}{check.note}".rstrip()


def _text(value: float | str | None, unit: str) -> str:
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    return f"{value:.4g} {unit}".rstrip()


def _long(value: float | str | None) -> str:
    """The value with as many digits as a comparison needs."""
    return f"{value:.9g}" if isinstance(value, float) else value or ""


# -- command line ----------------------------------------------------------------------------------


EXAMPLE: Final = (
    "camgeo verify out/setzhub\n"
    "  camgeo verify drawing.dxf --scene my-cam.toml --tolerance 0.01 --layer OUTLINE\n"
    "  camgeo verify out/setzhub --json -o proof.json"
)


ARGUMENTS: Final = (
    Argument("files", metavar="FILE|DIR", nargs="+", help="files, or a folder of files"),
    Argument(
        "--scene",
        metavar="SCENE",
        help="scene file (TOML); default: the one whose hash the files name, searched for in their"
        " folder, the one above it and the current one",
    ),
    Argument(
        "--tolerance",
        metavar="MM",
        type=number_type(math.ulp(0.0), math.inf, "a length above 0"),
        help="largest deviation; default: from the file, certificate.json or the scene",
    ),
    Argument(
        "--unit", choices=("mm", "inch"), help="unit of files that do not state it; STL: default mm"
    ),
    Argument("--layer", metavar="NAME", help="layer of drawings; default CUT, or all"),
    origin_option("drawings (DXF) from other programs"),
    Argument(
        "-o",
        metavar="FILE",
        dest="output",
        help="certificate to write; default: verification.json in their folder",
    ),
    FORCE,
)


def run(arguments: argparse.Namespace) -> int:
    """Verify; 0 if all files pass, 1 if one does not."""
    named = [Path(name) for name in arguments.files]
    for folder in dict.fromkeys(path if _is_folder(path) else path.parent for path in named):
        settle(folder, arguments)
    paths = _paths(named)
    target = None if arguments.output is None else Path(arguments.output)
    if target is None:
        folders = {path.parent for path in paths}
        if len(folders) > 1:
            raise CallError("the files are in several folders: state with -o where to write")
        target = folders.pop() / VERIFICATION
    origin = complex(*arguments.origin)
    wanted = Wanted(arguments.tolerance, arguments.layer, arguments.unit, origin)
    answer = verify(paths, wanted, scene=arguments.scene)
    code = show(answer, arguments)
    if any(verdict.measured for verdict in answer.verdicts):
        _write(target, answer, force=arguments.force)
        notify(f"{target}: the results")
    else:
        notify("nothing was measured, and nothing was written")
    return code


def _write(path: Path, answer: Verification, *, force: bool) -> None:
    """Write the verdicts to `path`, overwriting at most an earlier verification of camgeo's.

    Raises
    ------
    OutputError
        If something else is there and `force` is not set, or on any disk error; in both cases
        nothing has been changed.
    """
    document = {
        "kind": KIND,
        "camgeo": __version__,
        "passed": answer.passed,
        "files": list(answer.records),
    }
    text = json.dumps(document, indent=2, allow_nan=False) + "\n"
    write_set(path.parent, {path.name: text.encode()}, force=force or is_verification(path))


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except OSError:  # the name is too long, ...
        return False


def _paths(named: list[Path]) -> tuple[Path, ...]:
    """The files, those of folders in place of the folders; each once."""
    paths: list[Path] = []
    for path in named:
        if not _is_folder(path):
            paths.append(path)
            continue
        try:
            contents = verifiable_files(path)
        except OSError as error:
            fault = Fault("DIR", str(path), f"cannot be read: {unreadable(error)}")
            raise SceneError([fault]) from error
        if not contents:
            message = f"the folder holds no file that ends in {', '.join(endings())}"
            raise SceneError([Fault("DIR", str(path), message)])
        paths += contents
    return tuple(dict.fromkeys(paths))
