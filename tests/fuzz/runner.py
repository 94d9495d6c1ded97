"""Draws cases, runs them and reports: each failure once, with its seed and its smallest case."""

from __future__ import annotations

import re
import subprocess
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

from tests.fuzz.case import OPEN, Case, restore, store
from tests.fuzz.invariants import Failure, Outcome
from tests.fuzz.minimise import minimised
from tests.fuzz.worker import Worker

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
