"""Processes that write sets, stopped by signals at random moments.

    python -m tests.kill --count 1000 --seed 1

Each is a small set written by a forked process; of five, one is `camgeo build`, followed by `camgeo
verify`. Exits with 1, and says which case it was, if a folder then holds anything but a whole set.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from camgeo.app.answers.answer import STOPPED
from camgeo.design import writing
from camgeo.design.writing import STAGING, settle, write_set
from tests.kill.stops import (
    BUILD,
    MEMORY,
    SCENE,
    SIGNALS,
    Fault,
    Files,
    everything,
    forked,
    is_safe,
    is_whole,
    put,
    require,
    stopped,
    stub_set,
    usual_signals,
)
from tests.seeds import add_seed, moment
from tests.waiting import PATIENCE, until

NAMES: Final = tuple(f"{letter}.dxf" for letter in "abcdef")

SIZE: Final = 100_000
"""Bytes of each small file."""

WRITING: Final = 0.01
"""Time [s] of writing a set of them, or a little more; that a signal comes later is no fault."""

EVERY: Final = 5
"""Of so many cases, one is a build."""


def stop_a_set(folder: Path, number: int, source: random.Random) -> None:
    """A small set, into a fresh or a full folder."""
    old = source.choice(({}, stub_set(1, NAMES[:4], SIZE)))
    written = stub_set(2, NAMES[2:], SIZE)
    put(folder, old)
    child = forked(lambda: write_set(folder, written, force=True))
    moment(source, WRITING)
    os.kill(child, number)
    stopped(child, number)
    require(is_safe(folder, old, old | written), folder)
    if number != signal.SIGKILL:
        require(is_whole(folder, old, old | written), folder)
    if source.random() < 0.5:
        settle(folder)
        require(is_whole(folder, old, old | written), folder)
    else:
        further = stub_set(3, NAMES[:3], SIZE)
        found = [old | further, old | written | further]
        write_set(folder, further, force=True)
        require(is_whole(folder, *found), folder)


def two_at_once(folder: Path, number: int, source: random.Random) -> None:
    """Two processes write different sets into one folder, and one of them is stopped."""
    sets = [stub_set(seed, NAMES, SIZE) for seed in (1, 2)]

    def write(files: Files) -> Callable[[], object]:
        return lambda: [write_set(folder, files, force=True) for _ in range(3)]

    put(folder, sets[0])
    children = [forked(write(files)) for files in sets]
    moment(source, 6.0 * WRITING)
    os.kill(children[0], number)
    for child in children:
        stopped(child, number)
    settle(folder)
    require(is_whole(folder, *sets), folder)


def camgeo(*words: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "camgeo", *words], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL,
        text=True,
    )  # fmt: skip


def stop_a_build(folder: Path, number: int, source: random.Random) -> None:
    """A build in place of an earlier one, stopped anywhere or while it writes; then verified."""
    (folder / "notes.txt").write_bytes(b"mine")
    if camgeo(*BUILD, str(folder), "--tolerance", "0.01").wait() != 0:
        raise Fault("the first build fails")
    old = everything(folder)
    build = camgeo(*BUILD, str(folder), "--tolerance", "0.02")
    if late := source.random() < 0.7:
        until(STAGING, lambda: build.poll() is not None or (folder / STAGING).exists())
    moment(source, WRITING if late else 1.0)
    build.send_signal(number)
    _, said = build.communicate()
    # Before camgeo has begun, Python ends as it will.
    allowed = (0, -number, 1 if "Traceback" in said and not late else 0, STOPPED + number)
    if build.returncode not in allowed:
        raise Fault(f"exit code {build.returncode}: {said}")
    left = (folder / STAGING).exists()
    if left and number != signal.SIGKILL and build.returncode != -number:
        raise Fault(f"{STAGING} is left")
    verification = camgeo("verify", str(folder), "--scene", str(SCENE))
    _, said = verification.communicate()
    if verification.returncode != 0 or ("interrupted" in said) != left:
        raise Fault(f"verify ends with {verification.returncode}: {said}")
    found = everything(folder)  # of which each file is the one that the certificate names
    require(found.keys() == old.keys() | {"verification.json"}, folder)


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.kill")
    parser.add_argument("--count", type=int, default=20)
    add_seed(parser)
    wanted = parser.parse_args(words)
    usual_signals()
    writing.PATIENCE = PATIENCE  # type: ignore[misc]  # the machine may be busy
    print(f"{wanted.count} cases, --seed {wanted.seed}", flush=True)  # noqa: T201 - a program
    for case in range(wanted.count):
        source = random.Random(f"{wanted.seed} {case}")
        number = SIGNALS[case % len(SIGNALS)]
        act = stop_a_build if case % EVERY == 0 else source.choice((stop_a_set, two_at_once))
        memory = None if act is stop_a_build else MEMORY
        with tempfile.TemporaryDirectory(dir=memory) as place:
            try:
                act(Path(place), number, source)
            except Fault as fault:
                print(f"case {case}, {act.__name__}, {signal.Signals(number).name}: {fault}")  # noqa: T201 - a program
                return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
