"""`camgeo check`: the findings of a scene."""

from __future__ import annotations

import argparse

from camgeo.cli.command import (
    Subparsers,
    exit_code,
    finding_lines,
    finding_record,
    identity,
    motion_record,
    new_parser,
    print_json,
)
from camgeo.design import Design
from camgeo.scene.load import load_scene


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = new_parser(
        subparsers,
        "check",
        "hold a scene to its limits; exit 0 fine, 1 a limit is broken, 2 the scene is wrong",
        "camgeo check fixtures/scenes/setzhub.toml",
    )
    parser.add_argument("scene", metavar="SCENE", help="scene file (TOML)")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the findings."""
    design = Design(load_scene(arguments.scene))
    findings = design.findings
    if arguments.json:
        records = [finding_record(finding) for finding in findings]
        print_json({**identity(design), "motion": motion_record(design), "findings": records})
    else:
        print("\n".join(finding_lines(findings)))
    return exit_code(findings)
