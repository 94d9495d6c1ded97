"""Draws cases, runs them in a process of its own and reports: each failure once, with its seed and
its smallest case.
"""

from __future__ import annotations

import contextlib
import copy
import io
import multiprocessing
import os
import re
import resource
import subprocess
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from multiprocessing.connection import Connection
from pathlib import Path
from random import Random
from typing import Any, Final

from tests.fuzz.case import OPEN, SCENE, Case, changed, paths, restore, store, value_at
from tests.fuzz.drawn import set_span, span_of
from tests.fuzz.files import file_case, line_case
from tests.fuzz.invariants import Failure, Outcome, limited, run
from tests.fuzz.scenes import extreme_case, number_case, scene_case
from tests.speed import cpu_second
from tests.waiting import PATIENCE

# The cases of a run, by its seed and their numbers ------------------------------------------------


KINDS: Final[Mapping[str, tuple[Callable[[Random], Case], float]]] = {
    "scenes": (scene_case, 0.6),
    "lines": (line_case, 0.2),
    "files": (file_case, 0.2),
    "extremes": (extreme_case, 0.0),
    "numbers": (number_case, 0.0),
}
"""What draws the cases of a kind, and its share of the cases where no kind is asked for."""


def draw(seed: int, number: int, kind: str | None = None) -> tuple[str, Case]:
    """The kind and the case of that number of a run."""
    rng = Random(f"{seed}/{number}")
    shares = {kind: 1.0} if kind else {name: share for name, (_, share) in KINDS.items()}
    chosen = rng.choices(list(shares), list(shares.values()))[0]
    return chosen, KINDS[chosen][0](rng)


# A process of its own that runs cases, with a limit on its memory; replaced when it dies ----------


MOST_MEMORY: Final = 1 << 30
"""Bytes of the process."""

MOST_WAIT: Final = 6.0 * PATIENCE
"""Seconds after which a worker that hears no signal is ended: one that sleeps hears one earlier."""


Request = tuple[int, int, str | None]
"""A seed, the number of a case, and its kind if not any."""

Drawn = tuple[str, Case, Outcome]
"""The kind of a case, empty for one that was not drawn; the case; what it did."""


class Worker:
    """Runs cases one after the other, each in a new folder."""

    def __init__(self) -> None:
        self._process: multiprocessing.process.BaseProcess | None = None
        self._pipe: Connection | None = None

    def run(self, case: Case) -> Outcome:
        """What the case did; a failure if the process dies or has to be ended."""
        return self._asked(case, case)[2]

    def draw(self, seed: int, number: int, kind: str | None) -> Drawn:
        """The case of that number of a run, its kind, and what it did."""
        return self._asked((seed, number, kind), Case({}, ()))

    def _asked(self, request: Case | Request, case: Case) -> Drawn:
        pipe = self._pipe or self._start()
        pipe.send(request)
        problem = "died"
        with contextlib.suppress(EOFError, OSError):
            while pipe.poll(MOST_WAIT):
                drawn: Drawn = pipe.recv()
                if drawn[2].done:
                    return drawn
                _, case, _ = drawn  # it was drawn, and is being run
            problem = "hang"
        code = self.close(killing=problem == "hang")  # one that has died keeps its own code
        detail = f"the worker had to be ended, or ended with {code}"
        step = case.steps[0] if case.steps else ("draw",)
        return "", case, Outcome([Failure(f"{problem} in {step[0]}", step, detail)])

    def close(self, *, killing: bool = True) -> int | None:
        """End the process; its exit code."""
        process, pipe = self._process, self._pipe
        self._process = self._pipe = None
        if process is None:
            return None
        if pipe is not None:
            pipe.close()  # which ends one that waits for a case
        if not killing:
            process.join(PATIENCE)
        process.kill()
        process.join()
        return process.exitcode

    def _start(self) -> Connection:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read when the worker imports numpy
        cpu_second()  # the worker knows what is measured here
        # Not a daemon, which may start no processes; it ends with the pipe.
        self._process = context.Process(target=serve, args=(theirs,))
        self._process.start()
        theirs.close()
        self._pipe = ours
        return ours


def serve(pipe: Connection) -> None:
    """Run the cases that come through the pipe until it is closed."""
    sys.stdin = io.StringIO()
    warnings.simplefilter("error")
    limit_memory()
    home = Path.cwd()
    while True:
        try:
            case = pipe.recv()
        except EOFError:
            return
        kind = ""
        if not isinstance(case, Case):
            with limited("draw"):
                kind, case = draw(*case)
            pipe.send((kind, case, Outcome()))
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            outcome = run(case)
            os.chdir(home)
        pipe.send((kind, case, outcome))


def limit_memory() -> None:
    """Let the process grow to MOST_MEMORY; what is mapped but never touched does not count."""
    try:
        mapped, resident = map(int, Path("/proc/self/statm").read_text("ascii").split()[:2])
    except OSError:  # not Linux: no limit
        return
    page = resource.getpagesize()
    most = MOST_MEMORY + (mapped - resident) * page
    resource.setrlimit(resource.RLIMIT_AS, (most, most))


# Smaller cases that fail in the same way ----------------------------------------------------------


Fails = Callable[[Case], bool]


def minimised(case: Case, fails: Fails, tries: int = 1000) -> Case:
    """The smallest case found with so many runs by leaving out steps, files, keys and lines."""
    smaller_still = True
    while smaller_still:
        smaller_still = False
        for smaller in candidates(case):
            if _size(smaller) >= _size(case):
                continue
            if tries == 0:
                return case
            tries -= 1
            if fails(smaller):
                case, smaller_still = smaller, True
                break
    return case


def _size(case: Case) -> tuple[int, int]:
    return sum(map(len, case.steps)), sum(
        len(name) + len(data) for name, data in case.files.items()
    )


def candidates(case: Case) -> Iterator[Case]:
    """Cases with one thing less, the largest things first."""
    for k in range(len(case.steps)):
        if len(case.steps) > 1:
            yield replace(case, steps=case.steps[:k] + case.steps[k + 1 :])
    for name in case.files:
        yield replace(case, files={key: data for key, data in case.files.items() if key != name})
    values = case.values
    if values is not None:
        yield from (case.with_values(each) for each in smaller_scenes(values))
    for name, data in case.files.items():
        if name != SCENE or values is None:
            yield from (case.with_file(name, each) for each in shorter(data))
    for k, step in enumerate(case.steps):
        for word in range(1, len(step)):
            less = step[:word] + step[word + 1 :]
            yield replace(case, steps=(*case.steps[:k], less, *case.steps[k + 1 :]))


def smaller_scenes(values: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Scenes without one key or segment, or with a shorter number."""
    motion = values.get("motion")
    if isinstance(motion, list):
        for k in range(len(motion)):
            yield from _without_segment(values, k)
    known = sorted(paths(values), key=len)
    for path in known:
        yield changed(values, path, None)
    for path in known:
        number = value_at(values, path)
        if isinstance(number, float):
            for digits in (1, 2, 3, 6):
                yield changed(values, path, float(f"{number:.{digits}g}"))


def _without_segment(values: dict[str, Any], k: int) -> Iterator[dict[str, Any]]:
    """Without a segment, whose span the one before or after it takes over, or none."""
    for other in (k - 1, k + 1, None):
        found = copy.deepcopy(values)
        motion = found["motion"]
        if other is not None:
            if not 0 <= other < len(motion):
                continue
            if not all(isinstance(motion[i], dict) for i in (k, other)):
                continue
            spans = span_of(motion[k]), span_of(motion[other])
            if spans[0] is None or spans[1] is None:
                continue
            set_span(motion[other], round(spans[0] + spans[1], 9))
        del motion[k]
        yield found


def shorter(data: bytes) -> Iterator[bytes]:
    """Without a half, a quarter, ... of the lines, or of the bytes where there are few lines."""
    parts = data.splitlines(keepends=True)
    if len(parts) < 2:
        parts = [data[k : k + 1] for k in range(len(data))]
    size = len(parts)
    while size > max(len(parts) // 64, 0):
        for start in range(0, len(parts), size):
            yield b"".join(parts[:start] + parts[start + size :])
        size //= 2
        if size == 0:
            return


# Runs and reports ---------------------------------------------------------------------------------


SCENES = ("scenes", "extremes", "numbers")
"""Kinds whose cases are scenes."""

TRIES: Final = 100
"""Runs in which a case that fails is made smaller."""

SEPARATOR: Final = " -- "
"""Between what fails, the revision and the cause in the reason of an open case."""


@dataclass
class Report:
    """Counts of a run, and its failures."""

    seed: int
    kind: str | None = None
    cases: Counter[str] = field(default_factory=Counter)
    accepted: int = 0
    builds: int = 0
    built: int = 0
    verified: int = 0
    cpu: float = 0.0
    slowest: tuple[float, int, tuple[str, ...]] = (0.0, -1, ())
    found: dict[str, list[int]] = field(default_factory=dict)
    messages: list[str] = field(default_factory=list)

    def repeated(self, number: int) -> str:
        """The command that runs one of the cases again."""
        kind = f" --kind {self.kind}" if self.kind else ""
        return f"python -m tests.fuzz --seed {self.seed}{kind} --case {number}"

    @property
    def text(self) -> str:
        """The counts, a line each."""
        scenes = sum(self.cases[kind] for kind in SCENES)
        counts = ", ".join(f"{count} {kind}" for kind, count in self.cases.items())
        seconds, number, step = self.slowest
        lines = [
            f"seed {self.seed}: {self.cases.total()} cases ({counts}) in {self.cpu:.0f} s of CPU",
            f"slowest step {seconds:.1f} s of CPU: case {number}, {' '.join(step)[:100]}",
        ]
        if scenes:
            lines += [
                f"{100 * self.accepted / scenes:.0f}% of the scenes were accepted",
                f"{self.built} of {self.builds} builds wrote files; {self.verified} were verified",
            ]
        for signature, cases in self.found.items():
            lines.append(f"{len(cases)} x {signature}: cases {', '.join(map(str, cases[:8]))}")
        return "\n".join(lines)


def known_failures() -> set[str]:
    """Signatures of the failures in the corpus that are still open."""
    return {restore(path).source.split(SEPARATOR)[0] for path in kept(OPEN)}


def kept(folder: Path) -> list[Path]:
    """The cases in a folder of the corpus, not those in folders in it."""
    return sorted(each for each in folder.glob("*") if each.suffix in (".json", ".toml"))


def revision() -> str:
    """The commit that is being tested; empty without git."""
    call = ["git", "-C", str(OPEN.parent), "rev-parse", "--short=12", "HEAD"]
    try:
        done = subprocess.run(call, capture_output=True, text=True, check=False)
    except OSError:
        return ""
    return done.stdout.strip()


def fuzz(
    seed: int,
    *,
    count: int,
    kind: str | None = None,
    first: int = 0,
    minimise: int = TRIES,
    keep: Path | None = None,
    say: Callable[[str], object] = str,
) -> Report:
    """Run `count` cases from number `first` on.

    The smallest case of each new failure goes into the folder `keep`, found with `minimise` runs.
    What is told of it is passed to `say` at once.
    """
    report, worker, known = Report(seed, kind), Worker(), known_failures()
    try:
        for number in range(first, first + count):
            chosen, case, outcome = worker.draw(seed, number, kind)
            _count(report, chosen, number, case, outcome)
            for failure in outcome.failures:
                if failure.signature in known:
                    continue
                cases = report.found.setdefault(failure.signature, [])
                cases.append(number)
                if len(cases) == 1:
                    text = _explained(worker, case, failure, report, minimise, keep)
                    report.messages.append(text)
                    say(f"{text}\n")
    finally:
        worker.close()
    return report


def _count(report: Report, kind: str, number: int, case: Case, outcome: Outcome) -> None:
    report.cases[kind] += 1
    report.cpu += outcome.cpu
    if outcome.slowest > report.slowest[0]:
        report.slowest = (outcome.slowest, number, outcome.slowest_step)
    if kind in SCENES:
        report.accepted += outcome.accepted
        report.builds += any(step[0] == "build" for step in case.steps)
        report.built += outcome.built
        report.verified += outcome.verified


def _explained(
    worker: Worker, case: Case, failure: Failure, report: Report, tries: int, keep: Path | None
) -> str:
    """What failed, how to repeat it, and the smallest case."""
    number = report.found[failure.signature][0]

    def fails(smaller: Case) -> bool:
        found = worker.run(smaller).failures
        return any(each.signature == failure.signature for each in found)

    smallest = minimised(case, fails, tries)
    repeat = report.repeated(number)
    lines = [f"FAILED: {failure.signature}", f"repeat with: {repeat}", failure.detail.rstrip()]
    lines += [f"call: {' '.join(step)}" for step in smallest.steps]
    if keep is not None:
        stem = re.sub(r"[^a-z0-9]+", "_", failure.signature.lower()).strip("_")[:80]
        why = (failure.signature, f"revision {revision()}", f"cause not known yet; {repeat}")
        smallest = replace(smallest, source=SEPARATOR.join(why))
        keep.mkdir(parents=True, exist_ok=True)
        lines.append(f"kept in {store(smallest, keep / stem)}")
    return "\n".join(lines)
