"""CPU time of the tests, user and system, child processes included, by folder, module and test.

    python benchmarks/test_suite.py [PATH ...] [--against TREE] [--processes N] [--quick] [--write]

With PATHs only these modules or folders are run; `--processes 1` runs without pytest-xdist.
`--against` also runs the tests of another checkout, with its own .venv, and prints the ratios, of
all tests and of the modules that both have.
`--write` writes the modules that take more than half a second to tests/expensive_modules.json, the
list of modules that `-m quick` leaves out, and functions with several cases to
tests/expensive_tests.json, of which `tests.thinned` leaves out some. Unlike wall time, CPU
time hardly depends on what else the machine does.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from collections import Counter, defaultdict
from collections.abc import Generator
from pathlib import Path
from typing import Any, Final

import pytest

ROOT: Final = Path(__file__).resolve().parents[1]

EXPENSIVE: Final = ROOT / "tests" / "expensive_modules.json"

CASES: Final = ROOT / "tests" / "expensive_tests.json"

LIMIT: Final = 0.5
"""A module that takes more [s] counts as expensive."""

LIMIT_OF_CASES: Final = 0.3
"""So does a function with several cases; `MOST` of tests.thinned."""

INTO: Final = "CAMGEO_CPU_OF_TESTS"
"""Environment variable with the folder where each process of a run writes its tests' CPU times."""

LARGEST: Final = 40


def used() -> float:
    """CPU time [s] of this process and of its child processes that have ended."""
    both = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(each.ru_utime + each.ru_stime for each in both)


SPENT: defaultdict[str, float] = defaultdict(float)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, Any, Any]:
    """Count the CPU time of a test and its fixtures; runs as a plugin of the measured run."""
    before = used()
    try:
        return (yield)
    finally:
        SPENT[item.nodeid.partition("@")[0]] += used() - before


def pytest_sessionfinish() -> None:
    """Write the CPU times of this process."""
    (Path(os.environ[INTO]) / f"{os.getpid()}.json").write_text(json.dumps(SPENT), "utf-8")


def measured(tree: Path, python: str, *words: str) -> tuple[float, Counter[str]]:
    """CPU time [s] of the test run in `tree`, and of each test without its collection."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.pathsep.join(filter(None, (str(Path(__file__).parent), os.getenv("PYTHONPATH"))))
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        own = {"PYTHONPATH": path, INTO: folder, "CAMGEO_EVERY_CASE": "1"}
        done = subprocess.run(
            (python, "-m", "pytest", "-q", "-p", Path(__file__).stem, *words),
            cwd=tree, env={**os.environ, **own}, check=False,
        )  # fmt: skip
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode not in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED):
            raise SystemExit(f"{tree}: the tests did not run")
        spent: Counter[str] = Counter()
        for each in Path(folder).iterdir():
            spent.update(json.loads(each.read_text("utf-8")))
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, spent


def by(spent: Counter[str], parts: int) -> Counter[str]:
    """Sums by folder (2 parts of the path) or by module (all parts)."""
    found: Counter[str] = Counter()
    for test, seconds in spent.items():
        found["/".join(test.partition("::")[0].split("/")[:parts])] += seconds
    return found


def by_function(spent: Counter[str]) -> tuple[Counter[str], Counter[str]]:
    """Sums by test function, and the numbers of their cases."""
    found: Counter[str] = Counter()
    cases: Counter[str] = Counter()
    for test, seconds in spent.items():
        name = test.partition("[")[0]
        found[name] += seconds
        cases[name] += 1
    return found, cases


def with_cases(spent: Counter[str]) -> dict[str, float]:
    """The functions with several cases that take more than the limit."""
    found, cases = by_function(spent)
    return {
        name: round(seconds, 1)
        for name, seconds in sorted(found.items())
        if cases[name] > 1 and seconds > LIMIT_OF_CASES
    }


def functions(spent: Counter[str]) -> Counter[str]:
    """By test function, with the number of its cases."""
    found, cases = by_function(spent)
    return Counter({f"{name} ({cases[name]})": seconds for name, seconds in found.items()})


def main() -> None:
    """Run the tests, print their CPU times, and write the list if asked to."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("paths", nargs="*", help="modules or folders of tests; all without")
    parser.add_argument("--against", metavar="TREE", type=Path)
    parser.add_argument("--processes", metavar="N", default="2")
    parser.add_argument("--quick", action="store_true", help="only the quick subset")
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    if arguments.write and (arguments.paths or arguments.quick):
        parser.error("--write needs a run of all tests")
    words = [*arguments.paths, *(["-n", arguments.processes] if arguments.processes != "1" else [])]
    here, spent = measured(ROOT, sys.executable, *words, *(["-m", "quick"] * arguments.quick))
    for title, found in (
        ("folder", by(spent, 2)),
        ("module", by(spent, 9)),
        ("test, over its parameters", functions(spent)),
        ("test", spent),
    ):
        print(f"\nCPU time by {title} [s]")
        for name, seconds in found.most_common(LARGEST):
            print(f"{seconds:8.1f}  {name}")
    print(f"\nCPU time of the whole run, {len(spent)} tests: {here:.0f} s")
    if arguments.write:
        expensive = {
            name.removeprefix("tests/"): round(seconds, 1)
            for name, seconds in sorted(by(spent, 9).items())
            if seconds > LIMIT
        }
        EXPENSIVE.write_text(json.dumps(expensive, indent=2) + "\n", "utf-8")
        CASES.write_text(json.dumps(with_cases(spent), indent=2) + "\n", "utf-8")
    if arguments.against:
        tree = arguments.against.resolve()
        there, tests = measured(tree, str(tree / ".venv" / "bin" / "python"), *words)
        print(f"{tree}, {len(tests)} tests: {there:.0f} s; here {here / there:.2f} of it")
        now, then = by(spent, 9), by(tests, 9)
        same = sum(now[name] for name in then) / then.total()
        print(f"modules that are there, without collection: here {same:.2f} of it")


if __name__ == "__main__":
    main()
