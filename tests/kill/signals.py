"""Processes that are stopped by signals, and what they leave."""

from __future__ import annotations

import os
import signal
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Final

from camgeo.app.answers.answer import STOPPED
from camgeo.app.cli.main import Stopped, stop_on_signals
from tests.kill.sets import everything

SIGNALS: Final = (signal.SIGKILL, signal.SIGTERM, signal.SIGHUP, signal.SIGINT)

SCENE: Final = Path(__file__).parents[2] / "fixtures" / "scenes" / "vorschub.toml"

BUILD: Final = ("build", str(SCENE), "--force", "--only", "csv,dxf", "-o")


class Fault(Exception):
    """A folder holds what it must not hold, or a process ended as it must not."""


def forked(work: Callable[[], object]) -> int:
    """Start a process that does `work`, and wait until it begins; return its number."""
    reading, writing = os.pipe()
    if (child := os.fork()) != 0:
        os.close(writing)
        os.read(reading, 1)
        os.close(reading)
        return child
    code = 1
    try:
        stop_on_signals()
        os.write(writing, b".")
        work()
        code = 0
    except Stopped as stop:
        code = STOPPED + stop.number
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 1
    except Exception:  # the parent sees the exit code alone
        traceback.print_exc()
    finally:
        os._exit(code)


def stopped(child: int, number: int) -> bool:
    """Wait for the end of a process: whether signal `number` ended it, before its work was done.

    Raises
    ------
    Fault
        If it has ended for another reason.
    """
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if code not in (0, -number if number == signal.SIGKILL else STOPPED + number):
        raise Fault(f"exit code {code}")
    return code != 0


def require(held: bool, folder: Path) -> None:
    if not held:
        raise Fault(f"the folder holds {sorted(everything(folder))}")


def usual_signals() -> None:
    """Let none be ignored: started in the background of a shell, all processes here would."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
