"""Cases that once failed, and do no more, and random ones; each invariant is seen to fail."""

from __future__ import annotations

import argparse
import signal
import threading
import tomllib
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import Any, Final
from unittest.mock import Mock

import pytest

from camgeo.check.finding import Finding
from camgeo.design.design import Design
from camgeo.errors import SceneError
from camgeo.scene.scene import load_scene
from tests.fuzz import invariants, runner
from tests.fuzz.__main__ import call
from tests.fuzz.case import (
    CORPUS,
    OPEN,
    PYTHON,
    SCENE,
    SCENE_STEPS,
    SLOW,
    Case,
    restore,
    store,
    toml,
)
from tests.fuzz.files import ENDING, line
from tests.fuzz.invariants import Failure, Outcome, run
from tests.fuzz.runner import (
    KINDS,
    SEPARATOR,
    Report,
    Worker,
    draw,
    fuzz,
    kept,
    known_failures,
    minimised,
)
from tests.fuzz.scenes import FIXTURES, fixtures, scene_case, values_of
from tests.hostile.mutations import mutated
from tests.long_form import LONG, examples
from tests.seeds import FIXED, FRESH
from tests.speed import cpu_second
from tests.thinned import share

MOST_OPEN: Final = 10
"""Cases that may wait for a correction."""


@pytest.fixture(scope="module")
def worker() -> Iterator[Worker]:
    worker = Worker()
    yield worker
    worker.close()


def failing(path: Path) -> Any:
    """A case that is expected to fail, and no longer open if it does not."""
    reason = f"{restore(path).source}; where it passes, move it up"
    mark = pytest.mark.xfail(strict=True, raises=AssertionError, reason=reason)
    return pytest.param(path, marks=mark, id=f"{path.parent.name}-{path.stem}")


def failures(path: Path, worker: Worker) -> list[Failure]:
    case = restore(path)
    return worker.run(replace(case, both=case.both or LONG)).failures


def test_cases_of_the_corpus_pass(worker: Worker) -> None:
    found = {path.stem: failures(path, worker) for path in share(kept(CORPUS), 3)}
    assert not any(found.values())
    assert found


@pytest.mark.long  # a second and more each; what was slow once, and is less so now
@pytest.mark.parametrize("path", kept(SLOW), ids=lambda path: path.stem)
def test_slow_case_of_the_corpus(path: Path, worker: Worker) -> None:
    assert failures(path, worker) == []


@pytest.mark.parametrize("path", [*map(failing, kept(OPEN))])
def test_open_case_of_the_corpus(path: Path, worker: Worker) -> None:
    assert failures(path, worker) == []


def test_few_cases_are_open_and_each_has_revision_and_cause() -> None:
    assert len(kept(OPEN)) <= MOST_OPEN
    for path in kept(OPEN):
        _, revision, cause = restore(path).source.split(SEPARATOR)
        assert revision.startswith("revision ")
        assert cause


class Failing(Worker):
    """Runs nothing: all cases fail for the same cause."""

    def draw(self, seed: int, number: int, kind: str | None) -> tuple[str, Case, Outcome]:
        case = Case({"a": b"1"}, (("check", "a"),))
        return "files", case, self.run(case)

    def run(self, case: Case) -> Outcome:
        return Outcome([Failure("exit code 3 in check", ("check", "a"), "told")], done=True)


def test_what_fails_is_kept_as_open_and_found_once_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runner, "Worker", Failing)
    monkeypatch.setattr(runner, "OPEN", tmp_path)
    assert fuzz(1, count=3, keep=tmp_path).found == {"exit code 3 in check": [0, 1, 2]}
    (path,) = kept(tmp_path)
    what, revision, cause = restore(path).source.split(SEPARATOR)
    assert what == "exit code 3 in check"
    assert revision.startswith("revision ")
    assert cause.endswith("python -m tests.fuzz --seed 1 --case 0")
    assert restore(path).files == {}  # made smaller
    assert known_failures() == {"exit code 3 in check"}
    assert fuzz(1, count=3, keep=tmp_path).found == {}


def test_an_open_case_that_passes_refuses_the_run(tmp_path: Path) -> None:
    case = Case({}, (("laws",),), SEPARATOR.join(("exit code 3 in laws", "revision 1", "a limit")))
    (mark,) = failing(store(case, tmp_path / "case")).marks
    assert mark.name == "xfail"
    assert mark.kwargs["strict"]
    assert "a limit" in mark.kwargs["reason"]


# -- fuzz ------------------------------------------------------------------------------------------
# Random cases, the same in every run; `python -m tests.fuzz --seed fresh` draws others.


SEED: Final = 2026

FIRST: Final = examples(218, long=150)
"""Number of the first case: from here all kinds come soon, and one builds files that verify."""

CASES: Final = examples(10, long=31)


def test_random_cases(capsys: pytest.CaptureFixture[str]) -> None:
    report = fuzz(SEED, first=FIRST, count=CASES, minimise=20)
    with capsys.disabled():
        print(f"\n{report.text}")  # noqa: T201 - so that a run can be repeated
    assert not report.found, "\n\n".join((*report.messages, report.text))
    assert report.cases.total() == CASES
    assert min(report.cases.values()) >= 2
    assert report.verified >= 1


# -- cases -----------------------------------------------------------------------------------------
# Cases: what is drawn, how it is kept, and how it is made smaller.


@pytest.mark.parametrize("path", fixtures(), ids=lambda path: path.stem)
def test_toml_is_read_back(path: Path) -> None:
    values = values_of(path)
    assert tomllib.loads(toml(values)) == values


@pytest.mark.parametrize("kind", KINDS)
def test_a_number_of_a_run_is_always_the_same_case(kind: str) -> None:
    assert draw(1, 2, kind) == draw(1, 2, kind)
    assert draw(1, 2, kind) != draw(1, 3, kind)


def test_most_scenes_pass_the_door(tmp_path: Path) -> None:
    passed = 0
    for number in range(20):
        case = scene_case(Random(number))
        for name, data in case.files.items():
            (tmp_path / name).write_bytes(data)
        try:
            load_scene(tmp_path / SCENE)
            passed += 1
        except SceneError:
            pass
    assert 12 <= passed < 20  # those that the door refuses are cases too


def test_all_commands_that_end_are_called() -> None:
    rng = Random(1)
    assert set(ENDING) <= set(Counter(line(rng)[0] for _ in range(600)))


@pytest.mark.parametrize("seed", range(20))
def test_files_of_no_length_can_be_damaged(seed: int) -> None:
    assert isinstance(mutated(b"", Random(seed)), bytes)


@pytest.mark.parametrize(
    "case",
    [
        Case({SCENE: b"camgeo = 1\n"}, SCENE_STEPS, "a scene"),
        Case({SCENE: b"camgeo = 1\n"}, SCENE_STEPS, "a scene, in one form", both=False),
        Case({SCENE: b"camgeo = 1\n", "a.csv": b"\xff\x00"}, (("check", SCENE),), "files"),
    ],
)
def test_what_is_kept_is_read_back(case: Case, tmp_path: Path) -> None:
    path = store(case, tmp_path / "case")
    found = restore(path)
    assert (found.steps, found.source, found.both) == (case.steps, case.source, case.both)
    for name, data in case.files.items():  # a scene has the reason above it
        assert found.files[name].endswith(data)


def test_the_smallest_case_has_only_what_fails() -> None:
    segments = [{"dwell": 30.0}, {"law": "auto", "span": 230.0, "to": 7.0}, {"dwell": 100.0}]
    values = {"name": "a", "cam": {"rotation": "cw"}, "motion": segments, "part": {"bore": 1.2345}}
    steps = (("check", SCENE), ("build", SCENE))
    case = Case({SCENE: toml(values).encode(), "a.csv": b"1\n2\n3\n"}, steps)

    def fails(smaller: Case) -> bool:
        found = smaller.values or {}
        builds = any(step[:1] == ("build",) for step in smaller.steps)
        return builds and any("law" in each for each in found.get("motion", ()))

    smallest = minimised(case, fails)
    assert (smallest.steps, smallest.values) == ((("build",),), {"motion": [{"law": "auto"}]})
    assert set(smallest.files) == {SCENE}


def test_a_case_is_made_smaller_in_so_many_runs_and_no_more() -> None:
    data = b"".join(b"%d\n" % k for k in range(100))
    fails = Mock(side_effect=lambda smaller: b"57" in smaller.files.get("a.dxf", b""))
    found = minimised(Case({"a.dxf": data}, (("verify", "a.dxf"),)), fails, 5)
    assert fails.call_count == 5
    assert b"57" in found.files["a.dxf"]
    assert len(found.files["a.dxf"]) < len(data)


def test_lines_that_do_not_matter_are_left_out() -> None:
    data = b"".join(b"%d\n" % k for k in range(100))
    case = Case({"a.dxf": data}, (("verify", "a.dxf"),))
    smallest = minimised(case, lambda each: b"57" in each.files.get("a.dxf", b""))
    assert smallest.files == {"a.dxf": b"57\n"} or smallest.files == {"a.dxf": b"57"}


def test_a_seed_is_fixed_unless_a_fresh_one_is_asked_for() -> None:
    assert call([]).seed == call([]).seed == FIXED
    assert call(["--seed", "7"]).seed == 7
    assert len({call(["--seed", FRESH]).seed for _ in range(4)}) > 1


@pytest.mark.parametrize("kind", [None, *KINDS])
def test_the_command_that_repeats_a_case_draws_it_again(kind: str | None) -> None:
    for number in (3, 4, 7):
        words = Report(11, kind).repeated(number).split()
        assert words[:3] == ["python", "-m", "tests.fuzz"]
        given = call(words[3:])
        assert draw(given.seed, given.case, given.kind) == draw(11, number, kind)


# Each invariant is seen to fail where camgeo is broken on purpose ---------------------------------


TAPPET = (FIXTURES / "scenes" / "tappet.toml").read_bytes()

CHECK = Case({SCENE: TAPPET}, (("check", SCENE),))

Run = Callable[[argparse.Namespace], int]


def signatures(case: Case) -> list[str]:
    return [failure.signature for failure in run(case).failures]


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_nothing_fails_where_nothing_is_broken() -> None:
    steps = ((PYTHON, SCENE), ("check", SCENE), ("build", SCENE, "-o", "out"), ("verify", "out"))
    outcome = run(Case({SCENE: TAPPET}, steps))
    assert outcome.failures == []
    assert outcome.accepted
    assert outcome.built
    assert outcome.verified


def saying(text: str) -> Run:
    def say(arguments: argparse.Namespace) -> int:
        print(text)  # noqa: T201 - as a command does
        return 0

    return say


PRINT_NAN = saying("largest lift -nan mm at cam angle 0 deg")


def warn(arguments: argparse.Namespace) -> int:
    warnings.warn("odd", stacklevel=1)
    return 0


def busy(arguments: argparse.Namespace) -> int:
    while True:
        pass


def asleep(arguments: argparse.Namespace) -> int:
    threading.Event().wait()
    return 0


def differ_in_json(arguments: argparse.Namespace) -> int:
    return int(arguments.json)


def write_infinity(arguments: argparse.Namespace) -> int:
    Path("result.csv").write_text("0;1\n1;inf\n", "ascii")
    return 2


def leave_something(arguments: argparse.Namespace) -> int:
    Path(".camgeo-x").mkdir(exist_ok=True)
    return 2


@pytest.mark.parametrize(
    ("broken", "expected"),
    [
        (Mock(side_effect=ZeroDivisionError), "ZeroDivisionError at cli/main.py:_run"),
        (warn, "UserWarning at cli/main.py:_run"),
        (Mock(side_effect=MemoryError), "MemoryError at cli/main.py:_run"),
        (busy, "hang in check"),
        (asleep, "hang in check"),
        (Mock(return_value=3), "exit code 3 in check"),
        (differ_in_json, "exit code 0, with --json 1 in check"),
        (PRINT_NAN, "not finite: text of check in check"),
        (saying("fine"), "JSONDecodeError"),
        (write_infinity, "not finite: .csv in files"),
        (leave_something, "left behind in files"),
    ],
)
def test_a_broken_command_is_found(
    broken: Run, expected: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("camgeo.app.answers.check.run", broken)
    if broken is busy:
        monkeypatch.setattr(invariants, "MOST_CPU", 0.5)
    if broken is asleep:
        monkeypatch.setattr(invariants, "PATIENCE", 0.1)
        monkeypatch.setattr(invariants, "AWAKE", 1e6)
    (found,) = signatures(CHECK)
    assert found.startswith(expected)


def test_json_may_go_into_a_file_and_a_scene_may_have_any_name() -> None:
    steps = (("table", SCENE, "-o", "o.txt"), ("new", "translating-roller", "-o", "o.json"))
    assert signatures(Case({SCENE: TAPPET}, steps)) == []


def test_a_file_may_end_like_a_number_that_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("camgeo.app.answers.check.run", PRINT_NAN)
    certificate = b'{"files": [{"file": "x.nan", "format": "csv"}]}'
    found = signatures(Case({SCENE: TAPPET, "certificate.json": certificate}, CHECK.steps))
    assert not [each for each in found if each.startswith("not finite")]


def test_a_step_that_a_busy_machine_keeps_waiting_does_not_hang(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each time its patience is over, the machine has let it do a little; then nothing more."""
    spent = [0.0]
    monkeypatch.setattr(invariants, "cpu", lambda: spent[0])
    awake = 1.01 * invariants.AWAKE * cpu_second()
    with invariants.limited("check"):
        for _ in range(100):
            spent[0] += awake
            signal.raise_signal(signal.SIGALRM)
        with pytest.raises(invariants.Hang):
            signal.raise_signal(signal.SIGALRM)


def test_a_number_that_is_none_in_a_finding_is_found(monkeypatch: pytest.MonkeyPatch) -> None:

    def findings(design: Design) -> tuple[Finding, ...]:
        return (Finding("any", "ok", "fine", value=float("nan")),)

    monkeypatch.setattr(Design, "findings", property(findings))
    case = replace(CHECK, steps=((PYTHON, SCENE), ("check", SCENE)))
    python, *_ = signatures(case)
    assert python.startswith("ValueError")  # JSON has no such number


def test_words_of_the_case_may_be_repeated() -> None:
    text = TAPPET.replace(b'rotation = "ccw"', b"rotation = nan", 1)
    assert text != TAPPET
    assert signatures(CHECK.with_file(SCENE, text)) == []
