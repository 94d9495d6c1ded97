"""Programs of others, found by name on the path or by a variable, and run apart from ours."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import tempfile
from pathlib import Path

from tests.waiting import PATIENCE


class Refusal(AssertionError):
    """What a program of others says against a file."""


def found(variable: str, *names: str) -> str:
    """The program that `variable` names, or else the first of `names` on the path; empty if none.

    A variable that names something else finds nothing: it is not passed over.
    """
    named = os.environ.get(variable, "")
    if named:
        return shutil.which(named) or ""
    return next((path for name in names if (path := shutil.which(name))), "")


def absent(variable: str, *names: str) -> str:
    """Why there is no such program; empty if there is one."""
    if found(variable, *names):
        return ""
    named = os.environ.get(variable, "")
    return f"{named} is not there" if named else f"neither {variable} nor {names[0]} is there"


def run(call: list[str], folder: Path, **more: str) -> str:
    """What a program prints that is run in `folder`, with a home of its own and without a screen.

    Refusal if it fails, or does not end.
    """
    with tempfile.TemporaryDirectory() as home:
        places = dict.fromkeys(("HOME", "XDG_RUNTIME_DIR", "XDG_CONFIG_HOME", "FREECAD_USER_HOME"))
        environment = {
            "PATH": os.environ["PATH"],
            "LC_ALL": "C.UTF-8",
            "QT_QPA_PLATFORM": "offscreen",
            **dict.fromkeys(places, home),
            **more,
        }
        child = subprocess.Popen(
            call, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, start_new_session=True,
        )  # fmt: skip
        try:
            said = child.communicate(timeout=PATIENCE)[0].decode(errors="replace")
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            child.communicate()
            raise Refusal(f"{Path(call[0]).name} does not end") from None
    if child.returncode:
        raise Refusal(f"{Path(call[0]).name} ends with {child.returncode}: {said[-300:].strip()}")
    return said
