"""Entry point of the command line."""

from __future__ import annotations

import argparse
import atexit
import gc
import importlib
import io
import os
import signal
import sys
import traceback
from collections.abc import Collection, Sequence
from contextlib import suppress
from pathlib import Path
from types import FrameType
from typing import Final, NoReturn

from camgeo._version import __version__
from camgeo.app.answers.answer import CRASHED, STOPPED, WRONG, text
from camgeo.app.cli.command import (
    Argument,
    ArgumentGroup,
    CallError,
    Progress,
    StreamError,
    notify,
    present_name,
    printable,
    show,
    write,
)
from camgeo.errors import CamgeoError

# Slower imports are in functions, because a signal may arrive during them.

STOPPING: Final = ("SIGINT", "SIGTERM", "SIGHUP")
"""Signals after which a run undoes incomplete work and ends."""

TRACEBACK: Final = "--traceback"
"""Option of every call; it is removed before parsing, because that may crash as well."""

COLLECTION_THRESHOLD = 500_000
"""New objects after which the garbage collector runs. Python's own 700 makes it scan imported
modules hundreds of times, which are no garbage: a sixth of the time of a build. A build makes
200,000, of which it needs nearly all to the end; commands that compute for longer take 12 MB more
than if it ran ten times as often."""

BLAS_THREADS: Final = "OPENBLAS_NUM_THREADS"
"""Variable that states how many threads the BLAS of numpy and that of scipy start, each on loading.
camgeo's matrices are too small to be shared among threads, which would only wait for work, and do
so by spinning."""

AS_JSON: Final = Argument("--json", action="store_true", help="print JSON")
"""Requests JSON in place of text; every command with an answer has it."""

COMMANDS: Final = {
    "new": "write a commented scene to start from",
    "import": "turn a project of opticurv 1.0.3 (.ocv) into a scene",
    "check": (
        "check a scene against its limits; exits with 0 if all are kept, 1 if one is broken, 2"
        " if the scene is invalid"
    ),
    "size": (
        "find the smallest base circle, with its offset or pivot and arm side, that keeps the"
        " limits, and Flocke's proposal"
    ),
    "build": "write the files of a scene, with certificate.json",
    "verify": (
        "read DXF, G-code, STL, 3MF and STEP files back and measure them against the exact curves"
    ),
    "lint": "run milling programs as a controller would, and show what is wrong with them",
    "table": (
        "print the value table as CSV: motion, curves, transmission angle, curvature; or that"
        " of a motion law"
    ),
    "plot": (
        "draw a scene: motion, cam, mechanism, curvature, transmission-angle, effects,"
        " shock-spectrum, backplot"
    ),
    "watch": "check and draw a scene anew whenever its file, or one that it names, changes",
    "design": (
        "design a cam live in the browser: drag handles, and curve, mechanism, diagrams and"
        " findings follow; save and build"
    ),
    "report": (
        "all that is known of a design: with -o as one HTML page that needs nothing else, with"
        " the turning mechanism, diagrams, findings and their next steps, table, price list,"
        " certificate"
    ),
    "setup": (
        "the setup sheet of a milling program: blank, zero, holding, tools, operations with"
        " their times, simulation; with -o as an HTML page with a backplot"
    ),
    "replay": (
        "press the follower against the real outline, or a contour from a file, over a turn:"
        " lift, velocity, acceleration, shocks, compared with the motion demanded"
    ),
    "probe": (
        "list points of the flanks for a measuring machine, with true normals, ball centres and"
        " tolerance, and the lift curve"
    ),
    "inspect": (
        "compare measured points with the exact flank: deviations over the cam angle, shift and"
        " turn with their uncertainty, what the follower does"
    ),
    "laws": "compare the motion laws for a motion task by their characteristic values (VDI 2143)",
    "machines": "list the machine profiles, show one with all its keys, or check one of your own",
    "slotted-lever": (
        "compute the extremes and the time ratio of a slotted lever, its value table and its"
        " diagram"
    ),
    "accuracy": (
        "measure what accuracy costs: pieces, bytes, computing and machining time over the"
        " tolerance, and where more of it stops paying off"
    ),
    "compare": "put a few designs side by side: what differs, findings, curves",
    "sweep": "compute quantities of a whole family of designs, and keep them in a file",
    "optimise": "search for the best design within limits, and write its scene",
    "tolerance": (
        "analyse the tolerances of a scene: the follower's error over the cam angle, by source"
    ),
    "explain": (
        "show what a command computes for a scene, why, how long it takes, and what it leaves out"
    ),
}
"""What each command does, in the order of the help; each is a module of `camgeo.app.answers`, or of
`camgeo.app.cli` if it has no answer, with `-` for `_`.

It has an `EXAMPLE`, `ARGUMENTS`, those of the command's parser, to which one with an answer adds
`--json`, and `run`, which takes the arguments and returns the exit code; `arguments.progress` shows
the steps of long work.
"""

WITHOUT_ANSWER: Final = {"new", "import", "plot", "watch", "design"}

MODULES = {"import": "import_"}
"""Modules of commands whose name is a Python keyword."""

GONE: Final = {"stability": "is measured by `python -m tests.stability`, in a checkout"}
"""Former commands, with what replaces them."""


class Stopped(KeyboardInterrupt):
    """A signal asks the process to stop.

    Attributes
    ----------
    number : of the signal.
    """

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


class Parser(argparse.ArgumentParser):
    """A parser that escapes control characters of the call in its messages."""

    def error(self, message: str) -> NoReturn:
        super().error(printable(message))


Arguments = tuple[Argument | ArgumentGroup, ...]
"""Arguments of a command, in the order of its help."""


def add_arguments(parser: argparse._ActionsContainer, arguments: Arguments) -> None:
    """Add arguments and groups to a parser."""
    for argument in arguments:
        if isinstance(argument, Argument):
            parser.add_argument(*argument.names, **argument.stated)
        elif argument.title:
            add_arguments(
                parser.add_argument_group(argument.title, argument.text), argument.arguments
            )
        else:
            only_one = parser.add_mutually_exclusive_group(required=argument.required)
            add_arguments(only_one, argument.arguments)


def parser(commands: Collection[str] = COMMANDS) -> Parser:
    """The parser of all commands, with the options of `commands`; no module of another one is
    imported.
    """
    top = Parser(
        prog="camgeo",
        description="From a scene file to DXF, G-code, STL, 3MF and STEP of a cam, each proved to"
        " be within its tolerance.",
        epilog="example:\n  camgeo new oscillating-roller -o my-cam.toml\n"
        "  camgeo check my-cam.toml\n  camgeo build my-cam.toml -o out\n\n"
        "exit codes:\n"
        "  0 fine, 1 a limit is broken, 2 the scene or the call is wrong or a file cannot be\n"
        f"  written, {CRASHED} an error in camgeo itself, {STOPPED} and its number after a signal",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action="version", version=f"camgeo {__version__}")
    top.add_argument(
        TRACEBACK, action="store_true", help="print where in camgeo an internal error happened"
    )
    subparsers = top.add_subparsers(metavar="COMMAND", required=True)
    for command, summary in COMMANDS.items():
        command_parser = subparsers.add_parser(
            command,
            help=summary,
            description=f"{summary[0].upper()}{summary[1:]}.",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        if command in commands:
            name = MODULES.get(command, command.replace("-", "_"))
            room = "cli" if command in WITHOUT_ANSWER else "answers"
            module = importlib.import_module(f"camgeo.app.{room}.{name}")
            add_arguments(command_parser, module.ARGUMENTS)
            if room == "answers":
                add_arguments(command_parser, (AS_JSON,))
            command_parser.epilog = f"example:\n  {module.EXAMPLE}"
            command_parser.set_defaults(run=module.run, parser=command_parser, progress=Progress())
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command, by default that of this process; return the exit code.

    0 fine, 1 a limit is broken, 2 the scene or the call is wrong, CRASHED, or STOPPED and more.
    """
    words = sys.argv[1:] if arguments is None else list(arguments)
    try:
        if arguments is None:
            _configure_process()
        return _run([word for word in words if word != TRACEBACK])
    except KeyboardInterrupt as stop:
        number = stop.number if isinstance(stop, Stopped) else signal.SIGINT
        notify(f"camgeo: interrupted by {signal.Signals(number).name}")
        return STOPPED + number
    except BrokenPipeError:  # the reader of the output has had enough
        _discard_output()
        return 0
    except StreamError as error:
        _discard_output()
        notify(f"camgeo: {error}")
        return WRONG
    except Exception as error:
        if TRACEBACK in words:
            traceback.print_exc()
        notify(f"camgeo: {_crash(error)}")
        return CRASHED
    finally:
        if arguments is None:
            for number in _stopping():
                if signal.getsignal(number) is _stop:
                    signal.signal(number, signal.SIG_DFL)  # there is nothing left to take back


def _run(words: list[str]) -> int:
    """Run the command of these words."""
    words[:1] = [present_name(word) for word in words[:1]]
    if words and words[0] in GONE:
        notify(f"camgeo: {words[0]} {GONE[words[0]]}")
        return WRONG
    named = [word for word in words if not word.startswith("-")][:1]
    try:
        parsed = parser(named).parse_args(words)
    except SystemExit:
        write("")  # help may not have been taken yet
        raise
    parsed.progress.begin()
    try:
        code: int = parsed.run(parsed)
        return code
    except CallError as error:
        parsed.parser.error(str(error))
        return WRONG  # never reached: `error` exits
    except CamgeoError as error:
        from camgeo.app.answers.refusal import refusal

        if (design := getattr(parsed, "opened", None)) is not None:
            design.scene.restate(error)
        answer = refusal(error)
        if getattr(parsed, "json", False):
            return show(answer, parsed)
        notify(text(answer))
        return answer.exit_code
    finally:
        parsed.progress.end()


def _configure_process() -> None:
    """Settings for a process that runs only this command."""
    os.environ.setdefault(BLAS_THREADS, "1")  # numpy is not imported yet
    gc.set_threshold(COLLECTION_THRESHOLD)
    atexit.register(gc.freeze)  # no last collection at the end of the process
    _mend_streams()
    stop_on_signals()


def _mend_streams() -> None:
    """Replace closed streams: no file opened later may take their place.

    Writing to a closed standard output fails, as to a full one; messages are lost.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDONLY if number == 1 else os.O_RDWR)
    sys.stdout = sys.stdout or open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115 - no path
    sys.stderr = sys.stderr or open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115 - no path
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def stop_on_signals() -> None:
    """Raise `Stopped` when a signal of STOPPING arrives, unless it is ignored, as with nohup."""
    for number in _stopping():
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _stop)


def _stopping() -> list[int]:
    """The numbers of the signals in STOPPING that the system has."""
    return [getattr(signal, name) for name in STOPPING if hasattr(signal, name)]


def _stop(number: int, _: FrameType | None) -> None:
    raise Stopped(number)


def _discard_output() -> None:
    """Drop what standard output has not taken, so that the end of the process does not fail."""
    with suppress(OSError):  # under test it is no file
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _crash(error: Exception) -> str:
    """One line on an error that camgeo did not foresee."""
    steps = traceback.extract_tb(error.__traceback__)
    package = Path(__file__).parents[2]
    ours = [step for step in steps if package in Path(step.filename).parents] or steps
    place = f"{Path(ours[-1].filename).name}, line {ours[-1].lineno}"
    what = " ".join(f"{type(error).__name__}: {error}".split())
    return (
        f"internal error ({what}; {place}): please report it to the authors of camgeo, with the"
        f" scene and with what the same call prints with {TRACEBACK}"
    )
