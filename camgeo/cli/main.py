"""Entry point of the command line."""

from __future__ import annotations

import argparse
import importlib
import os
import sys
from collections.abc import Sequence

from camgeo._version import __version__
from camgeo.cli.command import BROKEN, WRONG, tell
from camgeo.cli.earlier import present_name
from camgeo.errors import CamgeoError, GeometryError, UndercutError

INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells count it."""

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
"""In the order of the help; each a module of `camgeo.cli`, with `-` for `_`."""

MODULES = {"import": "import_"}
"""Those whose name is a word of Python."""


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
        module = MODULES.get(command, command.replace("-", "_"))
        importlib.import_module(f"camgeo.cli.{module}").register(subparsers)
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; 0 fine, 1 a limit is broken, 2 the scene or the call is wrong."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    words[:1] = [present_name(word) for word in words[:1]]
    named = words[:1] if words and words[0] in COMMANDS else COMMANDS
    parsed = parser(named).parse_args(words)
    try:
        code: int = parsed.run(parsed)
        sys.stdout.flush()
        return code
    except UndercutError as error:
        tell(f"camgeo: {error.message}; nothing was written")
        return BROKEN
    except GeometryError as error:
        given = f" = {error.value}" if error.value else ""
        place = f"{error.key}{given}: " if error.key else ""
        tell(f"camgeo: {place}{error.message}")
        return WRONG
    except CamgeoError as error:
        tell(f"camgeo: {error}")
        return WRONG
    except KeyboardInterrupt:
        tell("camgeo: interrupted; nothing half-written was left behind")
        return INTERRUPTED
    except BrokenPipeError:
        # Whoever read our output has had enough; do not fail again while closing it.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
