"""Answer of `camgeo laws`: the motion laws of a task side by side, or those for each task."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Final, Literal

from camgeo.app.answers.answer import Answer, Key, Keys
from camgeo.app.cli.command import (
    Argument,
    ArgumentGroup,
    CallError,
    number,
    output_files,
    picture_options,
    show,
    write_files,
)
from camgeo.errors import Fault, SceneError
from camgeo.kinematics.laws import ALIASES, FAMILIES, OPTIONS, find_family
from camgeo.kinematics.laws.comparison import QUANTITIES, LawEntry, Running, compare, law_entry
from camgeo.kinematics.laws.law import Law
from camgeo.kinematics.motion import ENDS, NAMES, TASKS, task_ends
from camgeo.numeric.extremes import Extreme
from camgeo.pictures.model import Figure
from camgeo.units import RPM, counted

UNITS: Final = ("mm/s", "mm/s^2", "mm/s^2", "mm/s^3", "mm/s^3", "N m/kg", "N m/kg")
"""Units of the physical values, in the order of `QUANTITIES`."""


@dataclass(frozen=True, slots=True)
class Physical:
    """A physical value in `unit`, one of `UNITS`."""

    value: float
    unit: str


@dataclass(frozen=True, slots=True)
class LawRow:
    """One law of a comparison.

    Attributes
    ----------
    entry : the law with its characteristic values, or the reason why there is none.
    physical : `QUANTITIES` of the move, None for what is unbounded; None without a law or a move.
    """

    entry: LawEntry
    physical: Mapping[str, Physical | None] | None = None

    @property
    def parameters(self) -> Mapping[str, float]:
        """Parameters of the law, by name; empty if there is no law."""
        return {} if self.entry.law is None else self.entry.law.parameters

    @property
    def values(self) -> dict[str, Extreme | None] | None:
        """All characteristic values by name, None for what is unbounded; None without a law."""
        values, unbounded = self.entry.values, self.entry.unbounded
        if values is None:
            return None
        names = [field.name for field in fields(values)]
        return {name: None if name in unbounded else getattr(values, name) for name in names}


@dataclass(frozen=True, slots=True)
class TaskLaws:
    """A motion task (VDI 2143-1, Tafel 1) with the parameters of each family available for it."""

    task: str
    families: Mapping[str, tuple[str, ...]]

    @property
    def ends(self) -> tuple[str, ...]:
        """The classes of the motion at the start and at the end of the move, in words."""
        names: dict[str, str] = {end: NAMES[end] for end in ENDS}
        return tuple(names[end] for end in task_ends(self.task))


@dataclass(frozen=True, slots=True)
class Laws(Answer):
    """Motion laws.

    Attributes
    ----------
    rows : the laws of one task side by side; None if all tasks are listed.
    running : the move that gives them physical values; None if none was named.
    tasks : all tasks; None if laws of one are compared.
    places : whether the text shows z of the extremes too.
    """

    rows: tuple[LawRow, ...] | None = None
    running: Running | None = None
    tasks: tuple[TaskLaws, ...] | None = None
    places: bool = False

    @classmethod
    def from_law(cls, law: Law) -> Laws:
        """The answer for a single law."""
        return cls((LawRow(law_entry(law)),))

    @property
    def cells(self) -> list[list[str]]:
        """The laws with their parameters and characteristic values, below a heading."""
        table = [["law", "parameters", *HEAD]]
        for row in self.rows or ():
            entry = row.entry
            parameters = ", ".join(f"{name} {value:.6g}" for name, value in row.parameters.items())
            # A law that is not possible has the reason in place of its first value.
            values = [entry.reason, *[""] * (len(HEAD) - 1)]
            if entry.law is not None:
                values = [_spelled(entry.bounded(quantity), ".6g") for quantity in QUANTITIES]
            table.append([entry.name, parameters, *values])
        return table

    @property
    def physical_cells(self) -> list[list[str]]:
        """The physical values of the laws for the move, below a heading; empty without a move."""
        symbols = zip(PHYSICAL_HEAD, UNITS, strict=True)
        table = [["law", *(f"{name} [{unit}]" for name, unit in symbols)]]
        for row in self.rows or ():
            if row.physical is not None:
                values = (
                    None if physical is None else physical.value
                    for physical in row.physical.values()
                )
                table.append([row.entry.name, *(_spelled(value, ".5g") for value in values)])
        return table if len(table) > 1 else []


def laws_of_task(
    task: str,
    given: Mapping[str, float],
    names: Sequence[str] = (),
    *,
    running: Running | None = None,
    places: bool = False,
) -> Laws:
    """Compare the laws of a task.

    `task`, `given` and `names` are the arguments of `camgeo.kinematics.laws.comparison.compare`,
    the others attributes of `Laws`.

    Raises
    ------
    SceneError
        If none of the laws is possible, with the reason for each.
    """
    entries = compare(task, given, names)
    if all(entry.law is None for entry in entries):
        raise SceneError(_impossible(entries))
    rows = tuple(LawRow(entry, _physical(entry, running)) for entry in entries)
    return Laws(rows, running, places=places)


def _impossible(entries: Sequence[LawEntry]) -> list[Fault]:
    """Why no law is possible: one fault for all laws with the same reason."""
    reasons: dict[str, list[str]] = {}
    for entry in entries:
        reasons.setdefault(entry.reason, []).append(entry.name)
    return [
        Fault(", ".join(names), "", f"not possible: {reason}") for reason, names in reasons.items()
    ]


def laws_of_all_tasks(names: Sequence[str] = ()) -> Laws:
    """List the families available for each task, all of them or only those of `names`.

    GeometryError if a name is unknown.
    """
    wanted = {find_family(name).name for name in names}
    return Laws(
        tasks=tuple(
            TaskLaws(
                task,
                {
                    name: family.parameters[task]
                    for name, family in FAMILIES.items()
                    if task in family.tasks and (not wanted or name in wanted)
                },
            )
            for task in TASKS
        )
    )


def _physical(entry: LawEntry, running: Running | None) -> dict[str, Physical | None] | None:
    if running is None or entry.values is None:
        return None
    values: dict[str, Physical | None] = {}
    for quantity, unit in zip(QUANTITIES, UNITS, strict=True):
        value = entry.bounded(quantity)
        values[quantity] = (
            None if value is None else Physical(running.physical(quantity, value), unit)
        )
    return values


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


EXTREME: Final[Keys] = {
    "value": "The extreme value, with its sign.",
    "z": Key("Place of the value, from 0 to 1.", of="place"),
}

PHYSICAL: Final[Keys] = {
    "value": "The physical value, in `unit`.",
    "unit": Key(
        "Unit of the value; the moment is that against the inertia of 1 kg on the follower.",
        type=Literal["mm/s", "mm/s^2", "mm/s^3", "N m/kg"],
    ),
}

DOCUMENT: Final = Key(
    "The motion laws of one motion task side by side, or the laws available for each task.",
    {
        "running": Key(
            "The move that gives the laws physical values, if one was named.",
            {
                "speed_rad_per_s": "Speed of the cam.",
                "span_deg": "Cam angle of the move.",
                "stroke_mm": "Stroke of the follower.",
            },
            optional=True,
        ),
        "laws": Key(
            "The laws of one task, in the order in which they were named, or as they are listed.",
            {
                "law": Key("Name of the law.", of="entry.name"),
                "task": Key('The motion task, e.g. "R-U".', of="entry.task"),
                "parameters": (
                    "Parameters of the law, by name: the inflection point, boundary values,"
                    " options."
                ),
                "ignored": Key(
                    "Parameters that were stated but that the law does not take for the task.",
                    of="entry.ignored",
                ),
                "assumed_zero": Key(
                    "Boundary values that the law takes and that were not stated, so that they"
                    " are 0.",
                    of="entry.assumed",
                ),
                "reason": Key(
                    "Why there is no such law; empty if there is one.", of="entry.reason"
                ),
                "shock_places": Key("Places z, from 0 to 1, at which f' jumps.", of="entry.shocks"),
                "jerk_places": Key("Places z, from 0 to 1, at which f'' jumps.", of="entry.jerks"),
                "runs_back": Key("Whether f' is negative somewhere.", of="entry.runs_back"),
                "overshoots": Key("Whether f leaves the range from 0 to 1.", of="entry.overshoots"),
                "values": Key(
                    'Characteristic values (VDI 2143-1) by name, e.g. "velocity" for C_v,'
                    ' "deceleration" for C_a*; null without a law.',
                    Key(
                        "A characteristic value; null if a shock or jerk makes it unbounded.",
                        EXTREME,
                    ),
                ),
                "physical": Key(
                    "Velocity, acceleration, jerk and moment of the move by name; missing without"
                    " a move or a law.",
                    Key("A physical value; null if it is unbounded.", PHYSICAL),
                    optional=True,
                ),
            },
            of="rows",
            optional=True,
        ),
        "tasks": Key(
            "All motion tasks (VDI 2143-1, Tafel 1), if they were requested.",
            {
                "task": 'The motion task, e.g. "R-U".',
                "ends": Key(
                    "Class of the motion at the start and at the end of the move, in words.",
                    type=tuple[str, str],
                ),
                "laws": Key(
                    "The laws available for it, by name: the names of their parameters.",
                    of="families",
                ),
            },
            optional=True,
        ),
    },
    type=Laws,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo laws` as a table and as a picture.


HEAD: Final = ("C_v", "C_a", "C_a*", "C_j", "C_j*", "C_Mdyn", "C_Mdyn*")
"""Symbols of `QUANTITIES`, as in VDI 2143."""

PHYSICAL_HEAD: Final = ("v", "a", "a*", "j", "j*", "M/m", "M/m*")
"""Symbols of their physical values; M/m is the torque against the inertia of 1 kg."""

SYMBOLS: Final = {
    "inflection": "lambda",
    **{name: option.symbol for name, option in OPTIONS.items()},
}
"""Symbols in the table for parameters to which VDI 2143 gives a letter."""

CELL: Final = 12


def text(answer: Laws) -> str:
    """The comparison, one row per law, or the list of the tasks."""
    if answer.tasks is not None:
        return "\n".join(_tasks(answer.tasks))
    rows = answer.rows or ()
    width = max(len(row.entry.name) for row in rows) + 2
    lines = _compared(rows, width, places=answer.places)
    if answer.running is not None:
        lines += _physical_table(rows, answer.running, width)
    return "\n".join([*lines, *_notes([row.entry for row in rows])])


def figure(answer: Laws) -> Figure:
    """The curves of the laws of one task, one row per law."""
    from camgeo.pictures import laws

    return laws.figure([row.entry for row in answer.rows or ()])


def _tasks(tasks: Sequence[TaskLaws]) -> list[str]:
    ends = [" to ".join(task.ends) for task in tasks]
    width = max(map(len, ends)) + 2
    return [
        f"{task.task:6}{end:{width}}{', '.join(task.families) or 'none of these'}"
        for task, end in zip(tasks, ends, strict=True)
    ]


def _compared(rows: Sequence[LawRow], width: int, *, places: bool) -> list[str]:
    parameters = [_parameters(row) for row in rows]
    second = max(len("parameters"), *map(len, parameters)) + 2
    head = "".join(f"{name:>{CELL}}" for name in HEAD)
    lines = [f"{'law':{width}}{'parameters':{second}}{head}  remarks"]
    for row, row_parameters in zip(rows, parameters, strict=True):
        name, values = row.entry.name, row.values
        if values is None:
            lines.append(f"{name:{width}}not possible: {row.entry.reason}")
            continue
        extremes = [values[quantity] for quantity in QUANTITIES]
        cells = "".join(
            _cell(None if extreme is None else extreme.value, ".5f") for extreme in extremes
        )
        lines.append(
            f"{name:{width}}{row_parameters:{second}}{cells}  {_remarks(row.entry)}".rstrip()
        )
        if places:
            cells = "".join(
                _cell(None if extreme is None else extreme.place, ".5f", "-")
                for extreme in extremes
            )
            lines.append(f"{'':{width}}{'  at z':{second}}{cells}")
    return lines


def _physical_table(rows: Sequence[LawRow], running: Running, width: int) -> list[str]:
    move = (
        f"{running.speed / RPM:g} rev/min, {math.degrees(running.span):g} degrees,"
        f" stroke {running.stroke:g} mm; M/m: torque against the inertia of 1 kg"
    )
    head = f"{'law':{width}}" + "".join(f"{name:>{CELL}}" for name in PHYSICAL_HEAD)
    units = " " * width + "".join(f"{f'[{unit}]':>{CELL}}" for unit in UNITS)
    lines = ["", move, head, units]
    for row in rows:
        if row.physical is not None:
            cells = (
                _cell(None if value is None else value.value, ".5g")
                for value in row.physical.values()
            )
            lines.append(f"{row.entry.name:{width}}" + "".join(cells))
    return lines


def _cell(value: float | None, form: str, missing: str = "unbounded") -> str:
    return f"{_spelled(value, form, missing):>{CELL}}"


def _spelled(value: float | None, form: str, missing: str = "unbounded") -> str:
    # Adding 0.0 turns -0.0 into 0.0.
    return missing if value is None else format(value + 0.0, form)


def _parameters(row: LawRow) -> str:
    return " ".join(f"{SYMBOLS.get(key, key)}={value:.6g}" for key, value in row.parameters.items())


def _remarks(entry: LawEntry) -> str:
    """Places z of shocks and jerks, and whether the move runs back or overshoots."""
    remarks = []
    for word, places in (("shock", entry.shocks), ("jerk", entry.jerks)):
        if places:
            remarks.append(f"{word} at z = {', '.join(f'{place:.6g}' for place in places)}")
    if entry.runs_back:
        remarks.append("overshoots" if entry.overshoots else "runs back")
    return "; ".join(remarks)


def _notes(entries: Sequence[LawEntry]) -> list[str]:
    """The parameters ignored or assumed in each row, and alternative names of the laws."""
    ignored: dict[tuple[str, ...], list[str]] = {}
    assumed: dict[tuple[str, ...], list[str]] = {}
    for entry in entries:
        if entry.law is not None:
            ignored.setdefault(entry.ignored, []).append(entry.name)
            assumed.setdefault(entry.assumed, []).append(entry.name)
    kinds = (
        (f"ignored, not taken for {entries[0].task}", ignored),
        ("not stated, taken as 0", assumed),
    )
    notes = [
        f"{start}: {', '.join(keys)} ({', '.join(names)})"
        for start, groups in kinds
        for keys, names in groups.items()
        if keys
    ]
    listed = {entry.name for entry in entries}
    notes += [f"{alias} is {name}" for alias, name in ALIASES.items() if name in listed]
    return ["", *notes] if notes else []


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
"""Parameters of `make_law` besides name and task, with metavar and help of their options."""


def law_arguments(*, several: bool = False) -> ArgumentGroup:
    """`--law`, `--task` and an option for each parameter; absent ones are None.

    With `several`, `--law` takes any number of names, and `--task` may also be "all".
    """
    of_law = {"help": "name of the law, as `camgeo laws` lists it"}
    tasks, also = TASKS, ""
    if several:
        of_law = {"nargs": "+", "help": "only these laws"}
        tasks, also = (*TASKS, EVERY_TASK), f", or {EVERY_TASK}"
    text = f"motion task, {TASKS[0]} to {TASKS[-1]}{also}; default {DEFAULT_TASK}"
    return ArgumentGroup(
        Argument("--law", metavar="NAME", **of_law),
        Argument("--task", choices=tasks, metavar="TASK", help=text),
        *(
            Argument(f"--{name}", metavar=metavar, type=number, help=text)
            for name, (metavar, text) in PARAMETERS.items()
        ),
        title="motion law",
        text="normalised: f(0) = 0, f(1) = 1; the law decides which parameters there are",
    )


def stated_options(arguments: argparse.Namespace) -> list[str]:
    """The options of task and parameters that the call states, with their dashes."""
    return [f"--{name}" for name in ("task", *PARAMETERS) if getattr(arguments, name) is not None]


def law_parameters(arguments: argparse.Namespace) -> dict[str, float]:
    """The parameters that the call states, by the names that `make_law` takes."""
    parameters = {key: getattr(arguments, key) for key in PARAMETERS}
    return {key: value for key, value in parameters.items() if value is not None}


# -- command line ----------------------------------------------------------------------------------


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


ARGUMENTS: Final = (
    law_arguments(several=True),
    ArgumentGroup(
        *(
            Argument(f"--{name}", metavar=metavar, type=number, help=text)
            for name, (metavar, text) in RUNNING.items()
        ),
        title="physical values",
        text="with all three: velocity, acceleration, jerk, and torque at the camshaft against the"
        " inertia of 1 kg on the follower",
    ),
    Argument("--places", action="store_true", help="also print z of the extremes"),
    *picture_options("draw a picture"),
)


def run(arguments: argparse.Namespace) -> int:
    """Print the comparison, or write its picture."""
    names, running = arguments.law or (), _running(arguments)
    if arguments.task == EVERY_TASK:
        # Without the first one, which is --task itself.
        only_with_one = stated_options(arguments)[1:]
        only_with_one += [f"--{name}" for name in RUNNING if running is not None]
        only_with_one += ["--places"] * arguments.places + ["-o"] * (arguments.output is not None)
        if only_with_one:
            raise CallError(f"{', '.join(only_with_one)}: allowed with one task only, not with all")
        return show(laws_of_all_tasks(names), arguments)
    answer = laws_of_task(
        arguments.task or DEFAULT_TASK,
        law_parameters(arguments),
        names,
        running=running,
        places=arguments.places,
    )
    count = sum(row.entry.law is not None for row in answer.rows or ())
    contents = f"{counted(count, 'law')} for {arguments.task or DEFAULT_TASK}"
    files = output_files(answer, arguments, contents)
    write_files(files, arguments)
    return answer.exit_code if files and not arguments.json else show(answer, arguments)


def _running(arguments: argparse.Namespace) -> Running | None:
    """The move for the physical values; None if none of its options is given.

    CallError if some of them are missing.
    """
    missing = [f"--{name}" for name in RUNNING if getattr(arguments, name) is None]
    if len(missing) == len(RUNNING):
        return None
    if missing:
        raise CallError(f"physical values need {' and '.join(missing)} too")
    return Running(arguments.speed * RPM, math.radians(arguments.span), arguments.stroke)
