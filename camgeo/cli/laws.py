"""`camgeo laws`: the motion laws of a motion task side by side."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, Final

from camgeo.answers.answer import FINE
from camgeo.cli.command import (
    CallError,
    add_json,
    print_json,
)
from camgeo.cli.law_options import (
    DEFAULT_TASK,
    EVERY_TASK,
    add_law_options,
    given_options,
    parameters_from,
)
from camgeo.cli.plot import add_picture, write_picture
from camgeo.motion.laws import ALIASES, FAMILIES, OPTIONS, find_family
from camgeo.motion.laws.comparison import QUANTITIES, Entry, Running, compare
from camgeo.motion.task import NAMES, TASKS, End, ends_of
from camgeo.units import RPM

HEAD: Final = ("C_v", "C_a", "C_a*", "C_j", "C_j*", "C_Mdyn", "C_Mdyn*")

PHYSICAL_HEAD: Final = ("v", "a", "a*", "j", "j*", "M/m", "M/m*")

UNITS: Final = ("mm/s", "mm/s^2", "mm/s^2", "mm/s^3", "mm/s^3", "N m/kg", "N m/kg")

SYMBOLS: Final = {
    "inflection": "lambda",
    **{name: option.symbol for name, option in OPTIONS.items()},
}
"""How the table calls parameters that the guideline has a letter for."""

RUNNING: Final = {
    "speed": ("RPM", "speed of the cam in rev/min"),
    "span": ("DEG", "cam angle of the move in degrees"),
    "stroke": ("MM", "stroke in mm"),
}

CELL: Final = 12


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
        group.add_argument(f"--{name}", metavar=metavar, type=float, help=text)
    parser.add_argument("--places", action="store_true", help="print z of the extremes too")
    add_json(parser)
    add_picture(parser, "draw a picture")


def run(arguments: argparse.Namespace) -> int:
    """Print the comparison, or write its picture."""
    names = [find_family(name).name for name in arguments.law or ()]
    running = _running(arguments)
    if arguments.task == EVERY_TASK:
        only_with_one = given_options(arguments)[1:]
        only_with_one += [f"--{name}" for name in RUNNING if running is not None]
        only_with_one += ["--places"] * arguments.places + ["-o"] * (arguments.output is not None)
        if only_with_one:
            raise CallError(f"{', '.join(only_with_one)}: allowed with one task only, not with all")
        _print_tasks(names, as_json=arguments.json)
        return FINE
    task = arguments.task or DEFAULT_TASK
    entries = compare(task, parameters_from(arguments), names)
    if arguments.output is not None:
        from camgeo.figure import laws

        count = sum(entry.law is not None for entry in entries)
        target, told = Path(arguments.output), f"{count} laws for {entries[0].task}"
        write_picture(laws.figure(entries), target, told, force=arguments.force)
    if arguments.json:
        print_json([_record(entry, running) for entry in entries])
    elif arguments.output is None:
        _print_table(entries, running, places=arguments.places)
    return FINE


def _running(arguments: argparse.Namespace) -> Running | None:
    """The move of the physical values; None if nothing of it is given."""
    missing = [f"--{name}" for name in RUNNING if getattr(arguments, name) is None]
    if len(missing) == len(RUNNING):
        return None
    if missing:
        raise CallError(f"physical values need {' and '.join(missing)} too")
    return Running(arguments.speed * RPM, math.radians(arguments.span), arguments.stroke)


# The table ----------------------------------------------------------------------------------------


def _print_table(entries: tuple[Entry, ...], running: Running | None, *, places: bool) -> None:
    width = max(len(entry.name) for entry in entries) + 2
    told = [_parameters(entry) for entry in entries]
    second = max(len("parameters"), *map(len, told)) + 2
    first_two = f"{'law':{width}}{'parameters':{second}}"
    print(first_two + "".join(f"{name:>{CELL}}" for name in HEAD) + "  remarks")
    for entry, parameters in zip(entries, told, strict=True):
        start = f"{entry.name:{width}}{parameters:{second}}"
        if entry.values is None:
            print(f"{entry.name:{width}}not possible: {entry.reason}")
            continue
        cells = "".join(_cell(entry.bounded(quantity)) for quantity in QUANTITIES)
        print(f"{start}{cells}  {_remarks(entry)}".rstrip())
        if places:
            cells = "".join(_place(entry, quantity) for quantity in QUANTITIES)
            print(f"{'':{width}}{'  at z':{second}}{cells}")
    if running is not None:
        _print_physical(entries, running, width)
    for note in _notes(entries):
        print(note)


def _print_physical(entries: tuple[Entry, ...], running: Running, width: int) -> None:
    print()
    print(
        f"{running.speed / RPM:g} rev/min, {math.degrees(running.span):g} degrees,"
        f" stroke {running.stroke:g} mm; M/m: torque against the inertia of 1 kg"
    )
    print(f"{'law':{width}}" + "".join(f"{name:>{CELL}}" for name in PHYSICAL_HEAD))
    print(f"{'':{width}}" + "".join(f"{f'[{unit}]':>{CELL}}" for unit in UNITS))
    for entry in entries:
        if entry.values is not None:
            values = (_physical(entry, quantity, running) for quantity in QUANTITIES)
            print(f"{entry.name:{width}}" + "".join(_rounded(value) for value in values))


def _physical(entry: Entry, quantity: str, running: Running) -> float | None:
    value = entry.bounded(quantity)
    return None if value is None else running.physical(quantity, value)


def _cell(value: float | None) -> str:
    return f"{'unbounded':>{CELL}}" if value is None else f"{value + 0.0:{CELL}.5f}"


def _rounded(value: float | None) -> str:
    return f"{'unbounded':>{CELL}}" if value is None else f"{value + 0.0:{CELL}.5g}"


def _place(entry: Entry, quantity: str) -> str:
    if entry.bounded(quantity) is None:
        return f"{'-':>{CELL}}"
    return f"{getattr(entry.values, quantity).place:{CELL}.5f}"


def _parameters(entry: Entry) -> str:
    given = entry.law.parameters if entry.law is not None else {}
    return " ".join(f"{SYMBOLS.get(key, key)}={value:.6g}" for key, value in given.items())


def _remarks(entry: Entry) -> str:
    """Shocks and jerks with their z, and whether the move runs back or overshoots."""
    found = []
    for word, places in (("shock", entry.shocks), ("jerk", entry.jerks)):
        if places:
            found.append(f"{word} at z = {', '.join(f'{place:.6g}' for place in places)}")
    if entry.runs_back:
        found.append("overshoots" if entry.overshoots else "runs back")
    return "; ".join(found)


def _notes(entries: tuple[Entry, ...]) -> list[str]:
    """What was left out of a row, or added to it, and the other names."""
    ignored: dict[tuple[str, ...], list[str]] = {}
    assumed: dict[tuple[str, ...], list[str]] = {}
    for entry in entries:
        if entry.law is not None:
            ignored.setdefault(entry.ignored, []).append(entry.name)
            assumed.setdefault(entry.assumed, []).append(entry.name)
    found = [
        f"ignored, not taken for {entries[0].task}: {', '.join(keys)} ({', '.join(names)})"
        for keys, names in ignored.items()
        if keys
    ]
    found += [
        f"not given, 0 taken: {', '.join(keys)} ({', '.join(names)})"
        for keys, names in assumed.items()
        if keys
    ]
    listed = {entry.name for entry in entries}
    found += [f"{alias} is {name}" for alias, name in ALIASES.items() if name in listed]
    return ["", *found] if found else []


# JSON ---------------------------------------------------------------------------------------------


def _record(entry: Entry, running: Running | None) -> dict[str, Any]:
    record: dict[str, Any] = {
        "law": entry.name,
        "task": entry.task,
        "inflection": None if entry.law is None else entry.law.parameters.get("inflection"),
        "parameters": {} if entry.law is None else dict(entry.law.parameters),
        "ignored": list(entry.ignored),
        "assumed_zero": list(entry.assumed),
        "reason": entry.reason or None,
        "shock": bool(entry.shocks),
        "jerk": bool(entry.jerks),
        "shock_places": list(entry.shocks),
        "jerk_places": list(entry.jerks),
        "runs_back": entry.runs_back,
        "overshoots": entry.overshoots,
        "values": None if entry.values is None else _values(entry),
    }
    if running is not None and entry.values is not None:
        record["physical"] = {
            quantity: _with_unit(_physical(entry, quantity, running), unit)
            for quantity, unit in zip(QUANTITIES, UNITS, strict=True)
        }
    return record


def _values(entry: Entry) -> dict[str, Any]:
    """Every characteristic value with its place; null for the ones that are unbounded."""
    assert entry.values is not None  # called for those only
    found: dict[str, Any] = {}
    for field in fields(entry.values):
        extreme = getattr(entry.values, field.name)
        within = extreme.value if field.name not in entry.unbounded else None
        found[field.name] = within if within is None else {"value": within, "z": extreme.place}
    return found


def _with_unit(value: float | None, unit: str) -> dict[str, Any] | None:
    return None if value is None else {"value": value, "unit": unit}


# All tasks ----------------------------------------------------------------------------------------


def _print_tasks(names: Sequence[str], *, as_json: bool) -> None:
    """The sixteen motion tasks (VDI 2143-1, Tafel 1) with the families made for each."""
    made = {
        task: {
            name: list(family.parameters[task])
            for name, family in FAMILIES.items()
            if task in family.tasks and (not names or name in names)
        }
        for task in TASKS
    }
    if as_json:
        print_json(
            [
                {
                    "task": task,
                    "start": NAMES[_ends(task)[0]],
                    "end": NAMES[_ends(task)[1]],
                    "laws": [{"law": name, "parameters": keys} for name, keys in laws.items()],
                }
                for task, laws in made.items()
            ]
        )
        return
    width = max(len(_words(task)) for task in TASKS) + 2
    for task, laws in made.items():
        print(f"{task:6}{_words(task):{width}}{', '.join(laws) or 'none of these'}")


def _words(task: str) -> str:
    start, end = _ends(task)
    return f"{NAMES[start]} to {NAMES[end]}"


def _ends(task: str) -> tuple[End, End]:
    found: dict[str, End] = {end: end for end in NAMES}
    start, end = ends_of(task)
    return found[start], found[end]
