"""`camgeo verify`: files read back and compared with the exact curves of their scene."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Final

from camgeo._version import __version__
from camgeo.app.answers.verify import verify
from camgeo.app.cli.command import CallError, add_json, add_origin, number, settle, show
from camgeo.app.cli.streams import notify
from camgeo.design.verify import Wanted, endings, files_in, write_verification
from camgeo.design.writing import VERIFICATION
from camgeo.errors import Fault, SceneError, unreadable

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
        "--tolerance", metavar="MM", type=_length,
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


def _length(text: str) -> float:
    length = number(text)
    if length <= 0.0:
        raise argparse.ArgumentTypeError("must be a length above 0")
    return length


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
