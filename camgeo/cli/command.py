"""What all commands share: exit codes, help with examples, text and JSON output."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Sequence
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from camgeo._version import __version__
from camgeo.check.finding import Finding
from camgeo.design import Design
from camgeo.motion.joints import joints
from camgeo.motion.plan import Course, Move

if TYPE_CHECKING:
    from camgeo.scene.scene import Scene

FINE: Final = 0
BROKEN: Final = 1
WRONG: Final = 2
"""Exit codes: all limits kept; a limit is broken; the scene or the call is wrong."""

MARKS: Final = {
    "invalid": "INVALID",
    "no-disc": "NO DISC",
    "broken": "BROKEN",
    "warning": "warning",
    "ok": "ok",
}

NAME_WIDTH: Final = 26
"""Of the names of findings, at least."""

Subparsers = argparse._SubParsersAction  # noqa: SLF001 - argparse gives its type no public name


def new_parser(
    subparsers: Subparsers[argparse.ArgumentParser], name: str, summary: str, example: str
) -> argparse.ArgumentParser:
    """A command's parser, with an example in its help."""
    return subparsers.add_parser(
        name,
        help=summary,
        description=summary[0].upper() + summary[1:] + ".",
        epilog=f"example:\n  {example}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )


def add_output(parser: argparse.ArgumentParser, text: str) -> None:
    """The options that name a file to write, which `text` describes, and let it be overwritten."""
    parser.add_argument("-o", metavar="FILE", dest="output", help=text)
    parser.add_argument("--force", action="store_true", help="write over an existing file")


def write_told(files: Sequence[tuple[Path, bytes, str]], *, force: bool) -> None:
    """Write files of one folder, all or none, and tell each with what is said of it."""
    if not files:
        return
    from camgeo.files.transaction import write_set  # most commands write nothing

    write_set(files[0][0].parent, {path.name: data for path, data, _ in files}, force=force)
    for path, _, text in files:
        tell(f"{path}: {text}")


def require_beside(
    parser: argparse.ArgumentParser, option: str, name: str | None, output: str | None
) -> None:
    """Leave with a message if the files of `option` and of `-o` are the same, or not in one folder.

    Files are written as a set, whole or not at all, and a set lies in one folder.
    """
    if name is None or output is None:
        return
    if Path(name) == Path(output):
        parser.error(f"{option} and -o name the same file")
    if Path(name).parent != Path(output).parent:
        parser.error(f"{option} and -o must name files in the same folder")


def decimal_of(
    parser: argparse.ArgumentParser, option: str, text: str, what: str = "number"
) -> Decimal:
    """The number in the text of an option; ends the command if there is none."""
    try:
        number = Decimal(text)
    except InvalidOperation:
        number = Decimal("NaN")
    if not number.is_finite():
        parser.error(f"argument --{option}: {text!r} is no {what}")
    return number


def step_of(
    parser: argparse.ArgumentParser, text: str, smallest: Decimal, largest: Decimal
) -> Decimal:
    """The step of the cam angle [degrees] in the text of `--step`; ends the command if it is none
    from `smallest` to `largest`.
    """
    step = decimal_of(parser, "step", text, "number of degrees")
    if not smallest <= step <= largest:
        parser.error(f"argument --step: {text} degrees; from {smallest} to {largest} are allowed")
    return step


def exit_code(findings: tuple[Finding, ...]) -> int:
    """2 if there is no such mechanism, 1 if a limit is broken or there is no such disc, else 0."""
    if any(f.severity == "invalid" for f in findings):
        return WRONG
    return BROKEN if any(f.severity in ("broken", "no-disc") for f in findings) else FINE


def finding_lines(findings: tuple[Finding, ...]) -> list[str]:
    """One line a finding, marks and sentences aligned."""
    width = max([NAME_WIDTH, *(len(f.name) + 2 for f in findings)])
    return [f"{MARKS[f.severity]:8}{f.name:{width}}{f.sentence}" for f in findings]


def finding_record(finding: Finding) -> dict[str, Any]:
    """A finding for JSON; angles in degrees."""
    place = None if finding.cam_angle is None else math.degrees(finding.cam_angle)
    span = finding.cam_range and [math.degrees(angle) for angle in finding.cam_range]
    return {
        "name": finding.name,
        "severity": finding.severity,
        "value": finding.value,
        "limit": finding.limit,
        "unit": finding.unit,
        "cam_angle_deg": place,
        "cam_range_deg": span,
        "sentence": finding.sentence,
    }


def motion_record(design: Design) -> dict[str, Any]:
    """Segments and joints of the motion plan for JSON; angles in degrees, derivatives per rad^k.

    Positions are in mm, or in rad where the demanded motion turns.
    """
    plan = design.scene.plan
    segments = []
    for segment in plan.segments:
        record: dict[str, Any] = {"span_deg": float(segment.span)}
        if isinstance(segment, Move):
            law = segment.law
            record |= {"to": segment.to, "law": law.name, "task": law.task}
            record["parameters"] = dict(law.parameters)
        elif isinstance(segment, Course):
            record |= {"to": segment.to, "law": "data"}
            if segment.report is not None:
                record["largest_deviation"] = segment.report.largest_deviation
        segments.append(record)
    return {
        "segments": segments,
        "joints": [
            {
                "cam_angle_deg": math.degrees(joint.cam_angle),
                "before": joint.before,
                "after": joint.after,
                "continuous_derivatives": joint.order,
                "left": joint.left.tolist(),
                "right": joint.right.tolist(),
            }
            for joint in joints(plan)
        ],
    }


def print_json(document: object) -> None:
    """A JSON document on standard output; NaN and infinity never get there."""
    print(json.dumps(document, indent=2, allow_nan=False))


def tell(message: str) -> None:
    """A line for the person at the terminal, on standard error."""
    print(message, file=sys.stderr)


def identity(scene: Scene) -> dict[str, Any]:
    """What made a result: scene, its hash, version."""
    record: dict[str, Any] = {"name": scene.name, "sha256": scene.made}
    if scene.files:
        record["files"] = dict(scene.files)
    return {"camgeo": __version__, "scene": record}


def tell_main_disc(design: Design, what: str) -> None:
    """Say of a conjugate pair that `what`, in the plural, is of the main disc alone."""
    if design.scene.returning is not None:
        tell(f"{what} of the main disc; the return disc, {design.name}-return, is not covered")
