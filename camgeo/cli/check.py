"""`camgeo check`: the findings of a scene."""

from __future__ import annotations

import argparse
import math
from decimal import Decimal
from typing import TYPE_CHECKING, Any

from camgeo.check.finding import Finding
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
from camgeo.errors import GeometryError
from camgeo.scene.load import load_scene

if TYPE_CHECKING:
    from camgeo.cam.disc import Disc
    from camgeo.check.cures.cure import Cure, Value
    from camgeo.files.product import Product


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
    effects = effect_findings(design)
    if arguments.json:
        records = [finding_record(finding) for finding in findings]
        document = {**identity(design.scene), "motion": motion_record(design), "findings": records}
        if design.judgement.cams:
            document["outlines"] = outline_records(design.disc)
            for other in design.disc.others:
                document["return"] = {"name": other.name, "outlines": outline_records(other)}
        document["cures"] = [cure_record(cure) for cure in design.cures]
        if effects:
            document["effects"] = {
                name: [finding_record(finding) for finding in found]
                for name, found in effects.items()
            }
        print_json(document)
    else:
        print("\n".join(finding_lines(findings)))
        print_cures(design.cures)
        for name, found in effects.items():
            print("\n".join(("", f"{name}:", *finding_lines(found))))
    return exit_code((*findings, *(each for found in effects.values() for each in found)))


def effect_findings(design: Design) -> dict[str, tuple[Finding, ...]]:
    """What each effect finds that the scene calls for; nothing if there is no such mechanism."""
    if any(finding.severity == "invalid" for finding in design.findings):
        return {}
    return {name: design.effects.findings(name) for name in design.scene.effects}


def print_cures(cures: tuple[Cure, ...]) -> None:
    """The cures that work, the cheapest first, then the knobs that do not cure."""
    if not cures:
        return
    print("\nAny one of these cures the undercut; it may break another limit, so check again:")
    for cure in cures:
        print(f"  {cure.sentence}" if cure.works else f"  no cure: {cure.sentence}")


def outline_records(piece: Product) -> dict[str, Any]:
    """What is left of each flank in use of a disc, for JSON."""
    disc = piece.cam.disc
    return {name: outline_record(disc, name) for name, _ in disc.flanks}


def outline_record(disc: Disc, flank: str) -> dict[str, Any] | None:
    """What is left of a flank, for JSON; None if nothing is, or it cannot be told."""
    from camgeo.outline.moments import area

    try:
        outline = disc.outline(flank)
    except GeometryError:
        return None
    corners = [pivot for pivot in outline.path.pivots if pivot.distance == 0.0]
    return {
        "area_mm2": abs(area(outline.path)),
        "left_out_deg": [[math.degrees(angle) for angle in span] for span in outline.dropped],
        "corners": [
            {
                "point_mm": [corner.centre.real, corner.centre.imag],
                "from_deg": math.degrees(corner.before),
                "to_deg": math.degrees(corner.after),
                "turn_deg": math.degrees(corner.sweep),
            }
            for corner in corners
        ],
        "lobes_mm2": [abs(area(lobe)) for lobe in outline.lobes],
    }


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
