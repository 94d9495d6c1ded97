"""Options that name a motion law, its task and its parameters."""

from __future__ import annotations

import argparse
from typing import Final

from camgeo.cli.command import number
from camgeo.motion.boundary import TASKS
from camgeo.motion.laws import OPTIONS

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
