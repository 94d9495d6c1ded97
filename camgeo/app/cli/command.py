"""Common parts of all commands: arguments and their checks, the scene, files and output."""

from __future__ import annotations

import argparse
import json
import math
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from camgeo.app.answers import answer as render
from camgeo.app.answers.answer import FINE, Answer
from camgeo.errors import OutputError
from camgeo.lazy import Ledger
from camgeo.units import counted

if TYPE_CHECKING:
    from camgeo.design.design import Design
    from camgeo.design.value_table import Table
    from camgeo.pictures.model import Figure
    from camgeo.studies.sweep.rows import Engine


EARLIER: Final = {
    "crank-slide": "slotted-lever",
    "crank-slides": "slotted-levers",
    "crank-slider": "slider-driven-crank",
}
"""Present names of commands, kinds and groups, by those of earlier versions, which are still read.
"""

CSV: Final = ".csv"
JSON: Final = ".json"
IMAGES: Final = (".png", ".svg", ".pdf")
"""Suffixes of tables, documents and pictures."""

SMALLEST: Final = 1e-9
LARGEST: Final = 1e6
"""Limits of positive lengths [mm] in options."""

Written = tuple[Path, bytes, str]
"""A file to write: its path, its bytes, and the report on it."""


class CallError(Exception):
    """The call is wrong, though each of its options is valid by itself."""


def opened(arguments: argparse.Namespace) -> Design:
    """The design of the scene file in the call; SceneError as `load_scene`.

    It is stored in `arguments.opened`, because an error states lengths in its unit.
    """
    arguments.opened = load_design(arguments.scene, arguments)
    design: Design = arguments.opened
    return design


def load_design(file: str, arguments: argparse.Namespace) -> Design:
    """The design of a scene file; the progress line names each quantity that is computed."""
    from camgeo.design.design import Design  # some commands need no scene
    from camgeo.scene.scene import load_scene

    return Design(load_scene(file), Ledger(arguments.progress))


class Argument:
    """An argument of a command, stated as for `argparse.ArgumentParser.add_argument`."""

    def __init__(self, *names: str, **stated: Any) -> None:
        self.names, self.stated = names, stated


class ArgumentGroup:
    """Arguments under a heading of their own; without a title, mutually exclusive arguments.

    With `required`, a call must have one of the exclusive arguments.
    """

    def __init__(
        self, *arguments: Argument, title: str = "", text: str | None = None, required: bool = False
    ) -> None:
        self.arguments, self.title, self.text, self.required = arguments, title, text, required


SCENE_FILE: Final = Argument("scene", metavar="SCENE", help="scene file (TOML)")
"""The argument that names the scene, see `opened`."""

FORCE: Final = Argument("--force", action="store_true", help="overwrite existing files")

WORKERS: Final = Argument(
    "--workers",
    metavar="COUNT",
    type=int,
    default=1,
    help="processes of this machine that compute; default 1, 0 for one on each core",
)
"""The option from which `engine_for` makes an engine."""


def origin_option(files: str) -> Argument:
    """The option for the place of the cam axis in the coordinates of the files `files`."""
    text = f"where the cam axis lies in {files} [mm]; default 0 0"
    return Argument(
        "--origin", metavar=("X", "Y"), type=number, nargs=2, default=(0.0, 0.0), help=text
    )


def output_options(text: str, suffixes: Sequence[str] | None = None) -> tuple[Argument, Argument]:
    """The options that name a file to write, described by `text`, and allow overwriting it.

    Its name must end in one of `suffixes`, unless that is None.
    """
    named = str if suffixes is None else suffix_type(suffixes)
    return Argument("-o", metavar="FILE", dest="output", type=named, help=text), FORCE


def repeated_option(
    option: str,
    metavar: str,
    text: str,
    read: Callable[[str], Any] = str,
    dest: str | None = None,
) -> Argument:
    """An option that may be given several times, described by `text`: a list, empty if not."""
    return Argument(
        option, metavar=metavar, dest=dest, action="append", type=read, default=[], help=text
    )


def objective_options(text: str) -> tuple[Argument, ...]:
    """`--least` and `--largest`; `text` describes both, with {} for "small" or "large"."""
    options = {"--least": "small", "--largest": "large"}
    return tuple(
        repeated_option(option, "NAMES", text.format(what)) for option, what in options.items()
    )


def engine_for(workers: int) -> Engine:
    """The engine of `--workers`: this process, or as many others."""
    from camgeo.studies.sweep.rows import engine_of  # few commands compute families

    count = workers or os.cpu_count() or 1
    return engine_of("loop" if count == 1 else "pool", count)


def suffix_type(suffixes: Sequence[str]) -> Callable[[str], str]:
    """The type of an option that names a file; the name must end in one of `suffixes`."""

    def named(name: str) -> str:
        if Path(name).suffix not in suffixes:
            message = f"{name!r} must end in one of {', '.join(suffixes)}"
            raise argparse.ArgumentTypeError(message)
        return name

    return named


def deliver(text: str, arguments: argparse.Namespace, report: str) -> int:
    """Print the text, or write it into the file of `-o` with a `report` of what was written."""
    if arguments.output is None:
        arguments.progress.end()
        write(text)
    else:
        write_files([(Path(arguments.output), text.encode(), report)], arguments)
    return FINE


def table_file(table: Table, path: Path) -> Written:
    """The table as a CSV file."""
    return path, table.encoded(), counted(len(table.values), "row")


def write_files(files: Sequence[Written], arguments: argparse.Namespace) -> None:
    """Write files into one folder, all or none, and report each."""
    if not files:
        return
    from camgeo.design.writing import write_set  # most commands write nothing

    data = {path.name: data for path, data, _ in files}
    folder = files[0][0].parent
    settle(folder, arguments)
    write_set(folder, data, force=arguments.force, progress=arguments.progress)
    for path, _, report in files:
        notify(f"{path}: {report}")


def require_new(paths: Iterable[Path], arguments: argparse.Namespace) -> None:
    """Raise OutputError if files exist and must not be overwritten.

    It is called before long computations, so that none is done for files that cannot be written.
    """
    there = [str(path) for path in paths if os.path.lexists(path)]
    if there and not arguments.force:
        message = "allow that with --force, or name other files; nothing was computed"
        raise OutputError(f"{', '.join(there)} would be overwritten; {message}")


def settle(folder: Path, arguments: argparse.Namespace) -> None:
    """Restore the state of a folder before a run that was interrupted there, and report it."""
    from camgeo.design import writing  # most commands write nothing

    if report := writing.settle(folder, arguments.progress):
        notify(f"{folder}: {report}")


def require_same_folder(option: str, name: str | None, output: str | None) -> None:
    """Raise CallError unless `option` and `-o` name different files in the same folder.

    Files are written as a set, all or none, and a set lies in one folder.
    """
    if name is None or output is None:
        return
    if Path(name) == Path(output):
        raise CallError(f"{option} and -o name the same file")
    if Path(name).parent != Path(output).parent:
        raise CallError(f"{option} and -o must name files in the same folder")


def decimal(text: str) -> Decimal:
    """The number in the text of an option, exactly."""
    try:
        value = Decimal(text)
    except InvalidOperation:
        value = Decimal("NaN")
    if not value.is_finite():
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number")
    return value


def number(text: str) -> float:
    """The number in the text of an option."""
    value = float(decimal(text))
    if math.isinf(value):
        raise argparse.ArgumentTypeError(f"{text!r} is too large for a number")
    return value


def number_type(low: float, high: float, allowed: str) -> Callable[[str], float]:
    """The type of an option that is a number from `low` to `high`, in words `allowed`."""

    def read(text: str) -> float:
        value = number(text)
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"must be {allowed}")
        return value

    return read


non_negative: Final = number_type(0.0, math.inf, "a number, 0 or more")

positive: Final = number_type(SMALLEST, LARGEST, f"a number from {SMALLEST:g} to {LARGEST:g}")
"""The type of an option that is a positive length [mm]."""


def check_step(step: Decimal | None, smallest: Decimal, largest: Decimal) -> None:
    """Raise CallError for a step of the cam angle [degrees] outside `smallest` to `largest`."""
    if step is not None and not smallest <= step <= largest:
        message = f"{step} degrees; from {smallest} to {largest} are allowed"
        raise CallError(f"argument --step: {message}")


def show(
    answer: Answer,
    arguments: argparse.Namespace,
    files: Sequence[Written] = (),
    contents: str = "",
) -> int:
    """Write files by `write_files`, with `contents` those of `output_files` too, and print the
    answer as text, or as JSON with `--json`; return its exit code.
    """
    output = output_files(answer, arguments, contents) if contents else []
    write_files([*files, *output], arguments)
    arguments.progress.end()
    if arguments.json:
        write(document(answer))
    elif text := render.text(answer):
        say(text)
    return answer.exit_code


def document(answer: Answer) -> str:
    """The answer as a JSON document."""
    return json.dumps(render.to_json(answer), indent=2, allow_nan=False) + "\n"


def present_name(name: str) -> str:
    """The present name of a command or kind; an earlier name is reported on standard error."""
    present = EARLIER.get(name, name)
    if present != name:
        notify(f'camgeo: "{name}" is now called "{present}"')
    return present


def notify_main_disc(design: Design, what: str) -> None:
    """Report that `what`, a plural, covers only the main disc of a conjugate pair."""
    if design.scene.returning is not None:
        notify(f"{what} of the main disc; the return disc, {design.name}-return, is not covered")


# -- pictures -------------------------------------------------------------------------------------
# The drawing of pictures, and the files of answers.


RENDERERS = "camgeo.renderers"
"""Entry points of renderers: callables that turn a figure into a file, by its suffix."""

RENDERER = "matplotlib"


def draw_figure(figure: Figure, suffix: str) -> bytes:
    """The bytes of the figure as a file with that suffix, one of IMAGES."""
    from importlib.metadata import entry_points

    data: bytes = entry_points(group=RENDERERS)[RENDERER].load()(figure, suffix)
    return data


def output_files(answer: Answer, arguments: argparse.Namespace, contents: str) -> list[Written]:
    """The file of `-o`: by its suffix the table of an answer, its document or its picture, whose
    report names the `contents`; empty without `-o`.
    """
    if arguments.output is None:
        return []
    target = Path(arguments.output)
    if target.suffix == CSV:
        return [table_file(render.table(answer), target)]
    if target.suffix == JSON:
        return [(target, document(answer).encode(), "the answer")]
    return [(target, draw_figure(render.figure(answer), target.suffix), contents)]


TABLE_OR_PICTURE: Final = output_options(
    f"file to write: a table ({CSV}) or a picture ({', '.join(IMAGES)})", (CSV, *IMAGES)
)
"""The options of a command that writes the table or the picture of its answer."""


def picture_options(text: str = "also draw a picture") -> tuple[Argument, Argument]:
    """The options of a command that draws a picture, by default in addition to what it prints."""
    return output_options(f"{text}, {', '.join(IMAGES)}", IMAGES)


# -- streams --------------------------------------------------------------------------------------
# Standard output and standard error: the output of commands, made safe for a terminal, and the
# progress of long work.


LINES: Final = "\n\t"
"""Unprintable characters that a text may contain."""


class StreamError(Exception):
    """Standard output accepts nothing more, e.g. because the disk is full or it is closed."""


def write(text: str) -> None:
    """Write a document on standard output, as it is."""
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    # No error of camgeo: `main` ends quietly when the reader has had enough.
    except BrokenPipeError:
        raise
    except OSError as error:
        raise StreamError(f"standard output: {error.strerror or error}") from error


def say(text: str) -> None:
    """Print lines on standard output."""
    write(f"{printable(text)}\n")


@contextmanager
def until_ctrl_c() -> Iterator[None]:
    """A context that Ctrl-C ends without an error; other signals pass through."""
    try:
        yield
    except KeyboardInterrupt as stop:
        if getattr(stop, "number", signal.SIGINT) != signal.SIGINT:
            raise
        notify("")  # after the ^C that terminals show


def notify(message: str) -> None:
    """Print a line for the person at the terminal, on standard error."""
    with suppress(OSError):  # no one is listening, and there is nowhere else to report it
        clear()
        print(printable(message), file=sys.stderr, flush=True)


def printable(text: str) -> str:
    """The text with escapes for characters that would direct the terminal, as in file names."""
    return "".join(
        character
        if character.isprintable() or character in LINES
        else character.encode("unicode_escape").decode()
        for character in text
    )


# Progress of long work on a terminal is one line that is overwritten, and cleared at the end.


PATIENCE = 1.0
"""Seconds before the first line: shorter work needs no progress line."""

EVERY = 1.0
"""Seconds after which the line is written again, to show that a long step is still running."""

CLEARED = "\r\x1b[K"
"""Makes a terminal clear its line."""


class Progress:
    """Shows the current step, once the work has taken longer than a second; silent in a pipe."""

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._step = "working"
        self._lock, self._ended = threading.Lock(), threading.Event()

    def begin(self) -> None:
        """Show from now on how long the work takes, also between steps, until `end`."""
        if sys.stderr.isatty():
            threading.Thread(target=self._refresh, daemon=True).start()

    def __call__(self, step: str) -> None:
        self._step = step
        self._show()

    def end(self) -> None:
        """Clear the line for good: the output of the command follows."""
        with self._lock:
            self._ended.set()
            clear()

    def _refresh(self) -> None:
        while not self._ended.wait(EVERY):
            self._show()

    def _show(self) -> None:
        elapsed = time.monotonic() - self._start
        # The lock keeps this thread from writing a line after `end` has cleared it.
        with self._lock:
            if elapsed > PATIENCE and sys.stderr.isatty() and not self._ended.is_set():
                sys.stderr.write(f"{CLEARED}{elapsed:5.1f} s  {self._step}")
                sys.stderr.flush()


def clear() -> None:
    """Clear the progress line, if there is one, before something else is printed."""
    if sys.stderr.isatty():
        sys.stderr.write(CLEARED)
        sys.stderr.flush()
