"""How deep camgeo's own frames lie on the stack where a value arrives, for six walks through it.

Whoever follows a value through a debugger or a traceback reads these frames one by one. Each walk
starts at a command or a call that a user makes and ends in one function; its depth is that of the
deepest call of this function, which counts, so that no other way to it is hidden.

    python benchmarks/walks.py [--show] [WALK ...]

`--show` prints the frames. Exits with 1 if a walk is deeper than 20 frames.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Any, Final

import camgeo
from camgeo.app.cli.main import main as command
from camgeo.app.designing.children import Job
from camgeo.app.designing.work import prepared

ROOT: Final = Path(__file__).resolve().parents[1]
SETZHUB: Final = ROOT / "fixtures" / "scenes" / "setzhub.toml"
PRESS: Final = ROOT / "fixtures" / "effects" / "press.toml"

PRODUCT: Final = tuple(f"{ROOT / each}/" for each in ("camgeo", "export/camgeo_export"))

MOST: Final = 20
"""Frames that a reader may have to pass."""


@dataclass(frozen=True)
class Walk:
    """From a call to a function.

    Attributes
    ----------
    name : of the walk.
    start : the call.
    end : qualified name of the function in which the value arrives.
    """

    name: str
    start: Callable[[], object]
    end: str


def build(format_: str) -> None:
    """Build one file of the Setzhub cam."""
    with tempfile.TemporaryDirectory() as folder:
        command(["build", str(SETZHUB), "-o", folder, "--only", format_])


def edited(key: str, value: float) -> Callable[[], object]:
    """What the designer does with an edit during a drag."""
    run = prepared()
    asked = {"edits": {key: value}, "moving": True}
    job = Job("change", SETZHUB.read_text("utf-8"), SETZHUB.name, "", asked)
    return lambda: json.dumps(run(job))


def walks() -> tuple[Walk, ...]:
    """All of them; what a process does once, as the designer's, is done."""
    sweep = ["sweep", str(SETZHUB), "--vary", "follower.base_radius=40:41:3"]
    return (
        Walk(
            "scene text to pitch curve",
            lambda: camgeo.loads(SETZHUB.read_text("utf-8")).findings,
            "PitchCurve.in_cam",
        ),
        Walk("tolerance to fit", partial(build, "dxf"), "fit_arcs"),
        Walk("effect to JSON", partial(command, ["check", str(PRESS), "--json"]), "compute"),
        Walk("edit to painted curve", edited("motion[2].to", 31.0), "PitchCurve.in_cam"),
        Walk("milling move to line", partial(build, "gcode"), "Iso.line"),
        Walk("milling move to arc", partial(build, "gcode"), "Iso.arc"),
        Walk(
            "sweep row to curve",
            partial(command, [*sweep, "--ask", "transmission-angle"]),
            "PitchCurve.in_cam",
        ),
    )


def frames_of(frame: FrameType | None) -> Iterator[str]:
    """The product's functions on the stack, the innermost first."""
    while frame is not None:
        file = frame.f_code.co_filename
        if file.startswith(PRODUCT):
            place = Path(file).relative_to(ROOT)
            yield f"{place}:{frame.f_lineno} {frame.f_code.co_qualname}"
        frame = frame.f_back


def deepest(walk: Walk) -> list[str]:
    """The frames at the deepest call of the function that ends the walk, the outermost first."""
    found: list[str] = []

    def called(frame: FrameType, event: str, _: Any) -> None:
        nonlocal found
        code = frame.f_code
        if event != "call" or code.co_qualname != walk.end:
            return
        if code.co_filename.startswith(PRODUCT):
            found = max(found, [*frames_of(frame)], key=len)

    quiet = io.StringIO()
    with contextlib.redirect_stdout(quiet), contextlib.redirect_stderr(quiet):
        sys.setprofile(called)
        try:
            walk.start()
        finally:
            sys.setprofile(None)
    return found[::-1]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", metavar="WALK", help="beginnings of names; else all")
    parser.add_argument("--show", action="store_true", help="print the frames")
    options = parser.parse_args()
    beyond = 0
    for walk in walks():
        if options.names and not walk.name.startswith(tuple(options.names)):
            continue
        frames = deepest(walk)
        beyond += len(frames) > MOST or not frames
        print(f"{walk.name:<28}{len(frames):3d}  of at most {MOST}", flush=True)
        if options.show:
            print(*(f"    {each}" for each in frames), sep="\n")
    sys.exit(bool(beyond))


if __name__ == "__main__":
    main()
