"""`camgeo verify`: files read back, and held against the exact curves of their scene."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from camgeo.cli.command import BROKEN, FINE, Subparsers, new_parser, print_json, tell
from camgeo.design import Design
from camgeo.errors import Fault, SceneError
from camgeo.scene.load import load_scene

if TYPE_CHECKING:
    from camgeo.files.verification import Check, Verdict
    from camgeo.files.verify import Against

MARKS = {True: "ok", False: "FAIL", None: ""}

WIDTHS = (34, 20, 32)
"""Columns of a check: what, found, allowed."""


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = new_parser(
        subparsers,
        "verify",
        "read DXF, G-code, STL and 3MF files back and measure them against the exact curves",
        "camgeo verify out/setzhub\n"
        "  camgeo verify drawing.dxf --scene my-cam.toml --tolerance 0.01 --layer OUTLINE\n"
        "  camgeo verify out/setzhub --json -o proof.json",
    )
    parser.add_argument(
        "files", metavar="FILE|DIR", nargs="+", help="files, or a folder with all that are in it"
    )
    parser.add_argument(
        "--scene",
        metavar="SCENE",
        help="scene file (TOML); default the one whose hash the files name, looked for in their"
        " folder, the one above and the present one",
    )
    parser.add_argument(
        "--tolerance", metavar="MM", type=float,
        help="largest deviation; default what the file, certificate.json or the scene says",
    )  # fmt: skip
    parser.add_argument(
        "--unit", choices=("mm", "inch"), help="unit of files that do not say one; STL: default mm"
    )
    parser.add_argument("--layer", metavar="NAME", help="layer of drawings; default CUT, or all")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument(
        "-o", metavar="FILE", dest="output",
        help="certificate to write; default verification.json beside the files",
    )  # fmt: skip
    parser.add_argument("--force", action="store_true", help="write over any existing file")
    parser.set_defaults(run=partial(run, parser))


def run(parser: argparse.ArgumentParser, arguments: argparse.Namespace) -> int:
    """Verify; 0 if all files pass, 1 if one does not."""
    if arguments.tolerance is not None and not (
        math.isfinite(arguments.tolerance) and arguments.tolerance > 0.0
    ):
        parser.error("argument --tolerance: must be a length above 0")
    from camgeo._version import __version__
    from camgeo.files.verification import document
    from camgeo.files.verify import VERIFICATION, Wanted, verify_files, write_verification

    paths = _paths(arguments.files)
    target = None if arguments.output is None else Path(arguments.output)
    if target is None:
        folders = {path.parent for path in paths}
        if len(folders) > 1:
            parser.error("the files lie in several folders: say with -o where to write")
        target = folders.pop() / VERIFICATION
    wanted = Wanted(arguments.tolerance, arguments.layer, arguments.unit)
    verdicts = verify_files(paths, _scenes(arguments.scene), wanted)
    if arguments.json:
        print_json(document(__version__, verdicts))
    else:
        for path, verdict in zip(paths, verdicts, strict=True):
            print(_headline(path, verdict))
            for check in verdict.checks:
                print(_line(check))
    if any(verdict.measured for verdict in verdicts):
        write_verification(target, __version__, verdicts, force=arguments.force)
        tell(f"{target}: what was found")
    else:
        tell("nothing was measured, and nothing was written")
    return FINE if all(verdict.passed for verdict in verdicts) else BROKEN


def _paths(names: list[str]) -> tuple[Path, ...]:
    """The files, those of folders in place of the folders; each once."""
    from camgeo.files.verify import endings, files_in

    paths: list[Path] = []
    for name in names:
        path = Path(name)
        if not path.is_dir():
            paths.append(path)
            continue
        found = files_in(path)
        if not found:
            message = f"the folder holds no file that ends in {', '.join(endings())}"
            raise SceneError([Fault("DIR", name, message)])
        paths += found
    return tuple(dict.fromkeys(paths))


def _scenes(named: str | None) -> Callable[[Path, str], Against]:
    """What finds the scene of a file; each scene is read once."""
    from camgeo.files.verify import Against, scene_file
    from camgeo.scene.fingerprint import hashes_of

    known: dict[str, Against] = {}

    def load(path: str) -> Against:
        if path not in known:
            design = Design(load_scene(path))
            scene = design.scene
            known[path] = Against(design.discs, scene.output.tolerance, scene.made_before)
        return known[path]

    def find(folder: Path, sha256: str) -> Against:
        if named is not None:
            return load(named)
        return load(str(scene_file((folder, folder / "..", Path()), sha256, hashes_of)))

    return find


# What is told -------------------------------------------------------------------------------------


def _headline(path: Path, verdict: Verdict) -> str:
    """The file and what became of it."""
    word = "pass" if verdict.passed else "FAIL"
    if verdict.tolerance is None:
        return f"{path}: {word}, {'bytes only' if verdict.passed else 'not measured'}"
    tolerance, who = verdict.tolerance
    off = verdict.deviation
    text = "deviation not proved" if off is None else f"at most {off:.3g} mm off"
    return f"{path}: {word}, {text} (tolerance {tolerance:g} mm, by {who})"


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
    """With the digits that a comparison needs."""
    return f"{value:.9g}" if isinstance(value, float) else value or ""
