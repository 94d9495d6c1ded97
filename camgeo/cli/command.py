"""What all commands share: options and their checks, the scene, text and JSON output."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from decimal import Decimal, InvalidOperation
from pathlib import Path

from camgeo.answers import render
from camgeo.answers.answer import FINE, Answer
from camgeo.cli.progress import clear
from camgeo.design import Design
from camgeo.lazy import Ledger

Written = tuple[Path, bytes, str]
"""A file to write: where, what, and what is told of it."""


class CallError(Exception):
    """The call is wrong, in a way that none of its options shows by itself."""


def opened(arguments: argparse.Namespace) -> Design:
    """The design of the scene file that the command is called with; SceneError as `load_scene`.

    The quantities that it computes are shown as they start.
    """
    from camgeo.scene.load import load_scene  # some commands need no scene

    return Design(load_scene(arguments.scene), Ledger(arguments.progress))


def add_scene(parser: argparse.ArgumentParser) -> None:
    """The argument that names the scene, see `opened`."""
    parser.add_argument("scene", metavar="SCENE", help="scene file (TOML)")


def add_json(parser: argparse.ArgumentParser) -> None:
    """The option that asks for JSON in place of text."""
    parser.add_argument("--json", action="store_true", help="print JSON")


def add_output(
    parser: argparse.ArgumentParser, text: str, suffixes: Sequence[str] | None = None
) -> None:
    """The options that name a file to write, which `text` describes, and let it be overwritten.

    Its name ends in one of `suffixes`, if there are any.
    """

    def named(name: str) -> str:
        if suffixes is not None and Path(name).suffix not in suffixes:
            message = f"{name!r} must end in one of {', '.join(suffixes)}"
            raise argparse.ArgumentTypeError(message)
        return name

    parser.add_argument("-o", metavar="FILE", dest="output", type=named, help=text)
    parser.add_argument("--force", action="store_true", help="write over an existing file")


def deliver(text: str, arguments: argparse.Namespace, told: str) -> int:
    """Print the text, or write it into the file of `-o`, and tell it with what is `told`."""
    if arguments.output is None:
        arguments.progress.end()
        sys.stdout.write(text)
    else:
        write_told([(Path(arguments.output), text.encode(), told)], force=arguments.force)
    return FINE


def tables(answer: Answer, name: str | None) -> list[Written]:
    """The table of an answer as a CSV file of that name; none if there is no name."""
    if name is None:
        return []
    table = render.table(answer)
    return [(Path(name), table.csv().encode(), f"{len(table.values)} rows")]


def write_told(files: Sequence[Written], *, force: bool) -> None:
    """Write files of one folder, all or none, and tell each with what is said of it."""
    if not files:
        return
    from camgeo.writing.transaction import write_set  # most commands write nothing

    write_set(files[0][0].parent, {path.name: data for path, data, _ in files}, force=force)
    for path, _, text in files:
        tell(f"{path}: {text}")


def require_beside(option: str, name: str | None, output: str | None) -> None:
    """Refuse files of `option` and of `-o` that are the same, or not in one folder.

    Files are written as a set, whole or not at all, and a set lies in one folder.
    """
    if name is None or output is None:
        return
    if Path(name) == Path(output):
        raise CallError(f"{option} and -o name the same file")
    if Path(name).parent != Path(output).parent:
        raise CallError(f"{option} and -o must name files in the same folder")


def decimal(text: str) -> Decimal:
    """The number in the text of an option."""
    try:
        number = Decimal(text)
    except InvalidOperation:
        number = Decimal("NaN")
    if not number.is_finite():
        raise argparse.ArgumentTypeError(f"{text!r} is not a number")
    return number


def check_step(step: Decimal | None, smallest: Decimal, largest: Decimal) -> None:
    """Refuse a step of the cam angle [degrees] that is not from `smallest` to `largest`."""
    if step is not None and not smallest <= step <= largest:
        message = f"{step} degrees; from {smallest} to {largest} are allowed"
        raise CallError(f"argument --step: {message}")


def show(answer: Answer, arguments: argparse.Namespace) -> int:
    """Print the answer, as text or with `--json` as JSON; the exit code."""
    arguments.progress.end()
    if arguments.json:
        print(json.dumps(render.to_json(answer), indent=2, allow_nan=False))
    elif told := render.text(answer):
        print(told)
    return answer.exit_code


def tell(message: str) -> None:
    """A line for the person at the terminal, on standard error."""
    clear()
    print(message, file=sys.stderr)


def tell_main_disc(design: Design, what: str) -> None:
    """Say of a conjugate pair that `what`, in the plural, is of the main disc alone."""
    if design.scene.returning is not None:
        tell(f"{what} of the main disc; the return disc, {design.name}-return, is not covered")
