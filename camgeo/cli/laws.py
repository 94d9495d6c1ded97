"""`camgeo laws`: the motion laws with their characteristic values."""

from __future__ import annotations

import argparse
import math

from camgeo.cli.command import FINE, Subparsers, new_parser, print_json
from camgeo.motion.inflection import shift
from camgeo.motion.laws import ALIASES, LAWS
from camgeo.motion.laws.law import Characteristic, Law

TASKS = ("R-R",)

HEAD = ("law", "C_v", "C_a", "C_a*", "C_j", "C_Mdyn", "C_Mdyn*")


def register(subparsers: Subparsers[argparse.ArgumentParser]) -> None:
    """Add the command."""
    parser = new_parser(
        subparsers,
        "laws",
        "list the motion laws with their characteristic values (VDI 2143)",
        "camgeo laws --task R-R --inflection 0.4",
    )
    parser.add_argument("--task", choices=TASKS, default="R-R", help="motion task; default R-R")
    parser.add_argument(
        "--inflection", metavar="LAMBDA", type=float, default=0.5, help="inflection point, 0 to 1"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the table of laws."""
    laws = [shift(law, arguments.inflection) for law in LAWS.values()]
    if arguments.json:
        print_json([_record(law) for law in laws])
        return FINE
    print(f"{HEAD[0]:24}" + "".join(f"{name:>12}" for name in HEAD[1:]))
    for law in laws:
        print(f"{law.name:24}" + "".join(_number(value) for value in _values(law.characteristic)))
    for alias, name in ALIASES.items():
        print(f"{alias:24}  is {name}")
    return FINE


def _values(values: Characteristic) -> tuple[float, ...]:
    return (
        values.velocity,
        values.acceleration,
        values.deceleration,
        values.jerk,
        values.moment,
        values.braking_moment,
    )


def _number(value: float) -> str:
    return f"{'infinite':>12}" if math.isinf(value) else f"{value:12.5f}"


def _record(law: Law) -> dict[str, object]:
    values = (None if math.isinf(value) else value for value in _values(law.characteristic))
    return {
        "law": law.name,
        "task": "R-R",
        "inflection": law.inflection,
        **dict(zip(HEAD[1:], values, strict=True)),
    }
