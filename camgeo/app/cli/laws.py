"""`camgeo laws`: the motion laws of a motion task side by side."""

from __future__ import annotations

import argparse
import math
from typing import Final

from camgeo.app.answers.laws import laws_of_all_tasks, laws_of_task
from camgeo.app.cli.command import CallError, add_json, number, show, write_files
from camgeo.app.cli.plot import add_picture, pictures
from camgeo.kinematics.laws import OPTIONS
from camgeo.kinematics.laws.comparison import Running
from camgeo.kinematics.motion import TASKS
from camgeo.units import RPM, counted

RUNNING: Final = {
    "speed": ("RPM", "speed of the cam in rev/min"),
    "span": ("DEG", "cam angle of the move in degrees"),
    "stroke": ("MM", "stroke in mm"),
}

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


# -- law options ----------------------------------------------------------------------------------
# Options that name a motion law, its task and its parameters.


DEFAULT_TASK: Final = "R-R"

EVERY_TASK: Final = "all"

PARAMETERS: Final = {
    "inflection": ("LAMBDA", "z of the inflection point, counted as in VDI 2143"),
    "v0": ("F1", "f'(0)"),
    "a0": ("F2", "f''(0)"),
    "j0": ("F3", "f'''(0)"),
    "v1": ("F1", "f'(1)"),
    "a1": ("F2", "f''(1)"),
    "j1": ("F3", "f'''(1)"),
    **{name: (option.symbol.upper(), option.text) for name, option in OPTIONS.items()},
}
"""What `make_law` may take in addition to name and task: metavar and help of the option."""


def add_law_options(parser: argparse.ArgumentParser, *, several: bool = False) -> None:
    """Add `--law`, `--task` and an option for each parameter; absent ones are None.

    With `several`, `--law` takes any number of names, and `--task` may also be "all".
    """
    group = parser.add_argument_group(
        "motion law", "normalised: f(0) = 0, f(1) = 1; the law decides which parameters there are"
    )
    if several:
        group.add_argument("--law", metavar="NAME", nargs="+", help="only these laws")
    else:
        group.add_argument(
            "--law", metavar="NAME", help="name of the law, as `camgeo laws` lists it"
        )
    group.add_argument(
        "--task",
        choices=(*TASKS, EVERY_TASK) if several else TASKS,
        metavar="TASK",
        help=f"motion task, {TASKS[0]} to {TASKS[-1]}"
        + (f", or {EVERY_TASK}" if several else "")
        + f"; default {DEFAULT_TASK}",
    )
    for name, (metavar, text) in PARAMETERS.items():
        group.add_argument(f"--{name}", metavar=metavar, type=number, help=text)


def given_options(arguments: argparse.Namespace) -> list[str]:
    """The options given among the task and the parameters."""
    return [f"--{name}" for name in ("task", *PARAMETERS) if getattr(arguments, name) is not None]


def parameters_from(arguments: argparse.Namespace) -> dict[str, float]:
    """The parameters that are given, by the names that `make_law` takes."""
    parameters = {key: getattr(arguments, key) for key in PARAMETERS}
    return {key: value for key, value in parameters.items() if value is not None}
