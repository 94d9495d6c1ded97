"""A design's files: written by their writers, measured as read back, certified, put in place."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any, Final

from camgeo.check.finding import Finding, forbidding, stated_in
from camgeo.displayed import Displayed
from camgeo.errors import Fault, FileError, SceneError, ToleranceError, UndercutError
from camgeo.formats.format import LARGEST_TOLERANCE, SMALLEST_TOLERANCE
from camgeo.product.judged_part import findings_on
from camgeo.product.product import Product, with_pair
from camgeo.reading import VERIFIED, read_within
from camgeo.writing.transaction import Progress, silent, write_set
from camgeo.writing.writer import (
    Writer,
    Written,
    find_writers,
    pieces_of,
    with_companions,
    writer_names,
)

CERTIFICATE: Final = "certificate.json"

VERIFICATION: Final = "verification.json"
"""Default name of the file that a verification of a folder's files is written to."""

KIND: Final = "camgeo verification"
"""Distinguishes a verification from any other JSON file."""


@dataclass(frozen=True, slots=True)
class FileReport:
    """One written file.

    Attributes
    ----------
    name : of the file.
    format : name of its writer.
    size : in bytes.
    tolerance : the requested one [mm].
    deviation : proved for the file as read back [mm]; None for pictures.
    facts : what its writer reports, e.g. the number of arcs.
    findings : what whoever uses the file has to watch.
    """

    name: str
    format: str
    size: int
    tolerance: float
    deviation: float | None
    facts: dict[str, int | float | str]
    findings: tuple[Finding, ...] = ()


@dataclass(frozen=True, slots=True)
class Report(Displayed):
    """What was written.

    Attributes
    ----------
    paths : of all files, the certificate last.
    files : one report per file, without the certificate.
    """

    paths: tuple[Path, ...]
    files: tuple[FileReport, ...]


def write_files(
    discs: Sequence[Product],
    folder: str | Path,
    formats: tuple[str, ...],
    tolerance: float,
    *,
    force: bool = False,
    progress: Progress = silent,
) -> Report:
    """Write `formats` of `discs` and their certificate into `folder`, see `Design.write`.

    The first disc is the main one, which names the certificate.
    """
    if not SMALLEST_TOLERANCE <= tolerance <= LARGEST_TOLERANCE:
        message = f"must be a length of {SMALLEST_TOLERANCE:g} mm to {LARGEST_TOLERANCE:g} mm"
        raise SceneError([Fault("tolerance", f"{tolerance:g}", message)])
    contents, reports = make_files(discs, formats, tolerance, progress=progress)
    accounts = {VERIFICATION: is_verification}
    paths = write_set(Path(folder), contents, force=force, progress=progress, accounts=accounts)
    return Report(paths, reports)


def is_verification(path: Path) -> bool:
    """Whether a file is a verification of camgeo's."""
    try:
        found = json.loads(read_within(path, VERIFIED))
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(found, dict) and found.get("kind") == KIND


def make_files(
    discs: Sequence[Product],
    formats: tuple[str, ...],
    tolerance: float,
    *,
    progress: Progress = silent,
) -> tuple[dict[str, bytes], tuple[FileReport, ...]]:
    """The files by name, the certificate last, and a report on each; none is written.

    The files of the first disc, then those of the next. Raises like `Design.write`.
    """
    if not formats:
        message = f"no format is named; there are {', '.join(writer_names())}"
        raise SceneError([Fault("format", "", message)])
    product = discs[0]
    contents: dict[str, bytes] = {}
    reports: list[FileReport] = []
    found = find_writers(formats)
    if lacking := product.scene.lacking(writer.format for writer in found.values()):
        raise SceneError(lacking, product.scene.source.file)
    if forbidden := forbidding(product.findings):
        raise UndercutError("; ".join(each.sentence for each in forbidden))
    writers = [(name, each) for name, one in found.items() for each in with_companions(one)]
    for disc, name, writer in _pieces(discs, writers):
        label = name if disc is product else f"{name} of {disc.name}"
        written, deviation = _make(disc, label, writer, tolerance, progress)
        file = f"{disc.name}{writer.format.ending(disc.options)}"
        if file in contents:
            message = f"would be {file}, as another file of the same set"
            raise SceneError([Fault("format", name, message)])
        contents[file] = written.data
        size, facts = len(written.data), written.facts
        told = stated_in(disc.unit, written.findings)
        reports.append(FileReport(file, name, size, tolerance, deviation, facts, told))
    contents[CERTIFICATE] = _certificate(discs, tolerance, reports, contents)
    return contents, tuple(reports)


def _pieces(
    discs: Sequence[Product], writers: Sequence[tuple[str, Writer]]
) -> Iterator[tuple[Product, str, Writer]]:
    """What each file is made of, with the name of its format and its writer."""
    for disc in discs:
        for name, writer in writers:
            for piece in pieces_of(writer, disc):
                yield piece, name, writer


def _make(
    disc: Product, name: str, writer: Writer, tolerance: float, progress: Progress
) -> tuple[Written, float | None]:
    """One file of one disc, and its deviation as read back [mm]; `name` is for messages.

    What is read has limits (`camgeo.reading`); a file beyond them is not written.
    """
    progress(f"{name}: computing")
    try:
        written = disc.ledger.run(f"{name} file", partial(writer.write, disc, tolerance))
    except ToleranceError as error:
        # The writer used a share of the tolerance; the user knows the whole.
        raise ToleranceError(f"{name}: {error.reason}", tolerance, error.reached) from error
    except FileError as error:
        raise FileError(f"{name}: {error}") from error
    progress(f"{name}: reading back")
    try:
        deviation = disc.ledger.run(
            f"{name} file, measured", partial(writer.measure, disc, written.data)
        )
    except FileError as error:
        raise FileError(f"{name}: the file cannot be read back: {error}") from error
    if deviation is not None and not deviation <= tolerance:
        raise ToleranceError(f"the {name} file, read back, is off", tolerance, deviation)
    return written, deviation


def _certificate(
    discs: Sequence[Product],
    tolerance: float,
    reports: list[FileReport],
    contents: dict[str, bytes],
) -> bytes:
    """What has been proved about the files, and found on the discs and their parts, as JSON; the
    same for the same scene.
    """
    product = discs[0]
    document: dict[str, Any] = {
        "camgeo": product.version,
        "scene": {
            "name": product.name,
            "sha256": product.scene_hash,
            **({"files": product.scene_files} if product.scene_files else {}),
        },
        "tolerance_mm": tolerance,
        "files": [
            {
                "file": report.name,
                "format": report.format,
                "sha256": hashlib.sha256(contents[report.name]).hexdigest(),
                "bytes": report.size,
                "tolerance_mm": report.tolerance,
                "deviation_mm": report.deviation,
                **report.facts,
            }
            for report in reports
        ],
        "findings": [
            *map(_stated, product.findings),
            *(
                {**_stated(each), "part": disc.name}
                for disc in with_pair(discs)
                for each in findings_on(disc)
            ),
            *map(_stated, chain.from_iterable(report.findings for report in reports)),
        ],
    }
    return (json.dumps(document, indent=2, allow_nan=False) + "\n").encode()


def _stated(finding: Finding) -> dict[str, Any]:
    """A finding as the certificate has it."""
    return {key: getattr(finding, key) for key in ("name", "severity", "value", "limit", "unit")}
