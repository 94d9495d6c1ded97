"""What `camgeo verify` finds: files compared with the exact curves of their scene."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, Final

from camgeo._version import __version__
from camgeo.app.answers.answer import BROKEN, CRASHED, FINE, Answer, Key
from camgeo.app.cli.command import CallError, add_json, add_origin, number_from, settle, show
from camgeo.app.cli.streams import notify
from camgeo.design.design import Design
from camgeo.design.verify import (
    Against,
    Check,
    Verdict,
    Wanted,
    endings,
    files_in,
    scene_file,
    verify_files,
    write_verification,
)
from camgeo.design.writing import VERIFICATION
from camgeo.errors import Fault, SceneError, unreadable
from camgeo.scene.scene import hashes_of, load_scene
from camgeo.units import LengthUnit, in_unit, unit_in


@dataclass(frozen=True, slots=True)
class Verification(Answer):
    """Files, and the verdicts on them.

    Attributes
    ----------
    paths : of the files.
    verdicts : one per file, in the same order.
    """

    paths: tuple[Path, ...]
    verdicts: tuple[Verdict, ...]

    @property
    def passed(self) -> bool:
        """Whether all files pass."""
        return all(verdict.passed for verdict in self.verdicts)

    @property
    def records(self) -> tuple[Mapping[str, Any], ...]:
        """The verdicts as a verification.json holds them."""
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
    wanted : the requirements; None for those stated by the files and their scene.
    scene : path of the scene; None for the one whose hash the files name, looked for in their
        folder, the one above and the present one.

    Raises
    ------
    SceneError
        If none of the files can be compared: they are of a format that cannot be read, or their
        scene is not found or wrong.
    """
    return Verification(paths, verify_files(paths, _scenes(scene), wanted or Wanted()))


def _scenes(named: str | Path | None) -> Callable[[Path, str], Against]:
    """A function that finds the scene of a file; each scene is read once."""

    @cache
    def load(path: Path) -> Against:
        design = Design(load_scene(path))
        scene = design.scene
        return Against(design.discs, scene.output.tolerance, scene.made_before)

    def find(folder: Path, sha256: str) -> Against:
        if named is not None:
            return load(Path(named))
        return load(scene_file((folder, folder / "..", Path()), sha256, hashes_of))

    return find


# -- document -------------------------------------------------------------------------------------
# What JSON has of the answer.


DOCUMENT: Final = Key(
    "Files read back and compared with the exact curves of their scene.",
    {
        "passed": "Whether all files pass.",
        "files": Key(
            "In the order in which they were named.",
            {
                "file": Key("Its name.", type=str),
                "format": Key("Name of its format.", type=str),
                "sha256": Key("SHA-256 of its bytes, hexadecimal.", type=str),
                "bytes": Key("Its size.", type=int),
                "scene": Key(
                    "The scene that it was compared with, if it was measured.",
                    {
                        "name": Key("Name of the scene.", type=str),
                        "sha256": Key("Its hash as written in the file, hexadecimal.", type=str),
                    },
                    type=dict[str, Any],
                    optional=True,
                    by_key=True,
                ),
                "tolerance_mm": Key(
                    "The tolerance that was applied, if it was measured.", type=float, optional=True
                ),
                "tolerance_from": Key(
                    "Origin of the tolerance: the call, the file, its certificate or the scene.",
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
                        "value": Key("What was found, in `unit`.", type=float | str, optional=True),
                        "expected": Key("What it should be.", type=float | str, optional=True),
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
# What `camgeo verify` finds, in words.


MARKS: Final = {True: "ok", False: "FAIL", None: ""}

WIDTHS: Final = (34, 20, 32)
"""Columns of a check: what, found, allowed."""


def text(answer: Verification) -> str:
    """Each file with its result, and its checks below it."""
    lines = []
    for path, verdict in zip(answer.paths, answer.verdicts, strict=True):
        checks = (_line(_divided(check, verdict.length)) for check in verdict.checks)
        lines += [in_unit(_headline(path, verdict), verdict.length), *checks]
    return "\n".join(lines)


def _headline(path: Path, verdict: Verdict) -> str:
    """The file and its result."""
    word = "pass" if verdict.passed else "FAIL"
    if verdict.tolerance is None:
        return f"{path}: {word}, {'bytes only' if verdict.passed else 'not measured'}"
    tolerance, who = verdict.tolerance
    off = verdict.deviation
    text = "deviation not proved" if off is None else f"at most {off:.3g} mm off"
    return f"{path}: {word}, {text} (tolerance {tolerance:g} mm, by {who})"


def _divided(check: Check, length: LengthUnit) -> Check:
    """The check with its numbers in the unit of length of the scene."""
    unit, divisor = unit_in(check.unit, length)

    def shown(value: Any) -> Any:
        return value / divisor if isinstance(value, float) and divisor != 1.0 else value

    figures = {name: shown(getattr(check, name)) for name in ("value", "expected", "limit")}
    return replace(check, **figures, unit=unit)


def _line(check: Check) -> str:
    """One check: what, found, allowed, verdict, note."""
    name = f"{check.name} {check.of}".rstrip()
    found = _text(check.value, check.unit)
    if check.expected is not None:
        found, allowed = _long(check.value), _long(check.expected)
        if check.limit is not None:
            allowed += f" +- {check.limit:.3g} {check.unit}"
    else:
        allowed = "" if check.limit is None else f"<= {_text(check.limit, '')}"
    columns = "".join(
        f"{text:{width}} " for text, width in zip((name, found, allowed), WIDTHS, strict=True)
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


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    parser.add_argument("files", metavar="FILE|DIR", nargs="+", help="files, or a folder of files")
    parser.add_argument(
        "--scene",
        metavar="SCENE",
        help="scene file (TOML); default: the one whose hash the files name, searched for in their"
        " folder, the one above it and the current one",
    )
    parser.add_argument(
        "--tolerance", metavar="MM", type=number_from(math.ulp(0.0), math.inf, "a length above 0"),
        help="largest deviation; default: from the file, certificate.json or the scene",
    )  # fmt: skip
    parser.add_argument(
        "--unit", choices=("mm", "inch"), help="unit of files that do not state it; STL: default mm"
    )
    parser.add_argument("--layer", metavar="NAME", help="layer of drawings; default CUT, or all")
    add_origin(parser, "drawings (DXF) of others")
    add_json(parser)
    parser.add_argument(
        "-o", metavar="FILE", dest="output",
        help="certificate to write; default: verification.json in their folder",
    )  # fmt: skip
    parser.add_argument("--force", action="store_true", help="overwrite existing files")


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
            raise CallError("the files are in several folders: say with -o where to write")
        target = folders.pop() / VERIFICATION
    origin = complex(*arguments.origin)
    wanted = Wanted(arguments.tolerance, arguments.layer, arguments.unit, origin)
    found = verify(paths, wanted, scene=arguments.scene)
    code = show(found, arguments)
    if any(verdict.measured for verdict in found.verdicts):
        write_verification(target, __version__, found.verdicts, force=arguments.force)
        notify(f"{target}: the results")
    else:
        notify("nothing was measured, and nothing was written")
    return code


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
            found = files_in(path)
        except OSError as error:
            fault = Fault("DIR", str(path), f"cannot be read: {unreadable(error)}")
            raise SceneError([fault]) from error
        if not found:
            message = f"the folder holds no file that ends in {', '.join(endings())}"
            raise SceneError([Fault("DIR", str(path), message)])
        paths += found
    return tuple(dict.fromkeys(paths))
