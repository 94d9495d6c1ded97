"""`camgeo build`: write a scene's files and their certificate."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from camgeo.cli.command import (
    Subparsers,
    exit_code,
    finding_lines,
    identity,
    new_parser,
    print_json,
    tell,
)
from camgeo.cli.progress import Progress
from camgeo.design import Design
from camgeo.scene.load import load_scene

if TYPE_CHECKING:
    from camgeo.files.write import FileReport


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = new_parser(
        subparsers,
        "build",
        "write the files of a scene and certificate.json beside them",
        "camgeo build fixtures/scenes/setzhub.toml -o out --only dxf,gcode",
    )
    parser.add_argument("scene", metavar="SCENE", help="scene file (TOML)")
    parser.add_argument(
        "-o", metavar="DIR", dest="output", default=".", help="folder; default here"
    )
    parser.add_argument("--only", metavar="FORMATS", help="comma-separated: dxf,gcode,stl,3mf,...")
    parser.add_argument(
        "--tolerance", metavar="MM", type=float, help="largest deviation, in place of the scene's"
    )
    parser.add_argument("--force", action="store_true", help="write over files that differ")
    parser.add_argument("--json", action="store_true", help="print the report as JSON")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write the files; findings beyond a limit are told, a disc that cannot be is refused."""
    design = Design(load_scene(arguments.scene))
    findings = design.findings
    bad = tuple(f for f in findings if f.severity != "ok")
    for line in finding_lines(bad):
        tell(line)
    if not design.judgement.has_outline:
        tell("nothing was written: the cam has no outline")
        return exit_code(findings)
    from camgeo.files.write import write_files  # not before it is needed: a check writes nothing

    output = design.scene.output
    formats = output.formats
    if arguments.only is not None:
        formats = tuple(name.strip() for name in arguments.only.split(",") if name.strip())
    tolerance = output.tolerance if arguments.tolerance is None else arguments.tolerance
    with Progress() as progress:
        report = write_files(
            design.discs,
            arguments.output,
            formats,
            tolerance,
            force=arguments.force,
            progress=progress,
        )
    if arguments.json:
        files = [{"file": f.name, **_record(f)} for f in report.files]
        print_json({**identity(design.scene), "tolerance_mm": tolerance, "files": files})
    else:
        for path, file in zip(report.paths, report.files, strict=False):
            print(f"{path!s:39} {_sentence(file)}")
        print(f"{report.paths[-1]!s:39} proof of the above")
    return exit_code(findings)


def _record(file: FileReport) -> dict[str, object]:
    return {
        "format": file.format,
        "bytes": file.size,
        "tolerance_mm": file.tolerance,
        "deviation_mm": file.deviation,
        **file.facts,
    }


def _sentence(file: FileReport) -> str:
    if file.deviation is None:
        return f"{file.size:>10,} bytes"
    return (
        f"{file.size:>10,} bytes, at most {file.deviation:.3g} mm off (tolerance"
        f" {file.tolerance:g} mm)"
    )
