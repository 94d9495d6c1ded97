"""Processes that send themselves a signal at each step of writing a set: the same in every run.

    python -m tests.kill.everywhere

A step is what changes the disk, see `tests.kill.stops`. Small sets are written by forked processes,
alone and while another process waits for the folder; then `camgeo build` is stopped while it puts
its files in place, and `camgeo verify` judges what it leaves. Prints how many were stopped, by what
they did and by signal; exits with 1, and says which it was, if a folder then holds anything but a
whole set. `python -m tests.kill` stops processes at random moments.
"""

from __future__ import annotations

import io
import json
import os
import runpy
import shutil
import signal
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import redirect_stderr, redirect_stdout
from functools import partial
from pathlib import Path
from typing import Any, Final

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
    usual_signals,
)
from tests.long_form import LONG, examples
from tests.waiting import PATIENCE

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
    (fresh(folder) / "notes.txt").write_bytes(b"mine")
    every = Steps(0, RuntimeError())
    with stepping(every):
        code, said = called(*BUILD, str(folder), "--tolerance", "0.01")
    if code != 0:
        raise Fault(f"the first build fails: {said}")
    old = everything(folder)
    for k in range(BUILDS):
        at = Signalled((2 * k + 1) * every.done // (2 * BUILDS), itself(number))
        words = (*BUILD, str(folder), "--tolerance", f"0.0{k % 2 + 2}")
        if not stopped(forked(partial(camgeo, at, *words)), number):
            raise Fault("a build comes to its end")
        yield
        left = (folder / STAGING).exists()
        if left and number != signal.SIGKILL:
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


def main() -> int:
    usual_signals()
    writing.PATIENCE = PATIENCE  # type: ignore[misc]  # another process may have to wait
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


if __name__ == "__main__":
    sys.exit(main())
