"""Programs of others, found by name on the path or by a variable, and run apart from ours."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from tests.waiting import PATIENCE


class Refusal(AssertionError):
    """What a program of others says against a file."""


class Program:
    """A program of others, found by a variable, or else by name on the path.

    A variable that names something else finds nothing: it is not passed over.

    Attributes
    ----------
    variable : of the environment.
    names : on the path, of which the first that is there is taken.
    what : the variable should name; for programs that are on no path.
    """

    def __init__(self, variable: str, *names: str, what: str = "") -> None:
        self.variable, self.names, self.what = variable, names, what

    @property
    def path(self) -> str:
        """Where it is; empty if it is not there."""
        named = os.environ.get(self.variable, "")
        names = (named,) if named else self.names
        return next((path for name in names if (path := shutil.which(name))), "")

    def absent(self) -> str:
        """Why it is not there; empty if it is."""
        if self.path:
            return ""
        if named := os.environ.get(self.variable, ""):
            return f"{named} is not there"
        if self.what:
            return f"{self.variable} names no {self.what}"
        return f"neither {self.variable} nor {self.names[0]} is there"

    def run(self, words: list[str], folder: Path, **more: str) -> str:
        """What it prints, see `run`."""
        return run([self.path, *words], folder, **more)


def answer(said: str, file: Path) -> dict[str, Any]:
    """What a script has printed of a file behind "camgeo: "; Refusal if it has not, or an error."""
    lines = re.findall(r"^camgeo: (.*)$", said, re.MULTILINE)
    if not lines:
        raise Refusal(f"{file.name} is not read: {said[-300:].strip()}")
    told: dict[str, Any] = json.loads(lines[-1])
    if "error" in told:
        raise Refusal(f"{file.name}: {told['error']}")
    return told


def run(call: list[str], folder: Path, **more: str) -> str:
    """What a program prints that is run in `folder`, with a home of its own and without a screen.

    Refusal if it fails, or does not end.
    """
    with tempfile.TemporaryDirectory() as home:
        places = ("HOME", "XDG_RUNTIME_DIR", "XDG_CONFIG_HOME", "FREECAD_USER_HOME")
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
