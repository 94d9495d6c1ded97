"""Processes that write sets, stopped by signals: at random moments, or at each step.

    python -m tests.kill --count 1000 --seed 1
    python -m tests.kill --everywhere

At random each case is a small set written by a forked process; of five, one is `camgeo build`,
followed by `camgeo verify`. Everywhere is the same in every run: processes send themselves a signal
at each step of writing a set. A step is what changes the disk, see `tests.kill.stops`. Small sets
are written by forked processes, alone and while another process waits for the folder; then `camgeo
build` is stopped while it puts its files in place, and `camgeo verify` judges what it leaves. That
prints how many were stopped, by what they did and by signal. Exits with 1, and says which case it
was, if a folder then holds anything but a whole set.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import random
import runpy
import shutil
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import redirect_stderr, redirect_stdout
from functools import partial
from pathlib import Path
from typing import Any, Final

from camgeo.app.answers.answer import STOPPED
from camgeo.app.cli.main import main as cli
from camgeo.design import writing
from camgeo.design.writing import STAGING, settle, write_set
from tests.kill.stops import (
    BEFORE,
    BUILD,
    FURTHER,
    MEMORY,
    SCENE,
    SIGNALS,
    WRITTEN,
    Fault,
    Files,
    Steps,
    everything,
    forked,
    is_safe,
    is_whole,
    put,
    require,
    stepping,
    stopped,
    stub_set,
    usual_signals,
)
from tests.long_form import LONG, examples
from tests.seeds import add_seed, moment
from tests.waiting import PATIENCE, until

# At each step -------------------------------------------------------------------------------------


BUILT: Final = SIGNALS if LONG else (signal.SIGKILL, signal.SIGTERM)
"""Signals that stop a build: all but the first are handled alike."""

BUILDS: Final = examples(1, long=10)
"""Builds that each of them stops, at one step each."""

Pipe = tuple[int, int]


class Signalled(Steps):
    """Steps of which one, half done, sends a signal to its own process."""

    def __init__(self, number: int, send: Callable[[], None]) -> None:
        super().__init__(number, RuntimeError("the signal should have ended the process"))
        self.send = send

    def wrapped(self, original: Callable[..., Any], half: Callable[..., Any]) -> Any:
        """As for `Steps`; what the handler of a signal raises comes from inside of the step."""

        def stopped(*arguments: Any, **options: Any) -> None:
            half(*arguments, **options)
            self.send()

        return super().wrapped(original, stopped)


def itself(number: int) -> Callable[[], None]:
    """What sends a signal to the process that calls it."""
    return lambda: os.kill(os.getpid(), number)


def write(folder: Path, files: Files = WRITTEN) -> None:
    write_set(folder, files, force=True)


def written(folder: Path, step: int, send: Callable[[], None]) -> int:
    """The steps of writing a set, of which one is half done and calls `send`."""
    with stepping(Signalled(step, send)) as steps:
        write(folder)
    return steps.done


def fresh(folder: Path) -> Path:
    """An empty folder."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    return folder


def is_turn_of(number: int, step: int, signals: Sequence[int]) -> bool:
    """Whether a step is stopped by this one of the `signals`; in the long form by each of them."""
    return LONG or signals[step % len(signals)] == number


def alone(folder: Path, number: int) -> Iterator[None]:
    """A small set, into a fresh or a full folder, killed at each step, or stopped at one of three.

    What catches one signal catches all, so that each step is stopped by one of them.
    """
    for old, step in ((each, step) for each in ({}, BEFORE) for step in steps_of(each)):
        if number != signal.SIGKILL and not is_turn_of(number, step, SIGNALS[1:]):
            continue
        put(fresh(folder), old)
        if not stopped(forked(partial(written, folder, step, itself(number))), number):
            raise Fault(f"a set is written in less than {step} steps")
        yield
        new = old | WRITTEN
        require(is_safe(folder, old, new), folder)
        if number != signal.SIGKILL:
            require(is_whole(folder, old, new), folder)
        if step % 2:
            settle(folder)
            require(is_whole(folder, old, new), folder)
        else:
            write(folder, FURTHER)
            require(is_whole(folder, old | FURTHER, new | FURTHER), folder)


def beside(folder: Path, number: int) -> Iterator[None]:
    """Stopped at a step, while another process waits for the folder and then writes its set."""
    for step in steps_of(BEFORE):
        if not is_turn_of(number, step, SIGNALS):
            continue
        put(fresh(folder), BEFORE)
        there, waits = os.pipe(), os.pipe()

        def send(there: Pipe = there, waits: Pipe = waits) -> None:
            os.write(there[1], b".")
            os.close(waits[1])
            if not os.read(waits[0], 1):
                raise Fault("the second process has ended, and did not wait")
            itself(number)()

        def follow(waits: Pipe = waits) -> None:
            def say(_: str) -> None:
                os.write(waits[1], b".")

            write_set(folder, FURTHER, force=True, progress=say)

        child = forked(partial(written, folder, step, send))
        os.close(there[1])
        os.read(there[0], 1)
        other = forked(follow)
        os.close(waits[1])
        if not stopped(child, number) or stopped(other, number):
            raise Fault("the first process comes to its end, or the second one does not")
        yield
        os.close(there[0])
        os.close(waits[0])
        require(is_whole(folder, BEFORE | FURTHER, BEFORE | WRITTEN | FURTHER), folder)


def builds(folder: Path, number: int) -> Iterator[None]:
    """`camgeo build` in place of an earlier one, at `BUILDS` of its steps; then verified."""
    every = Steps(0, RuntimeError())
    with stepping(every):
        old = built(folder)
    for k in range(BUILDS):
        at = Signalled((2 * k + 1) * every.done // (2 * BUILDS), itself(number))
        words = (*BUILD, str(folder), "--tolerance", f"0.0{k % 2 + 2}")
        if not stopped(forked(partial(camgeo, at, *words)), number):
            raise Fault("a build comes to its end")
        yield
        require_verified(folder, old, may_leave=number == signal.SIGKILL)


def built(folder: Path) -> Files:
    """What is in a folder after a build beside a file of somebody else."""
    (fresh(folder) / "notes.txt").write_bytes(b"mine")
    code, said = called(*BUILD, str(folder), "--tolerance", "0.01")
    if code != 0:
        raise Fault(f"the first build fails: {said}")
    return everything(folder)


def require_verified(folder: Path, old: Files, *, may_leave: bool) -> None:
    """What a stopped build leaves: nothing staged, unless it may, and a set that verifies."""
    left = (folder / STAGING).exists()
    if left and not may_leave:
        raise Fault(f"{STAGING} is left")
    code, said = called("verify", str(folder), "--scene", str(SCENE))
    if code != 0 or ("interrupted" in said) != left:
        raise Fault(f"verify ends with {code}: {said}")
    found = everything(folder)  # of which each file is the one that the certificate names
    require(found.keys() == old.keys() | {"verification.json"}, folder)


def called(*words: str) -> tuple[int, str]:
    """Exit code and messages of a call of camgeo in this process."""
    said = io.StringIO()
    with redirect_stderr(said), redirect_stdout(io.StringIO()):
        code = cli(words)
    return code, said.getvalue()


def camgeo(steps: Steps, *words: str) -> None:
    """What `python -m camgeo` does, in a process of its own."""
    with Path(os.devnull).open("w") as nothing:
        for stream in (1, 2):
            os.dup2(nothing.fileno(), stream)
    sys.argv = ["camgeo", *words]
    with stepping(steps):
        runpy.run_module("camgeo", run_name="__main__", alter_sys=True)


def steps_of(old: Files) -> range:
    """The numbers of the steps of writing the set into a folder with `old`."""
    with tempfile.TemporaryDirectory(dir=MEMORY) as place:
        put(folder := Path(place) / "out", old)
        return range(1, written(folder, 0, itself(signal.SIGKILL)) + 1)


# At random moments --------------------------------------------------------------------------------


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


def stop_a_build(folder: Path, number: int, source: random.Random) -> None:
    """A build in place of an earlier one, stopped anywhere or while it writes; then verified."""
    old = built(folder)
    words = [sys.executable, "-m", "camgeo", *BUILD, str(folder), "--tolerance", "0.02"]
    build = subprocess.Popen(words, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    if late := source.random() < 0.7:
        until(STAGING, lambda: build.poll() is not None or (folder / STAGING).exists())
    moment(source, WRITING if late else 1.0)
    build.send_signal(number)
    _, said = build.communicate()
    # Before camgeo has begun, Python ends as it will.
    allowed = (0, -number, 1 if "Traceback" in said and not late else 0, STOPPED + number)
    if build.returncode not in allowed:
        raise Fault(f"exit code {build.returncode}: {said}")
    require_verified(folder, old, may_leave=number == signal.SIGKILL or build.returncode == -number)


# The program --------------------------------------------------------------------------------------


def everywhere() -> int:
    """Stop processes at each step."""
    told: Counter[str] = Counter()
    for act in (alone, beside, builds):
        for number in SIGNALS if act is not builds else BUILT:
            name = f"{act.__name__}, {signal.Signals(number).name}"
            with tempfile.TemporaryDirectory(dir=MEMORY) as place:
                try:
                    for _ in act(Path(place) / "out", number):
                        told[name] += 1
                except Fault as fault:
                    print(f"{name}, number {told[name]}: {fault}")  # noqa: T201 - a program
                    return 1
    print(json.dumps(told))  # noqa: T201 - a program
    return 0


def at_random(seed: int, count: int) -> int:
    """Stop processes at moments that follow from a seed."""
    print(f"{count} cases, --seed {seed}", flush=True)  # noqa: T201 - a program
    for case in range(count):
        source = random.Random(f"{seed} {case}")
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


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.kill")
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--everywhere", action="store_true", help="at each step, not at random")
    add_seed(parser)
    wanted = parser.parse_args(words)
    usual_signals()
    writing.PATIENCE = PATIENCE  # type: ignore[misc]  # another process may have to wait
    return everywhere() if wanted.everywhere else at_random(wanted.seed, wanted.count)


if __name__ == "__main__":
    sys.exit(main())
