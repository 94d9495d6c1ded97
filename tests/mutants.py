"""Random changes of the product, each of which the tests should notice.

    python -m tests.mutants [--under camgeo/geometry/outline] [--count N] [--seed S] [--rows FILE]

Each mutant is one changed statement in a copy of the tree. The test modules of the mirror folder
run first, those that import the changed module before the others, then the test modules elsewhere
that import it or a module that does; then those that import it through others, first of the same
room, then of kept results; the first failure ends the run. A mutant that no test fails
for, or that uses up its CPU time, has survived. Prints the share that was caught, by room, and one
line for each survivor. With `--rows` results are kept in a file, and a second call goes on there.

Statements are drawn with equal probability, then one of the changes that are possible in it: so a
table of numbers weighs no more than a line of logic. Texts, annotations and imports stay as they
are. Kept tools were tried: none has all these changes, or draws a sample without running all tests
on all of the code first.
"""

from __future__ import annotations

import argparse
import ast
import copy
import functools
import json
import math
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from typing import Final, cast

import pytest

from tests.quick import EXPENSIVE
from tests.seeds import add_commit_seed
from tests.speed import cpu_second

ROOT: Final = Path(__file__).resolve().parents[1]

ROOMS: Final = {
    **{
        room: (f"camgeo/{room}",)
        for room in (
            "numeric", "kinematics", "geometry", "cam", "check", "part", "dynamics", "milling",
            "scene", "design", "studies", "pictures", "app",
        )
    },
    "export": ("export/camgeo_export",),
}  # fmt: skip
"""The parts of the product that are measured one by one."""

FOLDERS: Final = {
    "kinematics": "motion", "geometry": "curve", "dynamics": "effects", "milling": "toolpath",
    "design": "product", "pictures": "figure", "app": "cli",
}  # fmt: skip
"""The folder of tests of a room that has not its name."""

CPU: Final = 300
"""Computing of the tests of one mutant, in the seconds of `tests.speed`."""

WAIT: Final = 1200
"""Time [s] after which they do nothing any more: something waits for what never comes."""

FIRST: Final = 4
"""Test modules of the first process that runs them, the next one takes twice as many: most mutants
are caught by the first few, and to import all takes long."""

KEPT: Final = "as_kept("
"""Tests of these names compare whole results of commands, files and pages: they pass through all
modules, which they do not import.
"""

MOST_CODE: Final = max(pytest.ExitCode)
"""Exit codes beyond this one are not pytest's."""

COMPARISONS: Final[dict[type[ast.cmpop], tuple[type[ast.cmpop], ...]]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}

ARITHMETIC: Final[dict[type[ast.operator], type[ast.operator]]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Div,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
}

SYMMETRIC: Final = {"min", "max", "minimum", "maximum", "hypot", "logical_and", "logical_or"}
"""Functions whose arguments may change places."""

DROPPED: Final = (ast.AugAssign, ast.Raise, ast.Continue, ast.Break, ast.Delete)
"""Statements that are dropped; so are calls, and assignments to a part of a value."""

Change = tuple[str, Callable[[], ast.AST]]
"""Its kind, and what makes the node that stands instead."""


def other(node: ast.AST, **fields: object) -> Callable[[], ast.AST]:
    """Makes a copy of `node` with other `fields`."""

    def made() -> ast.AST:
        new = copy.copy(node)
        for name, value in fields.items():
            setattr(new, name, value)
        return new

    return made


def changes(node: ast.AST) -> Iterator[Change]:
    """Each change of a single node."""
    match node:
        case ast.Compare(ops=ops):
            for number, operator in enumerate(ops):
                for instead in COMPARISONS[type(operator)]:
                    yield (
                        "comparison",
                        other(node, ops=[*ops[:number], instead(), *ops[number + 1 :]]),
                    )
        case ast.BinOp(op=op) | ast.AugAssign(op=op) if type(op) in ARITHMETIC:
            yield "arithmetic", other(node, op=ARITHMETIC[type(op)]())
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            yield "sign", lambda: operand
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            yield "not", lambda: operand
        case ast.BoolOp(op=op):
            yield "and, or", other(node, op=ast.Or() if isinstance(op, ast.And) else ast.And())
        case ast.If(test=test) | ast.IfExp(test=test) | ast.While(test=test):
            yield "condition", other(node, test=ast.UnaryOp(ast.Not(), test))
        case ast.Constant(value=bool() as truth):
            yield "constant", other(node, value=not truth)
        case ast.Constant(value=int() | float() as number):
            yield "constant", other(node, value=number + 1)
            if isinstance(number, float) and number:
                yield "constant", other(node, value=2.0 * number)
        case ast.Subscript(slice=ast.Constant(value=int() as place)):
            yield "index", other(node, slice=ast.Constant(place + 1 if place >= 0 else place - 1))
        case ast.Call(func=called, args=[first, second, *others]) if not (
            isinstance(first, ast.Starred)
            or isinstance(second, ast.Starred)
            or ast.unparse(called).rpartition(".")[2] in SYMMETRIC
            or ast.dump(first) == ast.dump(second)
        ):
            yield "arguments", other(node, args=[second, first, *others])
    if dispensable(node):
        yield "dropped", ast.Pass


def dispensable(node: ast.AST) -> bool:
    """Whether a statement can go and leave a program."""
    part = (ast.Attribute, ast.Subscript)
    return (
        isinstance(node, DROPPED)
        or (isinstance(node, ast.Expr) and isinstance(node.value, ast.Call))
        or (isinstance(node, ast.Assign) and all(isinstance(each, part) for each in node.targets))
    )


def statements(tree: ast.AST) -> Iterator[list[tuple[ast.AST, str, int]]]:
    """The changes of each statement, of a compound one without its body: the parent of the node
    that changes, the field that it is in, and its place there (-1 where it is not in a list).
    """
    for parent in ast.walk(tree):
        for name, value in ast.iter_fields(parent):
            for place, node in enumerate(value if isinstance(value, list) else [value]):
                if isinstance(node, ast.stmt) and not for_types(node):
                    yield list(nodes(parent, name, place if isinstance(value, list) else -1))


def for_types(node: ast.stmt) -> bool:
    """Whether a statement asks whether types are being checked, or names a type."""
    if isinstance(node, ast.Assign):
        return ast.unparse(node.value).startswith("TypeVar(")
    return isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"


def nodes(parent: ast.AST, name: str, place: int) -> Iterator[tuple[ast.AST, str, int]]:
    """The node at this place and those in it, without statements, texts and annotations."""
    node = at(parent, name, place)
    if isinstance(node, (ast.Import, ast.ImportFrom, ast.JoinedStr)):
        return
    yield parent, name, place
    for inner, value in ast.iter_fields(node):
        if inner in ("annotation", "returns", "decorator_list", "type_params"):
            continue
        for number, each in enumerate(value if isinstance(value, list) else [value]):
            if isinstance(each, ast.AST) and not isinstance(
                each, (ast.stmt, ast.excepthandler, ast.match_case)
            ):
                yield from nodes(node, inner, number if isinstance(value, list) else -1)


def at(parent: ast.AST, name: str, place: int) -> ast.AST:
    """The node in a field of its parent."""
    value = getattr(parent, name)
    return cast("ast.AST", value if place < 0 else value[place])


@dataclass(frozen=True, slots=True)
class Mutant:
    """A changed module.

    Attributes
    ----------
    path : of the module, below the root.
    line : where it differs.
    text : what it is, in a line.
    source : the module as changed.
    """

    path: str
    line: int
    text: str
    source: str


@functools.cache
def places(path: Path) -> list[list[tuple[int, str, int, int]]]:
    """Of each statement of a module that can change, what `mutant` needs: the number of the parent
    in the order of `ast.walk`, field, place, and number of the change.
    """
    tree = ast.parse(path.read_text("utf-8"))
    order = {id(node): number for number, node in enumerate(ast.walk(tree))}
    found = [
        [
            (order[id(parent)], name, place, number)
            for parent, name, place in each
            for number, _ in enumerate(changes(at(parent, name, place)))
        ]
        for each in statements(tree)
    ]
    return [each for each in found if each]


def mutant(path: Path, parent: int, name: str, place: int, number: int) -> Mutant:
    """The module at `path` with the change that `places` names."""
    tree = ast.parse(path.read_text("utf-8"))
    holder = list(ast.walk(tree))[parent]
    node = at(holder, name, place)
    kind, change = list(changes(node))[number]
    new = ast.copy_location(change(), node)
    before, after = ((ast.unparse(each).splitlines() or [""])[0] for each in (node, new))
    if place < 0:
        setattr(holder, name, new)
    else:
        getattr(holder, name)[place] = new
    source = ast.unparse(ast.fix_missing_locations(tree))
    line: int = getattr(node, "lineno", 0)
    return Mutant(
        path.relative_to(ROOT).as_posix(), line, f"{kind}: {before} -> {after}", source + "\n"
    )


def room_of(path: Path) -> str | None:
    """The room of a module: that of the longest folder that it is in."""
    own = path.relative_to(ROOT).as_posix()
    found = [
        (len(folder), room)
        for room, folders in ROOMS.items()
        for folder in folders
        if own == folder or own.startswith(f"{folder}/")
    ]
    return max(found)[1] if found else None


def drawn(modules: Sequence[Path], count: int, source: random.Random) -> list[Mutant]:
    """Random mutants, each of another statement."""
    every = [(path, each) for path in modules for each in places(path)]
    chosen = source.sample(every, min(count, len(every)))
    return [mutant(path, *source.choice(each)) for path, each in chosen]


@functools.cache
def imported(path: Path) -> frozenset[str]:
    """The modules that a module names in its imports, and the modules of names that it takes."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            found |= {each.name for each in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module, *(f"{node.module}.{each.name}" for each in node.names)}
    return frozenset(found)


def name_of(path: str) -> str:
    """The dotted name of the module at a path below the root."""
    return (
        path.removeprefix("export/").removesuffix(".py").removesuffix("/__init__").replace("/", ".")
    )


def importers_of(module: str) -> tuple[frozenset[str], frozenset[str]]:
    """The modules of the product that import a module, and those that do through others."""
    imports = {
        name_of(each.relative_to(ROOT).as_posix()): imported(each)
        for top in ("camgeo", "export")
        for each in (ROOT / top).rglob("*.py")
    }
    near = every = frozenset(each for each, names in imports.items() if module in names)
    reached: frozenset[str] = frozenset()
    while reached != every:
        reached = every
        every |= {each for each, names in imports.items() if not reached.isdisjoint(names)}
    return near, every


def modules_for(path: str) -> list[str]:
    """The test modules for a module of the product, in the order in which they run."""
    module = name_of(path)
    near, beyond = importers_of(module)
    words = module.split(".")[1:]
    folders = [FOLDERS.get(word, word) for word in (*reversed(words[:-1]), *words[-1:])]
    mirrors = (ROOT / "tests" / each for each in folders)
    mirror = next((each for each in mirrors if each.is_dir()), None)
    ranks: dict[Path, tuple[int, float]] = {}
    for each in sorted((ROOT / "tests").rglob("test_*.py")):
        own, names = each.relative_to(ROOT / "tests").as_posix(), imported(each)
        inside = (
            mirror in each.parents if mirror is not None
            else own.startswith((f"test_{words[0]}", f"export/test_{words[0]}"))
        )  # fmt: skip
        tiers = (
            inside and module in names, inside, module in names, not near.isdisjoint(names),
            own.partition("/")[0] in folders and not beyond.isdisjoint(names),
            KEPT in each.read_text("utf-8"), not beyond.isdisjoint(names),
        )  # fmt: skip
        if any(tiers):
            ranks[each] = (tiers.index(True), EXPENSIVE.get(own, 0.5))
    return [each.relative_to(ROOT).as_posix() for each in sorted(ranks, key=ranks.__getitem__)]


def verdict(tree: Path, changed: Mutant, number: int) -> str:
    """ "caught", "survived" or "timed out": a process of its own runs the tests in a copy of the
    tree, in which only the changed module differs.
    """
    path = tree / changed.path
    kept = path.read_bytes()
    path.write_text(changed.source, "utf-8")
    os.utime(path, (number, number))  # compiled modules are told apart by whole seconds and sizes
    modules, batch, left = modules_for(changed.path), FIRST, CPU * cpu_second()
    environment = os.environ | {"PYTHONPATH": os.pathsep.join((str(tree), str(tree / "export")))}
    try:
        while modules:
            words = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider",
                     "--hypothesis-profile=first"]  # fmt: skip
            child = subprocess.Popen(
                ["timeout", "-k", "5", str(WAIT), "prlimit", f"--cpu={math.ceil(left)}", *words,
                 *modules[:batch]],
                cwd=tree, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )  # fmt: skip
            _, status, used = os.wait4(child.pid, 0)
            left -= used.ru_utime + used.ru_stime
            child.returncode = os.waitstatus_to_exitcode(status)
            if left <= 0.0 or child.returncode < 0 or child.returncode > MOST_CODE:
                return "timed out"
            if child.returncode not in (0, pytest.ExitCode.NO_TESTS_COLLECTED):
                return "caught"
            modules, batch = modules[batch:], 2 * batch
    finally:
        path.write_bytes(kept)
    return "survived"


def copied(folder: Path) -> Path:
    """All files of the tree that git knows, or would add, in another folder."""
    names = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, check=True, capture_output=True, text=True,
    ).stdout  # fmt: skip
    for name in filter(None, names.split("\0")):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, folder / name)
    return folder


def call(words: Sequence[str] | None = None) -> argparse.Namespace:
    """What the words of a call ask for."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    parser.add_argument("--under", help="only modules of this folder or file; else all rooms")
    parser.add_argument("--count", type=int, default=15, help="mutants of each room; default 15")
    add_commit_seed(parser)
    parser.add_argument("--rows", type=Path, help="file of results, one a line, to go on with")
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    parser.add_argument("--least", type=float, default=0.0, metavar="PERCENT",
                        help="end with 1 if fewer are caught; some are equivalent")  # fmt: skip
    return parser.parse_args(words)


def main() -> int:
    """Draw mutants, run their tests and print what was caught."""
    given = call()
    modules = [each for top in ("camgeo", "export") for each in sorted((ROOT / top).rglob("*.py"))]
    rooms: dict[str, list[Path]] = {room: [] for room in ROOMS}
    for path in modules:
        if (room := room_of(path)) is not None:
            rooms[room].append(path)
    if given.under:
        under = ROOT / given.under
        rooms = {given.under: [each for each in modules if each == under or under in each.parents]}
    work = [
        (room, each)
        for room, paths in rooms.items()
        for each in drawn(paths, given.count, random.Random(f"{given.seed} {room}"))
    ]
    rows: dict[str, str] = {}
    if given.rows and given.rows.exists():
        rows = dict(json.loads(line) for line in given.rows.read_text("utf-8").splitlines())
    with tempfile.TemporaryDirectory() as place:
        trees: SimpleQueue[Path] = SimpleQueue()
        for number in range(given.processes):
            trees.put(copied(Path(place) / str(number)))

        def judged(number: int) -> tuple[str, Mutant, str]:
            room, each = work[number]
            key = json.dumps([given.seed, number, each.path, each.line, each.text])
            if key not in rows:
                tree = trees.get()
                rows[key] = verdict(tree, each, number)
                trees.put(tree)
                if given.rows:
                    with given.rows.open("a", encoding="utf-8") as file:
                        file.write(json.dumps([key, rows[key]]) + "\n")
            return room, each, rows[key]

        totals: dict[str, Counter[str]] = {room: Counter() for room in rooms}
        with ThreadPoolExecutor(given.processes) as pool:
            for room, each, found in pool.map(judged, range(len(work))):
                totals[room][found] += 1
                if found != "caught":
                    print(f"{room}: {each.path}:{each.line} {found}, {each.text}", flush=True)
    print(f"seed {given.seed:08x}; caught, of all, timed out")
    for room, total in totals.items():
        print(f"{room:12s} {total['caught']:4d} {total.total():4d} {total['timed out']:4d}")
    every = sum(totals.values(), Counter())
    share = every["caught"] / max(every.total(), 1)
    print(f"{every['caught']} of {every.total()}, {share:.0%}")
    return 1 if 100.0 * share < given.least else 0


if __name__ == "__main__":
    sys.exit(main())
