"""What must hold for every case, whatever it is; see docs/robustness.md."""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import signal
import traceback
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cache, partial
from itertools import pairwise
from pathlib import Path
from types import FrameType
from typing import Any, Final

import numpy as np
from jsonschema_rs import Draft202012Validator

import camgeo
import camgeo_export
from camgeo.app.answers.answer import CRASHED, document_schema
from camgeo.app.cli.main import TRACEBACK, main
from camgeo.design.design import Design
from camgeo.errors import CamgeoError, SceneError
from camgeo.scene.scene import load_scene
from tests.effects.test_random_scenes import assert_findings, assert_well_formed
from tests.fuzz.case import PYTHON, Case, Step
from tests.fuzz.files import commands
from tests.speed import cpu, cpu_second
from tests.waiting import PATIENCE

DOCUMENTED: Final = (0, 1, 2)
"""Exit codes of the command line."""

HELP: Final = frozenset(("-h", "--help", "--version"))

MOST_CPU: Final = 120.0
"""Seconds of computing of a command, see `tests.speed`."""

LONG: Final = {
    "accuracy": 360.0,
    "sweep": 360.0,
    "optimise": 360.0,
    PYTHON: 240.0,
    "compare": 240.0,
}
"""Seconds of computing of those that compute many designs, or all columns of all effects."""

AWAKE: Final = 0.1
"""Seconds of computing that a step must have done within `PATIENCE`; else it sleeps.

A busy machine may leave it little, so that time itself is not limited."""

NOT_FINITE: Final = re.compile(r"(?<![\w.])[-+]?(?:nan|inf|infinity)(?![\w.]*\w)", re.IGNORECASE)

TEXTS: Final = frozenset((".dxf", ".ngc", ".csv", ".json", ".svg", ".toml", ".asc"))

FACET: Final = np.dtype([("numbers", "<f4", 12), ("rest", "<u2")])


class Hang(BaseException):
    """A step takes too long."""


@dataclass(frozen=True, slots=True)
class Failure:
    """What did not hold: `signature` is equal for failures of one cause, as far as can be told."""

    signature: str
    step: Step
    detail: str


@dataclass(slots=True)
class Outcome:
    """What a case did: failures, whether it came to its end, and how far."""

    failures: list[Failure] = field(default_factory=list)
    done: bool = False
    accepted: bool = False
    built: bool = False
    verified: bool = False
    cpu: float = 0.0
    slowest: float = 0.0
    slowest_step: Step = ()


class Broken(Exception):
    """An invariant does not hold: a short name of it, and details."""


def run(case: Case) -> Outcome:
    """Run the steps of a case in the current folder, which is empty, and check what they do."""
    outcome = Outcome()
    for name, data in case.files.items():
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_bytes(data)
    for step in case.steps:
        if step == ("verify", "out") and not Path("out").exists():
            continue
        before = cpu()
        failure = _failure(step, partial(_check, step, case, outcome))
        spent = cpu() - before
        outcome.cpu += spent
        if spent > outcome.slowest:
            outcome.slowest, outcome.slowest_step = spent, step
        if failure:
            outcome.failures.append(failure)
            if failure.signature.startswith("hang"):  # so would the other steps
                break
    failure = _failure(("files",), lambda: _check_files(case))
    if failure:
        outcome.failures.append(failure)
    outcome.done = True
    return outcome


def _failure(step: Step, check: Callable[[], None]) -> Failure | None:
    try:
        check()
        return None
    except Broken as broken:
        kind, detail = broken.args
    except Hang:
        kind, detail = "hang", traceback.format_exc()
    except Exception as error:
        detail = traceback.format_exc()
        kind = f"{type(error).__name__} at {_place(detail)}"
    signature = kind if " at " in kind else f"{kind} in {step[0] if step else ''}"
    return Failure(signature, step, _shortened(detail))


def _shortened(trace: str) -> str:
    """The last lines of a traceback or an output."""
    return "\n".join(trace.splitlines()[-24:])


OURS: Final = {Path(str(each.__file__)).parent for each in (camgeo, camgeo_export)}
"""The folders of the packages."""


def _place(trace: str) -> str:
    """The last function of camgeo, or else any, that a traceback goes through."""
    frames = re.findall(r'File "(.*)", line \d+, in (\S+)', trace)
    ours = [each for each in frames if not OURS.isdisjoint(Path(each[0]).parents)]
    name, function = (ours or frames)[-1]
    return f"{'/'.join(Path(name).parts[-2:])}:{function}"


@contextlib.contextmanager
def limited(name: str) -> Iterator[None]:
    """Raise `Hang` inside after the computing that the command `name` may do, or if it sleeps."""
    most, awake = (each * cpu_second() for each in (LONG.get(name, MOST_CPU), AWAKE))
    spent = cpu()

    def stop(number: int, frame: FrameType | None) -> None:
        raise Hang

    def stop_asleep(number: int, frame: FrameType | None) -> None:
        nonlocal spent
        before, spent = spent, cpu()
        if spent - before < awake:
            raise Hang

    handlers = [
        (signal.SIGPROF, signal.signal(signal.SIGPROF, stop)),
        (signal.SIGALRM, signal.signal(signal.SIGALRM, stop_asleep)),
    ]
    signal.setitimer(signal.ITIMER_PROF, most)
    signal.setitimer(signal.ITIMER_REAL, PATIENCE, PATIENCE)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        for each, handler in handlers:
            signal.signal(each, handler)


# Steps --------------------------------------------------------------------------------------------


def _check(step: Step, case: Case, outcome: Outcome) -> None:
    """One step; of a command that also answers in JSON both forms, unless the case wants one."""
    if step[:1] == (PYTHON,):
        with limited(PYTHON):
            _check_python(step[1], outcome)
        return
    code, out, err = sound_call(step, case.text)
    if HELP & set(step):
        return
    parser = commands().get(step[0]) if step else None
    answers = parser is not None and "--json" in parser._option_string_actions
    if parser is not None and answers and "--json" not in step and case.both:
        overwrites = code < 2 and "--force" in parser._option_string_actions
        again = ["--force"] * overwrites  # what it has just written
        _check_json((step[0], "--json", *again, *step[1:]), case, code)
    elif "--json" in step and out:
        parsed(out)
    if step[0] == "build" and code < 2 and Path("out/certificate.json").exists():
        outcome.built = True
    if step == ("verify", "out") and outcome.built:
        outcome.verified = True
        if code != 0:
            raise Broken("built files do not verify", out + err)


def _check_python(name: str, outcome: Outcome) -> None:
    """All findings and effects of a scene, by the functions of the package."""
    try:
        design = Design(load_scene(name))
    except SceneError:
        return
    outcome.accepted = True
    try:
        findings = design.findings
    except CamgeoError:
        return
    names = [each.name.removeprefix("return: ") for each in findings]
    assert_findings(
        "geometry",
        tuple(replace(each, name=name) for each, name in zip(findings, names, strict=True)),
    )
    assert_well_formed(design)


def _check_json(step: Step, case: Case, code: int) -> None:
    json_code, out, err = sound_call(step, case.text)
    if json_code != code:
        raise Broken(f"exit code {code}, with --json {json_code}", out + err)
    files = [Path(word) for option, word in pairwise(step) if option == "-o"]
    if not out and code < 2 and files and files[-1].is_file():
        out = files[-1].read_text("utf-8")  # a table as JSON goes into its file
    if not out and code < 2:
        raise Broken("no JSON", err)
    if out and "--table" not in step:
        document = parsed(out)
        name = document["schema"].removeprefix("camgeo/")
        fault = next(iter(_validator(name).iter_errors(document)), None)
        if fault:
            raise Broken("JSON against its schema", str(fault))


@cache
def _validator(name: str) -> Draft202012Validator:
    return Draft202012Validator(document_schema(f"camgeo.app.answers.{name.replace('-', '_')}"))


def sound_call(words: Step, given: str = "") -> tuple[int, str, str]:
    """Exit code, output and messages of a command line that keeps what every command must.

    `given` is all that it is given, in lower case: what it may repeat. Raises Broken or Hang.
    """
    code, out, err = _call(words)
    if code == CRASHED:
        error = re.findall(r"internal error \((\w+)", out + err)[-1]
        traced = "Traceback (most" in err  # not where one file of several is at fault
        raise Broken(f"{error} at {_place(err)}" if traced else error, out + err)
    if code not in DOCUMENTED:
        raise Broken(f"exit code {code}", err)
    if "Traceback (most" in err or "Warning:" in err:
        raise Broken("traceback", err)
    form = "JSON" if "--json" in words else "text"
    _require_finite(given, f"{form} of {words[0] if words else ''}", out + err)
    return code, out, err


def _call(words: Step) -> tuple[int, str, str]:
    """Exit code, output and messages of a command line; exceptions that it lets through."""
    out, err = (
        io.TextIOWrapper(io.BytesIO(), "utf-8", errors) for errors in ("strict", "backslashreplace")
    )
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            with limited(words[0] if words else ""):
                code = main([*words, TRACEBACK])
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 0 if end.code is None else 1
    texts = []
    for stream in (out, err):
        stream.flush()
        texts.append(stream.buffer.getvalue().decode())
    return code, texts[0], texts[1]


# What is not finite -------------------------------------------------------------------------------


def _require_finite(given: str, what: str, text: str) -> None:
    """That no number is infinite or none, but for words that are given."""
    repeated = frozenset(re.findall(r"[a-z]+", given))  # the ending of a file is a format's name
    for found in NOT_FINITE.finditer(text):
        if found.group().lower().lstrip("+-") not in repeated:
            near = text[max(found.start() - 300, 0) : found.end() + 100]
            raise Broken(f"not finite: {what}", near)


def _refuse(constant: str) -> float:
    raise Broken("not finite: JSON", constant)


def parsed(text: str) -> Any:
    """A JSON document; Broken if it has a number that JSON has not."""
    return json.loads(text, parse_constant=_refuse)


def _check_files(case: Case) -> None:
    """That all files written are finite, and nothing else is left."""
    for folder, names, files in os.walk("."):
        for name in (*names, *files):
            if name.startswith("."):
                raise Broken("left behind", f"{folder}/{name}")
        for path in (Path(folder, name) for name in files):
            given = case.files.get(path.as_posix())
            data = path.read_bytes()
            if data != given:
                _check_file(case, path, data)


def _check_file(case: Case, path: Path, data: bytes) -> None:
    if path.suffix == ".stl" and not np.isfinite(np.frombuffer(data[84:], FACET)["numbers"]).all():
        raise Broken("not finite: STL", str(path))
    if path.suffix == ".3mf":
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            for name in archive.namelist():
                _require_finite(case.text, path.suffix, archive.read(name).decode())
    if path.suffix in TEXTS:
        _require_finite(case.text, path.suffix, data.decode())
    # A scene or a table may have any name, but neither begins like a document.
    if path.suffix == ".json" and data.startswith(b"{"):
        parsed(data.decode())
