"""Grids whose number of points is fixed: each is a picture, or something proves what it misses.

A verdict that rests on a fixed number of places is wrong for the cam whose features are narrower
than its steps. So cells follow the borders of the motion, and are halved until a bound decides; a
fixed grid may only make a first guess. `CLOSED` says of each what closes it. `meshgrid` is not
asked for: what it spreads is made by one of the others.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.test_architecture import ROOT

KEPT = frozenset({"ceil", "float", "floor", "int", "len", "log2", "max", "min", "radians", "sqrt"})
"""Functions of constants that are constants."""


class _Constants:
    """Which expressions of a function have the same value in every call."""

    def __init__(self, function: ast.AST) -> None:
        self.given: dict[str, list[ast.expr | None]] = {}
        for node in ast.walk(function):
            match node:
                case ast.arguments():
                    self._take_arguments(node)
                case ast.Assign(targets=targets, value=value):
                    for target in targets:
                        self._take(target, value)
                case ast.AnnAssign(target=target, value=value):
                    self._take(target, value)
                case ast.AugAssign(target=target) | ast.For(target=target):
                    self._take(target, None)
                case ast.comprehension(target=target) | ast.NamedExpr(target=target):
                    self._take(target, None)

    def _take_arguments(self, arguments: ast.arguments) -> None:
        places = [*arguments.posonlyargs, *arguments.args]
        defaults = [None] * (len(places) - len(arguments.defaults)) + list(arguments.defaults)
        for each, default in zip(
            [*places, *arguments.kwonlyargs], [*defaults, *arguments.kw_defaults], strict=True
        ):
            self.given.setdefault(each.arg, []).append(default)

    def _take(self, target: ast.expr, value: ast.expr | None) -> None:
        match target, value:
            case ast.Name(id=name), _:
                self.given.setdefault(name, []).append(value)
            case ast.Tuple(elts=targets), ast.Tuple(elts=values) if len(targets) == len(values):
                for each, own in zip(targets, values, strict=True):
                    self._take(each, own)
            case ast.Tuple(elts=targets), _:
                for each in targets:
                    self._take(each, None)

    def has(self, node: ast.expr | None, depth: int = 0) -> bool:
        """Whether `node` is a constant: made of numbers, names in capitals and what is set once, or
        is by default, to such.
        """
        if depth > 8:
            return False
        match node:
            case ast.Constant():
                return True
            case ast.Attribute(value=value, attr=attr):
                return attr in {"pi", "tau"} or (attr.isupper() and isinstance(value, ast.Name))
            case ast.Name(id=name):
                own = self.given.get(name, ())
                return name.isupper() if not own else len(own) == 1 and self.has(own[0], depth + 1)
            case ast.UnaryOp(operand=operand):
                return self.has(operand, depth)
            case ast.BinOp(left=left, right=right):
                return self.has(left, depth) and self.has(right, depth)
            case ast.Call(func=function, args=args, keywords=[]):
                return name_of(function) in KEPT and all(self.has(each, depth) for each in args)
        return False


def name_of(function: ast.expr) -> str:
    match function:
        case ast.Attribute(attr=name) | ast.Name(id=name):
            return name
    return ""


MAKERS = frozenset({"arange", "geomspace", "linspace", "logspace"})

DEFAULT = ast.Constant(50)
"""Places that `linspace` makes unless told otherwise."""

FEW = 8
"""Numbers up to which `arange` of literals counts powers or columns, not places."""


def is_constant_grid(call: ast.Call, constants: _Constants) -> bool:
    """Whether the call of a maker makes the same number of points whatever it is for."""
    if name_of(call.func) == "arange":
        numbers = [each.value for each in call.args if isinstance(each, ast.Constant)]
        few = len(numbers) == len(call.args) and all(float(str(each)) <= FEW for each in numbers)
        return not few and all(constants.has(each) for each in call.args)
    named = {each.arg: each.value for each in call.keywords}
    return constants.has(call.args[2] if len(call.args) > 2 else named.get("num", DEFAULT))


def constant_grids(source: str) -> Iterator[str]:
    """The text of each call that makes a fixed number of places."""
    yield from _grids_in(ast.parse(source), _Constants(ast.Module([], [])))


def _grids_in(node: ast.AST, constants: _Constants) -> Iterator[str]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef):
            yield from _grids_in(child, _Constants(child))
            continue
        if isinstance(child, ast.Call) and name_of(child.func) in MAKERS:
            if is_constant_grid(child, constants):
                yield ast.unparse(child)
        elif isinstance(child, ast.Attribute) and child.attr in {"mgrid", "ogrid"}:
            yield ast.unparse(node)
        yield from _grids_in(child, constants)


PICTURES = "camgeo/pictures/"
"""The folder of what only shows, but for"""

SHEETS = "camgeo/pictures/sheet/"
"""drawings, from which parts are made."""

NODES = "nodes, coefficients or harmonics, not places on a cam"

SEARCH = "zooms in on a size; `size` then judges the cam that it offers, as `check` does"

VERTICES = "places joints; the proof of the fit bounds the deviation"

BRACKET = "sections of a bracket, cut until they are rounding"

PICTURE = "a picture"

CLOSED: dict[str, dict[str, str]] = {
    "camgeo/studies/accuracy/survey.py": {
        "np.arange(ANGLES, dtype=np.float64)": (
            "compares figures with their stated errors, for docs/accuracy.md; decides nothing"
        ),
    },
    "camgeo/studies/accuracy/benefit.py": {
        "np.arange(1, most + 1)": NODES,
    },
    "camgeo/check/sizing/rounding.py": {
        "np.geomspace(low, high, ARMS)": SEARCH,
        "np.linspace(-1.0, 1.0, WAYS)": SEARCH,
    },
    "camgeo/check/sizing/task.py": {
        "np.linspace(0.0, TURN, AROUND, endpoint=False)": SEARCH,
        "np.linspace(-1.0, 1.0, 2 * GRID - 1)": SEARCH,
    },
    "camgeo/check/sizing/smallest.py": {
        "np.geomspace(least, reach, RADII)": SEARCH,
        "np.linspace(1.0 - BELOW * share, 1.0 + ABOVE * share, 46)": SEARCH,
        "np.arange(DIRECTIONS)": SEARCH,
        "np.linspace(-1.0, 1.0, 33)": SEARCH,
        "np.linspace(0.0, 1.0, ANGLES)": SEARCH,
        "np.linspace(1e-09, 1.0 - 1e-09, SAMPLES)": SEARCH,
        "np.arange(1.0, SECTIONS)": BRACKET,
    },
    "camgeo/geometry/contour/arcs.py": {
        "np.arange(PARTS + 1)": VERTICES,
        "np.arange(PARTS)": VERTICES,
        "np.arange(1, PARTS)": VERTICES,
        "np.linspace(0.0, 1.0, PARTS + 1)": VERTICES,
    },
    "camgeo/geometry/contour/chords.py": {
        "np.arange(PARTS)": VERTICES,
    },
    "camgeo/geometry/contour/fewest_chords.py": {
        "np.linspace(piece.start, piece.end, 257)": (
            "refuses early; the outline has cut off what runs back, and the fit is proved"
        ),
        "np.arange(CELLS)": VERTICES,
        "np.linspace(-1.0, 1.0, 2 * NEAR + 1)": VERTICES,
    },
    "camgeo/geometry/contour/cubics.py": {
        "np.arange(CELLS + 1)": VERTICES,
        "np.arange(ORDER)": NODES,
    },
    "camgeo/studies/accuracy/contours.py": {
        "np.linspace(piece.start, piece.end, CELLS + 1)": (
            "sums an estimate that is shown beside the pieces of a fit; decides nothing"
        ),
    },
    "camgeo/geometry/outline/roller.py": {
        "np.linspace(0.0, 1.0, LOOKS)": (
            "cubics of camgeo's own fits, of which each turns by little; others are not replayed"
        ),
    },
    "camgeo/geometry/pieces.py": {
        "np.linspace(0.0, TURN, int(np.ceil(TURN / WIDEST)) + 1)": (
            "first cells, cut at the borders of the motion, that are halved until a bound decides"
        ),
    },
    "camgeo/app/designing/edits.py": {
        "np.linspace(0.0, TURN, SAMPLES, endpoint=False)": (
            "a first diameter of a blank in a field; `Given.new_faults` judges it, with room left"
        ),
    },
    "camgeo/app/designing/work.py": {
        "np.linspace(start, end if end > start else end + TURN, RANGE)": PICTURE,
    },
    "camgeo/dynamics/effects/graph.py": {
        "np.arange(ANGLES, dtype=np.float64)": (
            "how far columns move with what others find; the extremes in the findings of the same"
            " unit are compared besides, and the largest difference counts for all"
        ),
    },
    "camgeo/dynamics/effects/lift_off/flight.py": {
        "np.linspace(0.0, 1.0, 65)": "probes; a bound of the second derivative halves between them",
        "np.linspace(0.0, 1.0, 9)": "the same, between two probes",
        "np.geomspace(1e-09, 1.0, 128)": "the same, behind a start with a speed",
    },
    "camgeo/dynamics/effects/shaft.py": {
        "np.arange(TIMES)": NODES,
        "np.arange(1, NODES)": NODES,
    },
    "camgeo/dynamics/effects/speed_fluctuation.py": {
        "np.linspace(0.0, 2.0 * top, GUESSES)": (
            "a speed to begin with; the steady state is solved to its tolerance from it, or marched"
        ),
    },
    "camgeo/dynamics/effects/feedback.py": {
        "np.arange(ANGLES, dtype=np.float64)": "Newton steps; the rounds go on until they settle",
        "np.arange(ANGLES)": "the same",
    },
    "camgeo/studies/inspection.py": {
        "np.linspace(-math.pi, math.pi, STARTS, endpoint=False)": (
            "turns to begin with, and their spacing bounds what lies between; then least squares"
        ),
        "np.arange(SAMPLES)": PICTURE,
    },
    "camgeo/kinematics/planning/build.py": {
        "np.geomspace(1.0, sharper / gentler, TRIED)": (
            "any turn of them is an answer; the motion that is made with it is judged"
        ),
    },
    "camgeo/numeric/extremes.py": {
        "np.arange(1.0, SECTIONS)": BRACKET,
        "np.linspace(0.0, 1.0, 9)": (
            "places in one cell of a grid, of which the cells are made finer until differences of"
            " the values show that nothing is left in them"
        ),
        "np.arange(PLACES)": NODES,
        "np.linspace(0.0, 1.0, PLACES)": (
            "nodes of the polynomial in one cell, which is halved until that decides, with its"
            " error to spare"
        ),
    },
    "camgeo/dynamics/oscillator/train.py": {
        "np.arange(POINTS)": NODES,
    },
    "camgeo/dynamics/oscillator/steady.py": {
        "np.arange(DEGREE + 1)": NODES,
        "np.linspace(-1.0, 1.0, 4 * len(NODES))": (
            "the variation of one polynomial between two borders, four places for each of its nodes"
        ),
    },
    "camgeo/geometry/outline/face.py": {
        "np.arange(0.0, TURN, WIDEST)": "first cells; the circles over each are compared exactly",
    },
    "camgeo/geometry/outline/outline.py": {
        "np.linspace(*ends, PLACES_NEAR + 2, axis=1)": (
            "extremes in a cell that shows some to be missing; `sure_bends` looks until none does"
        ),
        "np.linspace(*second, SAMPLES)": (
            "where Newton's method fails; the bridge that it then finds is exact, or it is refused"
        ),
        "np.linspace(*first, SAMPLES)": "the same",
        "np.linspace(low, high, SAMPLES)": "the same",
    },
    "camgeo/geometry/outline/replay.py": {
        "np.arange(count, dtype=np.float64)": PICTURE,
    },
    "camgeo/geometry/outline/envelope.py": {
        "np.arange(SAMPLES)": (
            "a run of cells that provably turns by less than a right angle, with four borders at"
            " most in it; other tails are left to the search by boxes"
        ),
        "np.linspace(0.0, 1.0, SAMPLES)": "the same",
    },
    "camgeo/design/pictured.py": {
        "np.linspace(first, last, SAMPLES)": PICTURE,
    },
    "camgeo/pictures/sheet/texts.py": {
        "np.linspace(0.0, TURN, SAMPLES)": PICTURE,
    },
    "camgeo/pictures/sheet/section.py": {
        "np.arange(ALONG + 1)": PICTURE,
    },
    "camgeo/studies/tolerancing/linear.py": {
        "np.linspace(0.0, TURN, ANGLES + 1)": (
            "shares and remainders, which are told as those of the angles of the analysis; extremes"
            " are sought between the borders"
        ),
    },
    "camgeo/milling/track.py": {
        "np.linspace(low, high, STEPS + 1)": (
            "a bracket of a turn; `least_distance` then decides whether the lead is clear"
        ),
    },
    "camgeo/milling/clear.py": {
        "np.linspace(0.0, 2.0 * np.pi, PER_TURN, endpoint=False)": (
            "paces a spiral; `require_clear` proves that it leaves the part alone"
        ),
    },
    "camgeo/milling/simulation.py": {
        "np.arange(1, SLICES + 1)": (
            "slabs of a point or of rounded corners; gouge and rest are told of a slab's middle"
        ),
    },
    "camgeo/milling/strategies.py": {
        "np.linspace(-np.pi, 0.0, PLACES)": (
            "paces loops, `ROUNDING` below the limit: more than a top between two places can hide"
        ),
    },
}
"""By module, each call and what closes it."""


def grids_of(folder: Path) -> dict[str, set[str]]:
    """By module, the calls that make a fixed number of places."""
    found: dict[str, set[str]] = {}
    for path in sorted((folder / "camgeo").rglob("*.py")):
        name = path.relative_to(folder).as_posix()
        calls = set(constant_grids(path.read_text("utf-8")))
        if calls and (not name.startswith(PICTURES) or name.startswith(SHEETS)):
            found[name] = calls
    return found


def test_each_fixed_grid_is_closed_by_something() -> None:
    assert grids_of(ROOT) == {name: set(calls) for name, calls in CLOSED.items()}
    assert all(why for calls in CLOSED.values() for why in calls.values())


@pytest.mark.parametrize(
    "body",
    [
        "np.linspace(low, high, 257)",
        "np.linspace(low, high)",
        "np.linspace(low, high, num=2 * SAMPLES + 1, endpoint=False)",
        "np.geomspace(low, high, SAMPLES)",
        "np.linspace(low, high, size)",
        "np.arange(SAMPLES) * (high / SAMPLES)",
        "np.arange(0.0, math.tau, math.radians(0.5))",
        "np.arange(720)",
        "np.mgrid[0:1:65j]",
        "np.linspace(low, high, math.ceil(math.tau / step))",
    ],
)
def test_a_new_grid_is_found(body: str) -> None:
    source = f"def f(low, high, step=STEP):\n    size = SAMPLES\n    return {body}\n"
    assert len(list(constant_grids(source))) == 1


@pytest.mark.parametrize(
    "body",
    [
        "np.linspace(low, high, len(borders))",
        "np.linspace(low, high, count)",
        "np.linspace(low, high, SAMPLES * math.ceil(high))",
        "np.arange(len(low))",
        "np.arange(4.0)",
        "np.arange(low, high, STEP)",
    ],
)
def test_one_that_follows_what_it_is_for_is_none(body: str) -> None:
    source = f"def f(low, high, borders, count):\n    return {body}\n"
    assert list(constant_grids(source)) == []


def test_a_grid_that_nothing_closes_fails(tmp_path: Path) -> None:
    for name in ("check/new.py", "pictures/new.py"):
        path = tmp_path / "camgeo" / name
        path.parent.mkdir(parents=True)
        path.write_text("GRID = np.linspace(0.0, 1.0, 99)\n", "utf-8")
    assert grids_of(tmp_path) == {"camgeo/check/new.py": {"np.linspace(0.0, 1.0, 99)"}}
