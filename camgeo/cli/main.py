"""Entry point of the command line."""

from __future__ import annotations

import argparse
import atexit
import gc
import importlib
import os
import sys
from collections.abc import Sequence

from camgeo._version import __version__
from camgeo.answers import render
from camgeo.answers.answer import WRONG
from camgeo.cli.command import CallError, notify, present_name, show
from camgeo.cli.progress import Progress
from camgeo.errors import CamgeoError

INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells count it."""

COLLECTED_AT = 50_000
"""New objects after which the garbage collector runs. Python's own 700 makes it scan imported
modules hundreds of times, which are no garbage: a sixth of the time of a build."""

COMMANDS = (
    "new",
    "import",
    "check",
    "size",
    "build",
    "verify",
    "table",
    "plot",
    "replay",
    "laws",
    "slotted-lever",
    "accuracy",
    "explain",
    "stability",
)
"""In the order of the help; each is a module of `camgeo.cli`, with `-` for `_`.

It has a `SUMMARY` and an `EXAMPLE`, `options`, which adds to the command's parser, and `run`, which
takes the arguments and returns the exit code; `arguments.progress` shows the steps of long work.
"""

MODULES = {"import": "import_"}
"""Those whose name is a Python keyword."""


def parser(commands: Sequence[str] = COMMANDS) -> argparse.ArgumentParser:
    """The parser of `commands`; no module of another command is imported."""
    top = argparse.ArgumentParser(
        prog="camgeo",
        description="From a scene file to DXF, G-code, STL and 3MF of a cam, each proved to be"
        " within its tolerance.",
        epilog="example:\n  camgeo new oscillating-roller -o my-cam.toml\n"
        "  camgeo check my-cam.toml\n  camgeo build my-cam.toml -o out",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action="version", version=f"camgeo {__version__}")
    subparsers = top.add_subparsers(metavar="COMMAND", required=True)
    for command in commands:
        name = MODULES.get(command, command.replace("-", "_"))
        module = importlib.import_module(f"camgeo.cli.{name}")
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
    """Run one command; 0 fine, 1 a limit is broken, 2 the scene or the call is wrong."""
    if arguments is None:  # the process runs this command alone
        gc.set_threshold(COLLECTED_AT)
        atexit.register(gc.freeze)  # no last collection at the end of the process
    words = sys.argv[1:] if arguments is None else list(arguments)
    words[:1] = [present_name(word) for word in words[:1]]
    named = words[:1] if words and words[0] in COMMANDS else COMMANDS
    parsed = parser(named).parse_args(words)
    parsed.progress.begin()
    try:
        code: int = parsed.run(parsed)
        sys.stdout.flush()
        return code
    except CallError as error:
        parsed.parser.error(str(error))
        return WRONG  # never reached: `error` exits
    except CamgeoError as error:
        from camgeo.answers.refusal import refusal  # few commands are refused

        found = refusal(error)
        if getattr(parsed, "json", False):
            return show(found, parsed)
        notify(render.text(found))
        return found.exit_code
    except KeyboardInterrupt:
        notify("camgeo: interrupted; nothing half-written was left behind")
        return INTERRUPTED
    except BrokenPipeError:
        # The reader of the output has closed it; do not fail again while closing it here.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    finally:
        parsed.progress.end()
