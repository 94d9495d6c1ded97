"""`camgeo laws`: the motion laws of a motion task side by side."""

from __future__ import annotations

import argparse
import math
from typing import Final

from camgeo.answers.laws import laws_of_all_tasks, laws_of_task
from camgeo.cli.command import CallError, add_json, number, show, write_files
from camgeo.cli.law_options import (
    DEFAULT_TASK,
    EVERY_TASK,
    add_law_options,
    given_options,
    parameters_from,
)
from camgeo.cli.plot import add_picture, pictures
from camgeo.motion.laws.comparison import Running
from camgeo.units import RPM
from camgeo.wording import counted

RUNNING: Final = {
    "speed": ("RPM", "speed of the cam in rev/min"),
    "span": ("DEG", "cam angle of the move in degrees"),
    "stroke": ("MM", "stroke in mm"),
}

SUMMARY: Final = (
    "compare the motion laws for a motion task by their characteristic values (VDI 2143)"
)

EXAMPLE: Final = (
    "camgeo laws --task R-U --inflection 0.4\n"
    "  camgeo laws --task all\n"
    "  camgeo laws --task U-U --curved 0.5 -o laws.svg\n"
    "  camgeo laws --law modified-sine polynomial-345 --speed 120 --span 60 --stroke 25"
)


def options(parser: argparse.ArgumentParser) -> None:
    """Add those of the command."""
    add_law_options(parser, several=True)
    group = parser.add_argument_group(
        "physical values",
        "with all three: velocity, acceleration, jerk, and torque at the camshaft against the"
        " inertia of 1 kg on the follower",
    )
    for name, (metavar, text) in RUNNING.items():
        group.add_argument(f"--{name}", metavar=metavar, type=number, help=text)
    parser.add_argument("--places", action="store_true", help="also print z of the extremes")
    add_json(parser)
    add_picture(parser, "draw a picture")


def run(arguments: argparse.Namespace) -> int:
    """Print the comparison, or write its picture."""
    names, running = arguments.law or (), _running(arguments)
    if arguments.task == EVERY_TASK:
        only_with_one = given_options(arguments)[1:]
        only_with_one += [f"--{name}" for name in RUNNING if running is not None]
        only_with_one += ["--places"] * arguments.places + ["-o"] * (arguments.output is not None)
        if only_with_one:
            raise CallError(f"{', '.join(only_with_one)}: allowed with one task only, not with all")
        return show(laws_of_all_tasks(names), arguments)
    found = laws_of_task(
        arguments.task or DEFAULT_TASK,
        parameters_from(arguments),
        names,
        running=running,
        places=arguments.places,
    )
    count = sum(row.entry.law is not None for row in found.rows or ())
    contents = f"{counted(count, 'law')} for {arguments.task or DEFAULT_TASK}"
    files = pictures(found, arguments, contents)
    write_files(files, arguments)
    return found.exit_code if files and not arguments.json else show(found, arguments)


def _running(arguments: argparse.Namespace) -> Running | None:
    """The move of the physical values; None if nothing of it is given."""
    missing = [f"--{name}" for name in RUNNING if getattr(arguments, name) is None]
    if len(missing) == len(RUNNING):
        return None
    if missing:
        raise CallError(f"physical values need {' and '.join(missing)} too")
    return Running(arguments.speed * RPM, math.radians(arguments.span), arguments.stroke)
