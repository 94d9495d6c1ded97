"""No verdict depends on chance or on load: what tests and .ci must not do, found in their text.

Numbers are drawn from a stated seed. Nothing sleeps, reads a clock or gives up before the time
after which `tests.waiting` does; computing is measured by `tests.speed`. Only the helpers that all
others share are left out, and a program that is run by hand draws and waits by `tests.seeds`.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

import pytest

from tests import speed, waiting
from tests.waiting import PATIENCE

TESTS: Final = Path(__file__).parent

CI: Final = TESTS.parent / ".ci"

HELPERS: Final = {
    "waiting.py": "waits for all others",
    "speed.py": "measures for all others",
    "seeds.py": "draws the seed and the moment that a call by hand asks for",
    "test_verdicts.py": "states what is wrong",
}
"""Modules that may do what no other does, and why."""

CLOCKS: Final = frozenset(
    f"time.{name}{unit}"
    for name in ("time", "monotonic", "perf_counter", "process_time", "thread_time")
    for unit in ("", "_ns")
) | {"datetime.datetime.now", "datetime.datetime.utcnow", "datetime.date.today"}

SLEEPS: Final = frozenset(("time.sleep", "asyncio.sleep", "signal.alarm"))

CHANCE: Final = frozenset(
    ("random.SystemRandom", "os.urandom", "os.getrandom", "uuid.uuid1", "uuid.uuid4")
)

SEEDED: Final = frozenset(
    ("random.Random", "numpy.random.default_rng", "numpy.random.RandomState",
     "numpy.random.SeedSequence", "numpy.random.PCG64", "numpy.random.MT19937",
     "numpy.random.Philox", "numpy.random.SFC64")
)  # fmt: skip
"""Generators, whose first argument is a seed."""

LIMITS: Final = frozenset(("timeout", "open_timeout", "close_timeout", "ping_timeout", "patience"))
"""Keywords that state a time."""

WAITING: Final = frozenset(
    ("join", "wait", "poll", "result", "recv", "get", "acquire", "settimeout")
)
"""Methods whose first argument, if it is a number, is a time."""

MINUTES: Final = "--" + "minutes"

WRONG_IN_CI: Final = {
    rf"{MINUTES}\b": "as many cases as the machine makes in some minutes",
    r"\$\{?RANDOM|/dev/u?random|\bshuf\b": "chance",
    r"^[^#\n]*\b(sleep|timeout) ": "a time",
}

WRONG_IN_RUN: Final = {r"\bfresh\b": "a seed that nobody has chosen"}
"""In `.ci/run`, which has one verdict for one commit, and what it shares with `.ci/full`."""

PASSED: Final = (ast.expr_context, ast.operator, ast.cmpop, ast.boolop, ast.unaryop)
"""Nodes that say nothing."""


class Module:
    """The text of a module, and what its names stand for."""

    def __init__(self, text: str) -> None:
        self.tree = ast.parse(text)
        self.names: dict[str, str] = {}
        self.constants: dict[str, ast.expr] = {}
        self.nodes = [node for node in ast.walk(self.tree) if not isinstance(node, PASSED)]
        for node in self.nodes:
            match node:
                case ast.Import():
                    for each in node.names:
                        top = each.name.partition(".")[0]
                        self.names[each.asname or top] = each.name if each.asname else top
                case ast.ImportFrom(module=str(module), level=0):
                    for each in node.names:
                        self.names[each.asname or each.name] = f"{module}.{each.name}"
                case ast.FunctionDef() | ast.AsyncFunctionDef():
                    self._note_defaults(node.args)
        for statement in self.tree.body:
            match statement:
                case ast.Assign(targets=[target]):
                    self._note(target, statement.value)
                case ast.AnnAssign(target=target, value=ast.expr() as value):
                    self._note(target, value)

    def _note(self, target: ast.expr, value: ast.expr) -> None:
        if isinstance(target, ast.Name):
            self.constants[target.id] = value
        elif isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
            for each, one in zip(target.elts, value.elts, strict=False):
                self._note(each, one)

    def _note_defaults(self, arguments: ast.arguments) -> None:
        """An argument stands for what it is by default."""
        given = [*arguments.posonlyargs, *arguments.args]
        for argument, value in zip(reversed(given), reversed(arguments.defaults), strict=False):
            self.constants.setdefault(argument.arg, value)
        for argument, default in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True):
            if default is not None:
                self.constants.setdefault(argument.arg, default)

    def dotted(self, node: ast.AST) -> str:
        """What a name of an imported module or of something in it stands for; else nothing."""
        match node:
            case ast.Name(id=name):
                return self.names.get(name, "")
            case ast.Attribute(value=value, attr=name):
                inner = self.dotted(value)
                return f"{inner}.{name}" if inner else ""
        return ""

    def number(self, node: ast.AST) -> float | None:
        """The value of an expression of numbers and constants; None if it is none."""
        match node:
            case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
                return float(value)
            case ast.Name(id=name):
                if name in self.constants:
                    stands = self.constants[name]
                    itself = isinstance(stands, ast.Name) and stands.id == name
                    return None if itself else self.number(stands)
                return self.imported(self.names.get(name, ""))
            case ast.BinOp(left=left, op=ast.Mult() | ast.Add() as op, right=right):
                one, other = self.number(left), self.number(right)
                if one is None or other is None:
                    return None
                return one * other if isinstance(op, ast.Mult) else one + other
        return None

    @staticmethod
    def imported(name: str) -> float | None:
        """The value of a constant of another module of the tests; None if it is none."""
        module, _, constant = name.rpartition(".")
        path = TESTS.parent.joinpath(*module.split(".")).with_suffix(".py")
        if not module.startswith("tests") or not path.is_file():
            return None
        return Module(path.read_text("utf-8")).number(ast.Name(constant))


def faults(text: str) -> list[str]:
    """What in a module lets its verdict depend on chance or load, a line each."""
    module = Module(text)
    found = [(node.lineno, each) for node in module.nodes for each in wrong(module, node)]  # type: ignore[attr-defined]  # those with a fault have a place
    return [f"line {line}: {each}" for line, each in sorted(set(found))]


def wrong(module: Module, node: ast.AST) -> Iterator[str]:
    """What a node of a syntax tree does wrong."""
    match node:
        case ast.Import() | ast.ImportFrom():
            names = (
                [node.module] if isinstance(node, ast.ImportFrom) else [a.name for a in node.names]
            )
            yield from ("secrets: chance" for name in names if name == "secrets")
        case ast.Name() | ast.Attribute():
            yield from wrong_name(module.dotted(node))
        case ast.Call():
            yield from wrong_call(module, node)
        case ast.Constant(value=str(text)):
            if MINUTES in text:
                yield f"{MINUTES}: as many cases as the machine makes"
            if "\n" in text and "import " in text:
                yield from wrong_program(text)


def wrong_name(name: str) -> Iterator[str]:
    """What is wrong with a function of another module, called or not."""
    last = name.rpartition(".")[2]
    drawn = name.startswith(("random.", "numpy.random.")) and last.islower()
    if name in CHANCE or (drawn and name not in SEEDED):
        yield f"{name}: chance, without a seed of its own"
    if name in SLEEPS:
        yield f"{name}: a time in place of an event"
    if name in CLOCKS:
        yield f"{name}: a clock"


def wrong_call(module: Module, call: ast.Call) -> Iterator[str]:
    """What is wrong with the arguments of a call."""
    name = module.dotted(call.func)
    given = [*call.args, *(each.value for each in call.keywords)]
    if name in SEEDED and all(isinstance(a, ast.Constant) and a.value is None for a in given):
        yield f"{name}: no seed"
    limits = [each.value for each in call.keywords if each.arg in LIMITS]
    if isinstance(call.func, ast.Attribute) and call.func.attr in WAITING and len(call.args) == 1:
        limits += call.args
    if name == "threading.Timer" or name == "signal.setitimer":
        at = int(name == "signal.setitimer")
        wall = at == 0 or module.dotted(call.args[0]) == "signal.ITIMER_REAL"
        limits += call.args[at : at + 1] if wall else []
    for limit in limits:
        value = module.number(limit)
        if value is not None and 0.0 < value < PATIENCE:
            yield f"gives up after {value:g} s"
    for each in call.keywords:
        if each.arg == "deadline" and not (
            isinstance(each.value, ast.Constant) and each.value.value is None
        ):
            yield "a deadline"


def wrong_program(text: str) -> Iterator[str]:
    """What is wrong with a program that stands in a text."""
    try:
        yield from (f"in a text: {each}" for each in faults(text))
    except SyntaxError:
        return


def wrong_in_ci(text: str, patterns: Mapping[str, str]) -> list[str]:
    """What steps of .ci must not do."""
    return [
        f"{match.group()}: {why}"
        for pattern, why in patterns.items()
        for match in re.finditer(pattern, text, re.MULTILINE)
    ]


def test_no_test_depends_on_chance_or_load() -> None:
    found = [
        f"{path.relative_to(TESTS)}, {each}"
        for path in sorted(TESTS.rglob("*.py"))
        if path.relative_to(TESTS).as_posix() not in HELPERS
        for each in faults(path.read_text("utf-8"))
    ]
    assert found == []


def test_no_step_depends_on_chance_or_load() -> None:
    found = {path.name: wrong_in_ci(path.read_text("utf-8"), WRONG_IN_CI) for path in CI.iterdir()}
    for name in ("run", "steps"):
        found[name] += wrong_in_ci((CI / name).read_text("utf-8"), WRONG_IN_RUN)
    assert not any(found.values()), found


@pytest.mark.parametrize(
    "text",
    [
        "import random\nrandom.SystemRandom()",
        "from random import SystemRandom\nSystemRandom()",
        "import secrets",
        "from secrets import randbelow",
        "import os\nos.urandom(4)",
        "import random\nrandom.random()",
        "import random\nsorted('ab', key=random.random)",
        "from random import choice\nchoice([1])",
        "import random\nrandom.Random()",
        "import random\nrandom.Random(None)",
        "import numpy as np\nnp.random.normal(3)",
        "import numpy as np\nnp.random.default_rng()",
        "from numpy.random import default_rng\ndefault_rng()",
        "import numpy as np\nnp.random.RandomState()",
        "words = ['" + MINUTES + "', '1']",
        "import time\ntime.sleep(0.1)",
        "import asyncio\nasync def f():\n    await asyncio.sleep(0.1)",
        "from time import sleep\nsleep(1)",
        "import time\nassert time.perf_counter() < 3.0",
        "import time as clock\nbegan = clock.process_time()",
        "from datetime import datetime\ndatetime.now()",
        "import subprocess\nsubprocess.run([], timeout=60)",
        "import subprocess\nSECONDS = 2 * 60\nsubprocess.run([], timeout=SECONDS)",
        "def f(process, most: float = 10.0):\n    process.wait(most)",
        "def f(process, *, most=10.0):\n    process.wait(most)",
        "TRIES, WAIT = 3, 5.0\nthread.join(WAIT)",
        "event.wait(10)",
        "queue.get(timeout=1.0)",
        "connection.poll(30.0)",
        "future.result(5)",
        "from tests.waiting import BETWEEN\nevent.wait(BETWEEN)",
        "from tests.waiting import BETWEEN as SOON\nevent.wait(2.0 * SOON)",
        "import threading\nthreading.Timer(60.0, print).start()",
        "import signal\nsignal.setitimer(signal.ITIMER_REAL, 5.0)",
        "from hypothesis import settings\nsettings(deadline=200)",
        "CODE = '''\nimport time\ntime.sleep(3)\n'''",
    ],
)
def test_what_depends_on_chance_or_load_is_found(text: str) -> None:
    (fault,) = {each.partition(": ")[2] for each in faults(text)}
    assert fault


@pytest.mark.parametrize(
    "text",
    [
        "import random\nrandom.Random(7).random()",
        "from random import Random\ndef f(dice: Random) -> float:\n    return dice.random()",
        "import numpy as np\nrandom = np.random.default_rng(3)\nrandom.normal(size=3)",
        "import numpy as np\ndef f(random: np.random.Generator):\n    return random.normal()",
        "import numpy as np\nnp.random.default_rng([seed, 1])",
        "import time\nmonkeypatch.setattr(time, 'perf_counter', lambda: 0.0)",
        "monkeypatch.setattr('camgeo.app.cli.watch.time.sleep', steps)",
        "import subprocess\nsubprocess.run([])",
        "import subprocess\nsubprocess.run([], timeout=600)",
        "from tests.waiting import PATIENCE\nprocess.wait(PATIENCE)",
        "from tests.waiting import PATIENCE\npage.wait_for_function('', timeout=1e3 * PATIENCE)",
        "thread.join()",
        "', '.join(names)",
        "NAMES = ('a', 'b')\n', '.join(NAMES)",
        "tables.get(3.0, None)",
        "process.poll()",
        "from hypothesis import settings\nsettings(deadline=None)",
        "import signal\nsignal.setitimer(signal.ITIMER_PROF, 5.0)",
        "CODE = '''\nimport os\nprint(os.getpid())\n'''",
        "TEXT = '''\nimport of a scene from a file\n'''",
    ],
)
def test_what_depends_on_neither_is_none(text: str) -> None:
    assert faults(text) == []


def test_steps_that_depend_on_chance_or_load_are_found() -> None:
    for line in (f'step "fuzz" python -m tests.fuzz {MINUTES} 1', "sleep 3", "x=$RANDOM",
                 "timeout 60 make", "shuf -n 1 names"):  # fmt: skip
        assert wrong_in_ci(f"# a comment\n{line}\n", WRONG_IN_CI), line
    assert wrong_in_ci("step fuzz python -m tests.fuzz --seed fresh", WRONG_IN_RUN)
    assert not wrong_in_ci("began=$SECONDS # no time is slept\n", {**WRONG_IN_CI, **WRONG_IN_RUN})


# The helpers themselves ---------------------------------------------------------------------------


def test_what_comes_is_waited_for() -> None:
    looks = iter([0, "", None, "there"])
    assert waiting.until("a text", lambda: next(looks)) == "there"
    event = threading.Event()
    thread = threading.Thread(target=event.set)
    thread.start()
    waiting.happened("the event", event)
    waiting.joined(thread)


def test_what_never_comes_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(waiting, "PATIENCE", 0.0)
    with pytest.raises(AssertionError, match="the moon: has not come"):
        waiting.until("the moon", lambda: False)
    never = threading.Event()
    with pytest.raises(AssertionError, match="the sun: has not come"):
        waiting.happened("the sun", never)
    thread = threading.Thread(target=never.wait, name="a star")
    thread.start()
    with pytest.raises(AssertionError, match="a star: does not end"):
        waiting.joined(thread)
    never.set()


def test_a_second_of_computing_is_measured_once(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = iter([0.3, 0.1, 0.2])
    monkeypatch.delenv(speed.KEPT, raising=False)
    monkeypatch.setattr(speed, "_started", lambda: next(runs))
    assert speed.cpu_second() == speed.cpu_second() == pytest.approx(0.5)
    ticks = iter([10.0, 12.0])
    monkeypatch.setattr(speed, "cpu", lambda: next(ticks))
    with speed.spending() as spent:
        pass
    assert spent.seconds == pytest.approx(4.0)


def test_a_start_of_an_interpreter_takes_processor_time() -> None:
    assert speed._started() > 0.0


DRAWN: Final = """
import tests.conftest{more}
from hypothesis import given, settings, strategies as st
@settings(max_examples=100, database=None)
@given(st.floats(), st.integers(), st.text())
def show(number, count, text):
    print(number, count, ascii(text))
show()
"""


def test_examples_do_not_depend_on_what_is_imported() -> None:
    """Of a program's own modules hypothesis draws constants, unless it is kept from it."""
    found = {
        subprocess.run(
            [sys.executable, "-c", DRAWN.format(more=more)],
            cwd=TESTS.parent,
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for more in ("", ", camgeo.kinematics.plan, camgeo.numeric.extremes, camgeo.scene.schema")
    }
    assert len(found) == 1
