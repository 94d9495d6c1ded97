"""`camgeo build`: write the files of a scene and their certificate."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Final

from camgeo.app.answers.answer import finding_lines
from camgeo.app.answers.build import build, poor_findings
from camgeo.app.cli.command import add_scene, number, opened, settle, show
from camgeo.app.cli.streams import notify

EXAMPLE: Final = "camgeo build fixtures/scenes/setzhub.toml -o out --only dxf,gcode"


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_scene(parser)
    parser.add_argument(
        "-o", metavar="DIR", dest="output", default=".", help="folder; default: the current one"
    )
    parser.add_argument("--only", metavar="FORMATS", help="comma-separated: dxf,gcode,stl,3mf,...")
    parser.add_argument(
        "--tolerance", metavar="MM", type=number, help="largest deviation, instead of the scene's"
    )
    parser.add_argument("--force", action="store_true", help="overwrite existing files that differ")
    parser.add_argument("--json", action="store_true", help="print the report as JSON")


def run(arguments: argparse.Namespace) -> int:
    """Write the files; report findings beyond a limit, and refuse a disc that cannot exist."""
    design = opened(arguments)
    findings = poor_findings(design)
    for line in finding_lines(findings):
        notify(line)
    formats = arguments.only
    if formats is not None:
        formats = tuple(name.strip() for name in formats.split(",") if name.strip())
    settle(Path(arguments.output), arguments)
    found = build(
        design,
        arguments.output,
        formats,
        tolerance=arguments.tolerance,
        force=arguments.force,
        findings=findings,
        progress=arguments.progress,
    )
    if found.certificate is None:
        notify("nothing was written: the cam has no outline")
    for line in finding_lines(each for file in found.files for each in file.findings):
        notify(line)
    return show(found, arguments)
