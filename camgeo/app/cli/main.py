"""Entry point of the command line."""

from __future__ import annotations

import argparse
import atexit
import gc
import importlib
import os
import signal
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from types import FrameType
from typing import Final, NoReturn

from camgeo._version import __version__
from camgeo.app.answers.answer import CRASHED, STOPPED, WRONG
from camgeo.app.cli.progress import Progress
from camgeo.app.cli.streams import StreamError, discard_output, mend, notify, printable, write
from camgeo.errors import CamgeoError

# Slower imports are in functions, because a signal may arrive during them.

STOPPING: Final = ("SIGINT", "SIGTERM", "SIGHUP")
"""Signals after which a run undoes incomplete work, and ends."""

TRACEBACK: Final = "--traceback"
"""Option of every command, not only of those whose parser knows it: one may crash before."""

COLLECTED_AT = 500_000
"""New objects after which the garbage collector runs. Python's own 700 makes it scan imported
modules hundreds of times, which are no garbage: a sixth of the time of a build. A build makes
200,000, of which it needs nearly all to the end; commands that compute for longer take 12 MB more
than if it ran ten times as often."""

BLAS_THREADS: Final = "OPENBLAS_NUM_THREADS"
"""Variable that states how many threads the BLAS of numpy and that of scipy start, each on loading.
camgeo's matrices are too small to be shared among threads, which would only wait for work, and do
so by spinning."""

COMMANDS = (
    "new",
    "import",
    "check",
    "size",
    "build",
    "verify",
    "lint",
    "table",
    "plot",
    "watch",
    "design",
    "report",
    "setup",
    "replay",
    "probe",
    "inspect",
    "laws",
    "machines",
    "slotted-lever",
    "accuracy",
    "compare",
    "sweep",
    "optimise",
    "tolerance",
    "explain",
)
"""In the order of the help; each is a module of `camgeo.app.cli`, with `-` for `_`.

It has a `SUMMARY` and an `EXAMPLE`, `options`, which adds to the command's parser, and `run`, which
takes the arguments and returns the exit code; `arguments.progress` shows the steps of long work.
"""

MODULES = {"import": "import_"}
"""Those whose name is a Python keyword."""

GONE: Final = {"stability": "is measured by `python -m tests.stability`, in a checkout"}
"""What were commands, and what does it now."""


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
    """A parser whose messages do not direct the terminal, whatever the call contains."""

    def error(self, message: str) -> NoReturn:
        super().error(printable(message))


def parser(commands: Sequence[str] = COMMANDS) -> Parser:
    """The parser of `commands`; no module of another command is imported."""
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
    for command in commands:
        name = MODULES.get(command, command.replace("-", "_"))
        module = importlib.import_module(f"camgeo.app.cli.{name}")
        own = subparsers.add_parser(
            command,
            help=module.SUMMARY,
            description=f"{module.SUMMARY[0].upper()}{module.SUMMARY[1:]}.",
            epilog=f"example:\n  {module.EXAMPLE}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        module.options(own)
        own.set_defaults(run=module.run, parser=own, progress=Progress())
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command, by default that of this process; return the exit code.

    0 fine, 1 a limit is broken, 2 the scene or the call is wrong, CRASHED, or STOPPED and more.
    """
    words = sys.argv[1:] if arguments is None else list(arguments)
    try:
        if arguments is None:
            _own_the_process()
        return _run([word for word in words if word != TRACEBACK])
    except KeyboardInterrupt as stop:
        number = stop.number if isinstance(stop, Stopped) else signal.SIGINT
        notify(f"camgeo: interrupted by {signal.Signals(number).name}")
        return STOPPED + number
    except BrokenPipeError:  # the reader of the output has had enough
        discard_output()
        return 0
    except StreamError as error:
        discard_output()
        notify(f"camgeo: {error}")
        return WRONG
    except Exception as error:
        if TRACEBACK in words:
            traceback.print_exc()
        notify(f"camgeo: {_crash(error)}")
        return CRASHED
    finally:
        if arguments is None:
            for each in _stopping():
                if signal.getsignal(each) is _stop:
                    signal.signal(each, signal.SIG_DFL)  # there is nothing left to take back


def _run(words: list[str]) -> int:
    """Run the command of these words."""
    from camgeo.app.answers import answer
    from camgeo.app.answers.refusal import refusal
    from camgeo.app.cli.command import CallError, present_name, show

    words[:1] = [present_name(word) for word in words[:1]]
    if words and words[0] in GONE:
        notify(f"camgeo: {words[0]} {GONE[words[0]]}")
        return WRONG
    named = words[:1] if words and words[0] in COMMANDS else COMMANDS
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
        if (design := getattr(parsed, "opened", None)) is not None:
            design.scene.restate(error)
        found = refusal(error)
        if getattr(parsed, "json", False):
            return show(found, parsed)
        notify(answer.text(found))
        return found.exit_code
    finally:
        parsed.progress.end()


def _own_the_process() -> None:
    """Settings that hold for a process that runs this command alone."""
    os.environ.setdefault(BLAS_THREADS, "1")  # numpy is not imported yet
    gc.set_threshold(COLLECTED_AT)
    atexit.register(gc.freeze)  # no last collection at the end of the process
    mend()
    stop_on_signals()


def stop_on_signals() -> None:
    """Raise `Stopped` when a signal of STOPPING arrives, unless it is ignored, as with nohup."""
    for each in _stopping():
        if signal.getsignal(each) is not signal.SIG_IGN:
            signal.signal(each, _stop)


def _stopping() -> list[int]:
    """The numbers of STOPPING that the system has."""
    return [getattr(signal, name) for name in STOPPING if hasattr(signal, name)]


def _stop(number: int, _: FrameType | None) -> None:
    raise Stopped(number)


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
