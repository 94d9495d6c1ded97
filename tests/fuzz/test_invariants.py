"""Each invariant is seen to fail where camgeo is broken on purpose."""

from __future__ import annotations

import argparse
import signal
import threading
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from camgeo.check.finding import Finding
from camgeo.design.design import Design
from tests.fuzz import invariants
from tests.fuzz.case import PYTHON, SCENE, Case
from tests.fuzz.invariants import run
from tests.fuzz.scenes import FIXTURES
from tests.speed import cpu_second

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


def crash(arguments: argparse.Namespace) -> int:
    return 1 // 0


def warn(arguments: argparse.Namespace) -> int:
    warnings.warn("odd", stacklevel=1)
    return 0


def busy(arguments: argparse.Namespace) -> int:
    while True:
        pass


def asleep(arguments: argparse.Namespace) -> int:
    threading.Event().wait()
    return 0


def fill_memory(arguments: argparse.Namespace) -> int:
    raise MemoryError


def exit_oddly(arguments: argparse.Namespace) -> int:
    return 3


def differ_in_json(arguments: argparse.Namespace) -> int:
    return int(arguments.json)


def print_nan(arguments: argparse.Namespace) -> int:
    print("largest lift -nan mm at cam angle 0 deg")  # noqa: T201 - as a command does
    return 0


def print_no_json(arguments: argparse.Namespace) -> int:
    print("fine")  # noqa: T201 - as a command does
    return 0


def write_infinity(arguments: argparse.Namespace) -> int:
    Path("result.csv").write_text("0;1\n1;inf\n", "ascii")
    return 2


def leave_something(arguments: argparse.Namespace) -> int:
    Path(".camgeo-x").mkdir(exist_ok=True)
    return 2


@pytest.mark.parametrize(
    ("broken", "expected"),
    [
        (crash, "ZeroDivisionError at cli/main.py:_run"),
        (warn, "UserWarning at cli/main.py:_run"),
        (fill_memory, "MemoryError at cli/main.py:_run"),
        (busy, "hang in check"),
        (asleep, "hang in check"),
        (exit_oddly, "exit code 3 in check"),
        (differ_in_json, "exit code 0, with --json 1 in check"),
        (print_nan, "not finite: text of check in check"),
        (print_no_json, "JSONDecodeError"),
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
    monkeypatch.setattr("camgeo.app.answers.check.run", print_nan)
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
