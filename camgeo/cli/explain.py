"""`camgeo explain`: what a command computes of a scene, for whom, and how long each took."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any, Final

from camgeo.cam.disc import Disc
from camgeo.cam.drive import Drive
from camgeo.check.judge import Judgement
from camgeo.cli.check import effect_findings
from camgeo.cli.command import FINE, Subparsers, identity, new_parser, print_json, tell_main_disc
from camgeo.cli.progress import Progress
from camgeo.design import Design
from camgeo.files.drawn import DrawnDisc
from camgeo.files.milled import MilledDisc
from camgeo.lazy import Run, lazy_names
from camgeo.scene.load import load_scene

MILLI: Final = 1e3
INDENT: Final = "  "

OWNERS: Final = (Drive, Disc, Judgement, DrawnDisc, MilledDisc)
"""What has quantities that are computed on demand, in the order of the stages."""


def _check(design: Design) -> None:
    """What `camgeo check` asks for."""
    if design.findings:
        _ = design.cures
    effect_findings(design)


def _table(design: Design) -> None:
    """What `camgeo table` asks for."""
    design.tabulated.table()


def _build(design: Design) -> None:
    """What `camgeo build` asks for; nothing is written."""
    from camgeo.files.write import make_files

    if design.judgement.has_outline:
        output = design.scene.output
        with Progress() as progress:
            make_files(design.discs, output.formats, output.tolerance, progress=progress)


GOALS: Final[dict[str, Callable[[Design], None]]] = {
    "check": _check,
    "table": _table,
    "build": _build,
}


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = new_parser(
        subparsers,
        "explain",
        "show what a command computes of a scene, for whom, how long it takes, and what is left"
        " alone",
        "camgeo explain fixtures/scenes/setzhub.toml build",
    )
    parser.add_argument("scene", metavar="SCENE", help="scene file (TOML)")
    parser.add_argument(
        "command", metavar="COMMAND", nargs="?", default="check", choices=tuple(GOALS),
        help=f"one of {', '.join(GOALS)}; default check. Nothing is written",
    )  # fmt: skip
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Run what the command would, and print the ledger."""
    design = Design(load_scene(arguments.scene))
    GOALS[arguments.command](design)
    runs = design.ledger.runs
    alone = left_alone(design)
    tell_main_disc(design, "times and quantities")
    if arguments.json:
        document: dict[str, Any] = {**identity(design.scene), "command": arguments.command}
        document["computed"] = [run_record(design, each) for each in runs]
        document["left_alone"] = list(alone)
        print_json(document)
        return FINE
    print(
        f"What `camgeo {arguments.command}` computes of {design.name}, each below what asked for it"
    )
    print("first. Times in ms: with all that it asked for, and its own.\n")
    print(f"{'all':>10}{'own':>10}")
    print("\n".join(tree_lines(design, runs)))
    total = sum(each.own_seconds for each in runs)
    print(f"\n{MILLI * total:10.3f}  in all, of {len(runs)} quantities")
    print("\nLeft alone: " + (", ".join(alone) or "nothing"))
    return FINE


def quantities() -> tuple[str, ...]:
    """Names of all that a design computes when it is asked for it, but effects."""
    return tuple(name for owner in OWNERS for name in lazy_names(owner))


def left_alone(design: Design) -> tuple[str, ...]:
    """Quantities of the design and effects there are that were not computed."""
    from camgeo.effects.graph import node_name
    from camgeo.effects.registry import effect_names

    ran = {each.name for each in design.ledger.runs}
    known = (*quantities(), *(node_name(name) for name in effect_names()))
    return tuple(name for name in known if name not in ran)


def reason(design: Design, each: Run) -> str:
    """Why it was computed."""
    prefix = "effects."
    name = each.name.removeprefix(prefix)
    if each.name.startswith(prefix):
        inputs = design.effects.inputs(name)
        named = "named by the scene" if name in design.scene.effects else "needed"
        return named + (f"; from {', '.join(inputs)}" if inputs else "")
    return ""


def run_record(design: Design, each: Run) -> dict[str, Any]:
    """A quantity that was computed, for JSON."""
    return {
        "name": each.name,
        "asked_by": each.asked_by or None,
        "why": reason(design, each) or None,
        "seconds": each.seconds,
        "own_seconds": each.own_seconds,
        "failed": each.failed,
    }


def tree_lines(design: Design, runs: list[Run]) -> list[str]:
    """One line a quantity, below the one that asked for it first."""
    below: dict[str, list[Run]] = {}
    for each in runs:
        below.setdefault(each.asked_by, []).append(each)
    shown: set[str] = set()

    def lines(asker: str, depth: int) -> list[str]:
        found = []
        for each in below.get(asker, []):
            note = reason(design, each)
            if each.failed:
                note = "; ".join(part for part in (note, "has no answer") if part)
            name = INDENT * depth + each.name
            found.append(
                f"{MILLI * each.seconds:10.3f}{MILLI * each.own_seconds:10.3f}  {name}"
                + (f"  ({note})" if note else "")
            )
            if each.name not in shown:
                shown.add(each.name)
                found += lines(each.name, depth + 1)
        return found

    return lines("", 0)
