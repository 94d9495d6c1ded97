"""`camgeo watch`: checks and draws a scene again whenever it, or a file that it reads, changes."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Final

from camgeo.app.answers.answer import FINE
from camgeo.app.answers.check import Check, check
from camgeo.app.cli.command import (
    IMAGES,
    SCENE_FILE,
    Argument,
    CallError,
    Progress,
    draw_figure,
    non_negative,
    number_type,
    opened,
    output_options,
    say,
    until_ctrl_c,
)
from camgeo.errors import CamgeoError, SceneError
from camgeo.reading import SCENE
from camgeo.scene.scene import read_file
from camgeo.scene.values import Stamp, named_files, stamp
from camgeo.units import counted, listed

EVERY: Final = 0.5
"""Seconds between two looks at the files, by default."""

QUICKEST: Final = 0.05
"""Shortest time between two looks [s]: more often, they would keep the processor busy."""

BAD: Final = ("invalid", "no-disc", "broken")
"""Severities of bad findings, the worst first."""

NAMED: Final = 3
"""Most bad findings that are named in a line."""

EXAMPLE: Final = "camgeo watch fixtures/scenes/setzhub.toml cam -o setzhub.png"


def _count(text: str) -> int:
    value = non_negative(text)
    if value != int(value):
        raise argparse.ArgumentTypeError("must be a whole number from 0 on")
    return int(value)


ARGUMENTS: Final = (
    SCENE_FILE,
    Argument("what", metavar="WHAT", nargs="*", help="what to draw; default: everything"),
    *output_options(f"picture, {', '.join(IMAGES)}; default SCENE.png", IMAGES),
    Argument(
        "--every",
        metavar="SECONDS",
        type=number_type(QUICKEST, 3600.0, f"a number from {QUICKEST:g} to 3600"),
        default=EVERY,
        help=f"time between two looks at the files; default {EVERY:g}",
    ),
    Argument(
        "--runs", metavar="N", type=_count, default=0, help="end after N runs; default: at Ctrl-C"
    ),
)


def run(arguments: argparse.Namespace) -> int:
    """Print a line for each run, until Ctrl-C."""
    from camgeo.pictures.plots import check_names

    check_names(arguments.what)
    target = Path(arguments.output or f"{Path(arguments.scene).stem}.png")
    if target.exists() and not arguments.force:
        raise CallError(f"{target} exists; --force lets each run overwrite it")
    arguments.progress.end()  # each run has its own: time passes between them

    def once() -> None:
        arguments.progress = Progress()
        arguments.progress.begin()
        start = time.monotonic()
        try:
            line = _run(arguments, target)
        finally:
            arguments.progress.end()
        seconds = time.monotonic() - start
        say(f"{time.strftime('%H:%M:%S')}  {line} ({seconds:.1f} s)")

    with until_ctrl_c():
        files = SceneFiles(arguments.scene)
        watch(files.stamps, once, lambda: time.sleep(arguments.every), arguments.runs)
    return FINE


def _run(arguments: argparse.Namespace, target: Path) -> str:
    """Check and draw once; the outcome in a line."""
    try:
        design = opened(arguments)
        outcome = f"{design.name}: {_verdict(check(design))}"
    except CamgeoError as error:
        return f"{arguments.scene}: {_fault(error)}"
    try:
        from camgeo.design.writing import settle, write_set
        from camgeo.pictures.plots import of_design

        picture = draw_figure(of_design(design, arguments.what)[0], target.suffix)
        settle(target.parent, arguments.progress)
        write_set(target.parent, {target.name: picture}, force=True, progress=arguments.progress)
    except CamgeoError as error:
        design.scene.restate(error)
        return f"{outcome}; no picture: {_fault(error)}"
    return f"{outcome}; {target}"


def _verdict(checked: Check) -> str:
    """The names of bad findings, or that all limits are kept; then the number of warnings."""
    several = checked.everything
    warnings = [finding for finding in several if finding.severity == "warning"]
    warned = f", {counted(len(warnings), 'warning')}" if warnings else ""
    bad = [finding for severity in BAD for finding in several if finding.severity == severity]
    if not bad:
        return f"all limits kept{warned}"
    names = list(dict.fromkeys(finding.name for finding in bad))
    return f"{counted(len(bad), 'bad finding')}: {listed(names, NAMED)}{warned}"


def _fault(error: CamgeoError) -> str:
    """The error in a line: the first fault of a scene, and how many more it has."""
    if isinstance(error, SceneError) and error.faults:
        more = len(error.faults) - 1
        text = f"{error.faults[0]}" + (f" (and {counted(more, 'more fault')})" if more else "")
    else:
        text = str(error)
    return " ".join(text.split())


# -- watching -------------------------------------------------------------------------------------
# The files of a scene, looked at again and again to see whether they have changed.


Stamps = dict[Path, Stamp]


class SceneFiles:
    """The scene file and the files in its folder that its texts name.

    The repair of a scene that is broken for a moment, or of a missing file, must be noticed. So any
    text in the scene counts as a name, and while the scene cannot be read its last names count.
    """

    def __init__(self, scene: str) -> None:
        self.scene = Path(scene)
        self._read: Stamp = None
        self._named: tuple[Path, ...] = ()

    def stamps(self) -> Stamps:
        """The present state of all files."""
        scene_stamp = stamp(self.scene)
        if scene_stamp != self._read:
            self._read = scene_stamp
            with suppress(SceneError, ValueError):  # read again when it changes again
                text = read_file(self.scene, SCENE.size).decode()
                paths = named_files(text, self.scene.resolve().parent)
                self._named = self._named if paths is None else paths
        return {self.scene: scene_stamp} | {path: stamp(path) for path in self._named}


def watch(
    files: Callable[[], Stamps], act: Callable[[], None], wait: Callable[[], None], runs: int = 0
) -> None:
    """Call `act` at once, and again after each change of `files`; `wait` passes between two looks.

    A change counts once two looks agree, so that no file is read while it is being written. Changes
    while `act` runs are noticed afterwards. The loop ends after `runs` calls, never if that is 0.
    """
    count = 0
    while True:
        seen = files()
        act()
        count += 1
        if count == runs:
            return
        while (now := files()) == seen:
            wait()
        # A file may still be being written: wait until two looks agree.
        while now != (now := _wait_and_look(wait, files)):
            pass


def _wait_and_look(wait: Callable[[], None], files: Callable[[], Stamps]) -> Stamps:
    wait()
    return files()
