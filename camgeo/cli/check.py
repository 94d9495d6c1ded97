"""`camgeo check`: the findings of a scene."""

from __future__ import annotations

import argparse
from decimal import Decimal
from typing import TYPE_CHECKING, Any

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

if TYPE_CHECKING:
    from camgeo.check.cures import Cure
    from camgeo.check.cures.cure import Value


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
    """Print the findings, and what would cure undercut."""
    design = Design(load_scene(arguments.scene))
    findings = design.findings
    if arguments.json:
        records = [finding_record(finding) for finding in findings]
        document = {**identity(design), "motion": motion_record(design), "findings": records}
        print_json(document | {"cures": [cure_record(cure) for cure in design.cures]})
    else:
        print("\n".join(finding_lines(findings)))
        print_cures(design.cures)
    return exit_code(findings)


def print_cures(cures: tuple[Cure, ...]) -> None:
    """The cures that work, the cheapest first, then the knobs that do not cure."""
    if not cures:
        return
    print("\nAny one of these cures the undercut; it may break another limit, so check again:")
    for cure in cures:
        print(f"  {cure.sentence}" if cure.works else f"  no cure: {cure.sentence}")


def cure_record(cure: Cure) -> dict[str, Any]:
    """A cure for JSON; lengths in mm, angles in degrees."""
    return {
        "knob": cure.knob,
        "key": cure.key,
        "from": _plain(cure.value_from),
        "to": None if cure.value_to is None else _plain(cure.value_to),
        "unit": cure.unit,
        "cost": cure.cost,
        "also": [
            {"key": each.key, "from": _plain(each.value_from), "to": _plain(each.value_to)}
            for each in cure.also
        ],
        "sentence": cure.sentence,
    }


def _plain(value: Value) -> float | str:
    return float(value) if isinstance(value, Decimal) else value
