"""A design's files: written by their writers, measured as read back, certified, put in place."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import shutil
import sys
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, Protocol

from camgeo.check.finding import Finding, findings_in_unit, forbidding
from camgeo.design.judged_part import part_findings
from camgeo.design.product import Product, with_pair
from camgeo.errors import (
    Fault,
    FileError,
    OutputError,
    SceneError,
    ToleranceError,
    UndercutError,
    meant,
    unreadable,
)
from camgeo.reading import VERIFIED, read_limited
from camgeo.record import Displayed
from camgeo.scene.formats.format import (
    LARGEST_TOLERANCE,
    NO_FORMATS,
    SMALLEST_TOLERANCE,
    Format,
    load_format,
    writer_entries,
)

# -- transaction ----------------------------------------------------------------------------------
# A set of files written completely or not at all, even if the process is killed meanwhile.
#
# The new files are staged, safely on disk, in the hidden folder `STAGING` of the target folder,
# next to links to the files that they replace. Then a journal, the list of their names, is put
# there, and only then are they moved into place. The old version of the last file is removed first
# and the new one moved last, so a certificate never lies next to files of another set. Whatever
# else describes the old set, as a verification does, is removed right after its certificate.
# Removing the journal makes the set valid. As long as the journal is there, the previous state can
# be restored, by the process itself after an error, or else by the next one that writes there or
# calls `settle`, which may be stopped as well.
#
# One process at a time writes into a folder; the system releases the lock of one that has died.


if sys.platform != "win32":
    import fcntl

STAGING: Final = ".camgeo-set"
"""Folder in the target folder, with the new files, the old ones, and the journal."""

NEW: Final = "new"
OLD: Final = "old"
JOURNAL: Final = "journal"
WRITER: Final = "writer"
"""File in the staging folder with the number of the process."""

LOCK: Final = ".camgeo-lock"
"""File that is the lock on Windows; elsewhere the folder itself is locked."""

PATIENCE: Final = 10.0
"""Seconds to wait for another process; moving files takes much less."""

PRIVATE: Final = 0o600
"""Mode of files that nobody else may read."""

EVERY: Final = 0.02
"""Seconds between two attempts to get the lock."""

Progress = Callable[[str], None]


Accounts = Mapping[str, Callable[[Path], bool]]
"""Names of files that may describe the set in their folder, each with a test whether the file there
does."""

NO_ACCOUNTS: Final[Accounts] = MappingProxyType({})


def silent(_: str) -> None:
    """Report progress to no one."""


def write_set(
    folder: Path,
    files: Mapping[str, bytes],
    *,
    force: bool,
    progress: Progress = silent,
    accounts: Accounts = NO_ACCOUNTS,
) -> tuple[Path, ...]:
    """Write `files` (name -> content) into `folder`, which is created if necessary.

    The last of several files vouches for the others, as a certificate does. A file that already
    exists with the same content counts as written. A link is replaced, not what it points to.
    `accounts` of the set that was there are removed with it, unless nothing changes. `progress`
    reports if another process has to be waited for, and each file that is removed.

    Raises
    ------
    OutputError
        If a different file exists and `force` is not set, if another process keeps writing there,
        or on any disk error; nothing has been changed, or will be when `settle` has been called.
    """
    new_folders = _make_folder(folder)
    try:
        for created in new_folders:
            with suppress(OSError):  # it may be a folder that cannot be read
                sync(created.parent)
        with _locked(folder, progress):
            _restore(folder)
            _refuse_overwriting(folder, files, force=force)
            outdated = _outdated(folder, files, accounts)
            _replace(folder, files, outdated)
            for name in outdated:
                progress(f"{name} of the previous files was removed")
    except OutputError:
        raise
    except (OSError, ValueError) as error:
        name = Path(getattr(error, "filename", None) or folder).name
        place = name if name in files else "into it"
        outcome = "nothing was written"
        if interrupted(folder):
            outcome = "the old files are put back by the next camgeo build or verify there"
        message = f"{folder}: cannot write {place}: {unreadable(error)}; {outcome}"
        raise OutputError(message) from error
    finally:  # after Ctrl-C too
        for created in reversed(new_folders):
            try:
                created.rmdir()  # only if nothing has been put in it
            except OSError:
                break
    return tuple(folder / name for name in files)


def interrupted(folder: Path) -> bool:
    """Whether a run is putting a set in place in `folder`, or was stopped while doing so."""
    return os.path.lexists(folder / STAGING / JOURNAL)


def settle(folder: Path, progress: Progress = silent) -> str:
    """Put `folder` back in the state before a run that was stopped there.

    Returns a sentence on what was done, which is empty if no run was stopped. Raises OutputError if
    the state cannot be restored, or another process is writing there.
    """
    try:
        if not os.path.lexists(folder / STAGING):
            return ""
        with _locked(folder, progress):
            return _restore(folder)
    except OutputError:
        raise
    except (OSError, ValueError) as error:
        raise OutputError(
            f"{folder}: a run was interrupted here, and the files from before, which are in"
            f" {STAGING}, cannot be put back: {unreadable(error)}"
        ) from error


# -- the lock --------------------------------------------------------------------------------------


@contextmanager
def _locked(folder: Path, progress: Progress) -> Generator[None]:
    """Keep other processes, and other threads, out of `folder`."""
    end = time.monotonic() + PATIENCE
    place = folder / LOCK if sys.platform == "win32" else folder
    while (lock := acquire_lock(place, os.O_RDONLY)) is None:
        try:
            who = f"process {int((folder / STAGING / WRITER).read_bytes())}"
        except (OSError, ValueError):  # it has not said so yet, or has just finished
            who = "another process"
        if time.monotonic() > end:
            raise OutputError(f"{folder}: {who} is writing there; nothing was written")
        progress(f"waiting for {who}, which is writing into {folder}")
        time.sleep(EVERY)
    try:
        yield
    finally:
        os.close(lock)  # releases it


def acquire_lock(place: Path, flags: int) -> int | None:
    """Lock `place` and return the lock, a file opened with `flags`; None if another process has it.

    On a file system without locks every process gets one: what is locked is still safe, but two
    processes at once are not kept apart.
    """
    if sys.platform == "win32":
        try:
            return os.open(place, os.O_CREAT | os.O_EXCL | os.O_TEMPORARY)  # goes when closed
        except FileExistsError:
            return None
    lock = os.open(place, flags, PRIVATE)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(lock)
        return None
    except OSError:
        pass
    return lock


# -- before ----------------------------------------------------------------------------------------


def _make_folder(folder: Path) -> list[Path]:
    """Create `folder` and its missing parents; return what was created, outermost first."""
    created: list[Path] = []
    try:
        if folder.exists() and not folder.is_dir():
            raise OutputError(f"{folder}: is a file, not a folder; nothing was written")
        missing = []
        place = folder
        while not place.exists():
            missing.append(place)
            place = place.parent
        for place in reversed(missing):
            with suppress(FileExistsError):  # another process was quicker
                place.mkdir()
                created.append(place)
    except OutputError:
        raise
    except (OSError, ValueError) as error:
        for place in reversed(created):
            place.rmdir()
        raise OutputError(
            f"{folder}: cannot create the folder: {unreadable(error)}; nothing was written"
        ) from error
    return created


def _refuse_overwriting(folder: Path, files: Mapping[str, bytes], *, force: bool) -> None:
    differing = []
    for name, data in files.items():
        target = folder / name
        if target.is_file():
            if target.read_bytes() != data:
                differing.append(name)
        elif target.is_symlink() and not target.exists():
            differing.append(name)  # a link to nothing is no file, but it is someone's
        elif target.is_dir():
            raise OutputError(f"{target}: is a folder; nothing was written")
        elif target.exists():
            raise OutputError(f"{target}: is not a regular file; nothing was written")
    if differing and not force:
        raise OutputError(
            f"{folder}: {', '.join(differing)} would be overwritten; allow it with --force, or"
            " give another folder with -o; nothing was written"
        )


def _outdated(folder: Path, files: Mapping[str, bytes], accounts: Accounts) -> tuple[str, ...]:
    """Names of the accounts in `folder` that no longer hold once `files` are written."""
    paths = [folder / name for name in files]
    if all(path.is_file() and path.read_bytes() == files[path.name] for path in paths):
        return ()
    return tuple(name for name, is_one in accounts.items() if is_one(folder / name))


# -- a set put in place, or taken back -------------------------------------------------------------


def _replace(folder: Path, files: Mapping[str, bytes], outdated: tuple[str, ...]) -> None:
    """Put the files in place and remove what is outdated, or leave everything as it was."""
    try:
        _stage(folder, files, outdated)
        _move_into_place(folder, tuple(files), outdated)
        with suppress(OSError):  # the next run removes what is left
            _clear(folder / STAGING)
    except BaseException:
        _restore(folder)
        raise


def _stage(folder: Path, files: Mapping[str, bytes], outdated: tuple[str, ...]) -> None:
    """Make the new files, and links to the old ones; then the journal, which makes them count."""
    staging = folder / STAGING
    for place in (staging, staging / NEW, staging / OLD):
        place.mkdir()
    (staging / WRITER).write_text(str(os.getpid()))
    for name, data in files.items():
        _write_durably(staging / NEW / name, data)
    for name in (*files, *outdated):
        if os.path.lexists(folder / name):
            _keep(folder / name, staging / OLD / name)
    sync(staging / NEW)
    sync(staging / OLD)
    _write_durably(staging / "names", json.dumps(list(files)).encode())
    (staging / "names").replace(staging / JOURNAL)
    sync(staging)
    sync(folder)


def _move_into_place(folder: Path, names: tuple[str, ...], outdated: tuple[str, ...]) -> None:
    *others, last = names
    for name in (*([last] if others else []), *outdated):
        (folder / name).unlink(missing_ok=True)
    sync(folder)
    for name in others:
        (folder / STAGING / NEW / name).replace(folder / name)
    sync(folder)
    (folder / STAGING / NEW / last).replace(folder / last)
    sync(folder)
    (folder / STAGING / JOURNAL).unlink()


def _restore(folder: Path) -> str:
    """Undo what a stopped run did and return a sentence on it, see `settle`.

    Each step leaves a state from which all steps can be taken again: a new file is either in place
    or in the staging folder, and an old one is put back once no new one is in place.
    """
    staging = folder / STAGING
    if not staging.is_dir() or staging.is_symlink():
        return ""
    said = (
        "a run was interrupted here before it had replaced anything; its remains have been removed"
    )
    if interrupted(folder):
        names = _names(staging / JOURNAL)
        for name in reversed(names):  # the last one vouches for the others
            if not os.path.lexists(staging / NEW / name) and os.path.lexists(folder / name):
                if (folder / name).is_dir():
                    reason = "is a folder now, which must be moved away"
                    raise OSError(errno.EISDIR, reason, str(folder / name))
                (folder / name).replace(staging / NEW / name)
        sync(folder)
        old_names = sorted(path.name for path in (staging / OLD).glob("*"))
        for name in (*(name for name in old_names if name not in names), *names):
            if os.path.lexists(staging / OLD / name) and not os.path.lexists(folder / name):
                (staging / OLD / name).replace(folder / name)
        sync(folder)
        (staging / JOURNAL).unlink()
        said = "a run was interrupted here; the files from before it have been put back"
    _clear(staging)
    return said


def _clear(staging: Path) -> None:
    """Remove the staging folder; `shutil.rmtree` may close a file twice if a signal comes."""
    for place in (staging / NEW, staging / OLD, staging):
        if place.is_dir() and not place.is_symlink():
            for path in place.iterdir():
                path.unlink()
            place.rmdir()


def _names(journal: Path) -> list[str]:
    """The names of the files of a set, in order; ValueError if the journal holds none."""
    try:
        names = json.loads(journal.read_bytes())
    except ValueError:
        names = None
    if isinstance(names, list) and all(
        isinstance(name, str) and Path(name).name == name for name in names
    ):
        return names
    raise ValueError(f"{journal} is damaged")


# -- single files ----------------------------------------------------------------------------------


def _keep(source: Path, target: Path) -> None:
    """Make `target` the same file as `source`, or a copy of it where there are no links."""
    try:
        os.link(source, target, follow_symlinks=False)
    except OSError:
        shutil.copy2(source, target, follow_symlinks=False)
        if not target.is_symlink():
            sync(target)


def _write_durably(path: Path, data: bytes) -> None:
    with path.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def sync(path: Path) -> None:
    """Wait until a folder's entries, or a file, are on disk; some systems cannot for folders."""
    if sys.platform == "win32":
        return
    opened = os.open(path, os.O_RDONLY)
    try:
        os.fsync(opened)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(opened)


# -- writing --------------------------------------------------------------------------------------


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
    name : name of the file.
    format : name of its writer.
    size : size in bytes.
    tolerance : requested tolerance [mm].
    deviation : proved deviation of the file as read back [mm]; None for pictures.
    facts : what its writer reports, e.g. the number of arcs.
    findings : findings that matter to whoever uses the file.
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
    """A report on the files that were written.

    Attributes
    ----------
    paths : paths of all files, the certificate last.
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
    """Whether a file is a verification that camgeo has written."""
    try:
        document = json.loads(read_limited(path, VERIFIED))
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(document, dict) and document.get("kind") == KIND


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
        message = f"no format is named; the formats are {', '.join(writer_names())}"
        raise SceneError([Fault("format", "", message)])
    product = discs[0]
    contents: dict[str, bytes] = {}
    reports: list[FileReport] = []
    named_writers = find_writers(formats)
    if lacking := product.scene.lacking(writer.format for writer in named_writers.values()):
        raise SceneError(lacking, product.scene.source.file)
    if forbidden := forbidding(product.findings):
        raise UndercutError("; ".join(finding.sentence for finding in forbidden))
    writers = [
        (name, companion)
        for name, one in named_writers.items()
        for companion in with_companions(one)
    ]
    for disc, name, writer in _pieces(discs, writers):
        label = name if disc is product else f"{name} of {disc.name}"
        written, deviation = _make(disc, label, writer, tolerance, progress)
        file = f"{disc.name}{writer.format.ending(disc.options)}"
        if file in contents:
            message = f"would be {file}, as another file of the same set"
            raise SceneError([Fault("format", name, message)])
        contents[file] = written.data
        size, facts = len(written.data), written.facts
        findings = findings_in_unit(disc.unit, written.findings)
        reports.append(FileReport(file, name, size, tolerance, deviation, facts, findings))
    contents[CERTIFICATE] = _certificate(discs, tolerance, reports, contents)
    return contents, tuple(reports)


def _pieces(
    discs: Sequence[Product], writers: Sequence[tuple[str, Writer]]
) -> Iterator[tuple[Product, str, Writer]]:
    """The product of which each file is made, with the name of its format and its writer."""
    for disc in discs:
        for name, writer in writers:
            for piece in file_products(writer, disc):
                yield piece, name, writer


def _make(
    disc: Product, name: str, writer: Writer, tolerance: float, progress: Progress
) -> tuple[Written, float | None]:
    """One file of one disc, and its deviation as read back [mm]; `name` is for messages.

    Files that are read have limits (`camgeo.reading`); a file beyond them is not written.
    """
    progress(f"{name}: computing")
    try:
        with disc.ledger.entry(f"{name} file"):
            written = writer.write(disc, tolerance)
    except ToleranceError as error:
        # The writer used a share of the tolerance; the user knows the whole.
        raise ToleranceError(f"{name}: {error.reason}", tolerance, error.reached) from error
    except FileError as error:
        raise FileError(f"{name}: {error}") from error
    progress(f"{name}: reading back")
    try:
        with disc.ledger.entry(f"{name} file, measured"):
            deviation = writer.measure(disc, written.data)
    except FileError as error:
        raise FileError(f"{name}: the file cannot be read back: {error}") from error
    if deviation is not None and not deviation <= tolerance:
        raise ToleranceError(f"the {name} file, read back, deviates", tolerance, deviation)
    return written, deviation


def _certificate(
    discs: Sequence[Product],
    tolerance: float,
    reports: list[FileReport],
    contents: dict[str, bytes],
) -> bytes:
    """The certificate as JSON: what has been proved about the files, and the findings on the discs
    and their parts. It is the same for the same scene.
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
                {**_stated(finding), "part": disc.name}
                for disc in with_pair(discs)
                for finding in part_findings(disc)
            ),
            *map(_stated, chain.from_iterable(report.findings for report in reports)),
        ],
    }
    return (json.dumps(document, indent=2, allow_nan=False) + "\n").encode()


def _stated(finding: Finding) -> dict[str, Any]:
    """A finding as the certificate states it."""
    return {key: getattr(finding, key) for key in ("name", "severity", "value", "limit", "unit")}


# -- writer ---------------------------------------------------------------------------------------
# What a writer of one format is, and the writers available.
#
# Writers register as entry points of the group ``camgeo.writers``; the entry point's name is the
# format's name on the command line and in the scene, and it loads an object that is a `Writer`.


@dataclass(frozen=True, slots=True)
class Written:
    """A file's content and what its writer reports about it.

    Attributes
    ----------
    data : the whole file.
    facts : what the certificate should state besides the deviation, e.g. {"arcs": 64}; numbers and
        short texts, in the order of writing.
    findings : findings that matter to whoever uses the file.
    """

    data: bytes
    facts: dict[str, int | float | str] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()


class Writer(Protocol):
    """One file format.

    Attributes
    ----------
    format : declaration of the format, whose name is that of the entry point.

    A writer may also have `companions`, a tuple of writers of the format's further files, each
    with its own suffix, and `pieces`, which returns the products of which it makes one file each,
    where one file cannot hold all.
    """

    @property
    def format(self) -> Format[Any]: ...

    def write(self, product: Product, tolerance: float) -> Written:
        """The file; everything in it lies within `tolerance` [mm] of the exact curve.

        Raises ToleranceError if this cannot be met.
        """

    def measure(self, product: Product, data: bytes) -> float | None:
        """Read `data` back and return the proved deviation [mm]; None for pictures."""


def writer_names() -> tuple[str, ...]:
    """Names of all formats that can be written, sorted."""
    return tuple(sorted(writer_entries()))


def with_companions(writer: Writer) -> tuple[Writer, ...]:
    """The writers of all files of a format, `writer` first; their suffixes differ."""
    further: tuple[Writer, ...] = getattr(writer, "companions", ())
    return (writer, *further)


def file_products(writer: Writer, product: Product) -> tuple[Product, ...]:
    """The products of which the writer makes one file each, usually `product` alone."""
    pieces: Callable[[Product], tuple[Product, ...]] | None = getattr(writer, "pieces", None)
    return (product,) if pieces is None else pieces(product)


def find_writer(name: str) -> Writer:
    """Load the writer of format `name`; SceneError if there is none."""
    return find_writers((name,))[name]


def find_writers(names: Iterable[str]) -> dict[str, Writer]:
    """Load the writers of several formats, as `find_writer`, searching the installation once."""
    entries = writer_entries()
    writers: dict[str, Writer] = {}
    for name in names:
        if name not in entries:
            known = sorted(entries)
            message = f"there is no writer for this format; the formats are {', '.join(known)}"
            hint = NO_FORMATS.get(name) or meant(name, known, '"')
            raise SceneError([Fault("format", name, message, hint)])
        writers[name] = load_format(entries[name])[0]
    return writers
