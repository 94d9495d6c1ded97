"""The architecture: which module may import which. Held on camgeo, and the rules on themselves."""

from __future__ import annotations

import ast
import graphlib
import json
import re
import subprocess
import sys
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.waiting import PATIENCE

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = "camgeo"
WRITERS = "camgeo_export"

STAGES: tuple[tuple[str, ...], ...] = (
    ("_version", "errors", "units", "lazy", "record", "reading", "numeric"),
    ("kinematics",),
    ("kinematics.mechanism",),
    ("geometry",),
    ("geometry.outline", "geometry.contour"),
    ("cam",),
    ("check",),
    ("part",),
    ("dynamics.oscillator",),
    ("dynamics.state",),
    ("dynamics.effects",),
    ("milling",),
    ("scene.formats",),
    ("scene",),
    ("design",),
    ("studies.inspection",),
    ("studies.sweep",),
    ("studies.optimise",),
    ("studies.tolerancing",),
    ("studies.accuracy",),
    ("pictures.sheet",),
    ("pictures",),
    ("app.answers.answer",),
    ("app.cli.command",),
    ("app.answers",),
    ("app.designing",),
    ("app.cli",),
    ("__init__", "__main__"),
)
"""Every room of camgeo, lowest first, and the modules beside them. A module imports only from its
own row and from the rows before it; the longest name that fits is its row."""

EFFECTS = f"{PACKAGE}.dynamics.effects"

ENGINE_LIBRARIES = {"jsonschema_rs", "numpy", "shapely", "tomlkit"}
"""What the engine may import besides the standard library and itself."""

LAZY_LIBRARIES = {"scipy"}
"""What it may import inside a function only."""

FORMAT_LIBRARIES = {"ezdxf", "lxml", "manifold3d", "matplotlib", "networkx", "trimesh"}
"""What only writers import."""

LIBRARY_OF = {"camgeo.part.glyphs": "matplotlib", "camgeo.studies.sweep.cluster": "distributed"}
"""The library that one module may import inside a function only: matplotlib brings a font,
distributed a cluster."""

EFFECT_FRAME = {
    "", "bearing_friction", "contact", "effect", "feedback", "forces", "graph", "loads",
    "registry", "results", "shaft", "tables", "wording",
}  # fmt: skip
"""Modules of `effects` that are no effects, which nothing imports: their code is named as text."""


# -- the rules -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Import:
    """One import of the module `target`, `lazy` if it runs only when a function is called."""

    target: str
    line: int
    lazy: bool


def find_modules(root: Path) -> dict[str, Path]:
    """Dotted names of camgeo's modules and their files; a package goes by its own name."""
    found = {}
    for path in sorted((root / PACKAGE).rglob("*.py")):
        parts = path.relative_to(root).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def find_imports(path: Path, package: str, modules: Collection[str]) -> Iterator[Import]:
    """Imports anywhere in a file, those inside functions and for type checking among them.

    `package` is the dotted name of the package that the file is in, for relative imports.
    ``from a import b`` is an import of ``a.b`` if that is a module, else of ``a``.
    """

    text = path.read_text("utf-8")
    # An expression imports only where it calls what is named like this.
    called = "import_module" in text or "__import__" in text

    def visit(node: ast.AST, lazy: bool) -> Iterator[Import]:
        match node:
            case ast.Import():
                for alias in node.names:
                    yield Import(alias.name, node.lineno, lazy)
            case ast.ImportFrom():
                parents = package.split(".")
                above = parents[: len(parents) - node.level + 1] if node.level else []
                origin = ".".join([*above, node.module] if node.module else above)
                for alias in node.names:
                    name = f"{origin}.{alias.name}"
                    yield Import(name if name in modules else origin, node.lineno, lazy)
            case ast.Call(
                func=ast.Name("import_module" | "__import__") | ast.Attribute(attr="import_module"),
                args=[ast.Constant(str(name)), *_],
            ):
                yield Import(name, node.lineno, lazy)
        lazy = lazy or isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
        for child in ast.iter_child_nodes(node):
            if called or not isinstance(child, ast.expr):
                yield from visit(child, lazy)

    yield from visit(ast.parse(text, str(path)), lazy=False)


def stage_of(module: str) -> int | None:
    """Row of a module of camgeo in STAGES, None if it has none."""
    words = module.split(".")[1:] or ["__init__"]
    rows = {name: row for row, names in enumerate(STAGES) for name in names}
    fits = (".".join(words[:count]) for count in range(len(words), 0, -1))
    row = next((rows[each] for each in fits if each in rows), None)
    # The first page of a room whose stages are all below it imports nothing.
    below = [rows[name] for name in rows if name.startswith(f"{words[0]}.")]
    return min(below, default=None) if row is None and len(words) == 1 else row


def fault_of_library(module: str, imported: Import) -> str:
    """Fault of one module of camgeo importing something foreign, empty if there is none."""
    library = imported.target.split(".")[0]
    if library == WRITERS:
        return "imports the writers"
    own = LIBRARY_OF.get(module) == library
    if library in FORMAT_LIBRARIES and not own:
        return f"imports the format library {library}"
    if library in LAZY_LIBRARIES or own:
        return "" if imported.lazy else f"imports {library} outside a function"
    if library in ENGINE_LIBRARIES or library in sys.stdlib_module_names:
        return ""
    return f"imports {library}, which is no library of the engine"


def fault_of_module(module: str, imported: Import) -> str:
    """Fault of one module of camgeo importing another, empty if there is none."""
    own, other = stage_of(module), stage_of(imported.target)
    if own is not None and other is not None and other > own:
        return f"imports {imported.target}, a later stage"
    effect = effect_of(imported.target)
    if effect and effect != effect_of(module):
        return f"imports {imported.target}"
    return ""


def effect_of(module: str) -> str:
    """The effect that a module is or belongs to, empty if none: effects may be packages."""
    within = module.startswith(f"{EFFECTS}.")
    name = module.removeprefix(f"{EFFECTS}.").split(".")[0] if within else ""
    return "" if name in EFFECT_FRAME else name


def find_violations(root: Path) -> list[str]:
    """Every breach of the rules by the package camgeo in the folder `root`, a line each."""
    modules = find_modules(root)
    found = [f"{module}: has no stage" for module in modules if stage_of(module) is None]
    graph: dict[str, set[str]] = {}
    for module, path in modules.items():
        package = module if path.name == "__init__.py" else module.rpartition(".")[0]
        edges = graph.setdefault(module, set())
        for imported in sorted(
            set(find_imports(path, package, modules)), key=lambda each: (each.line, each.target)
        ):
            if imported.target.split(".")[0] == PACKAGE:
                edges.add(imported.target)
                fault = fault_of_module(module, imported)
            else:
                fault = fault_of_library(module, imported)
            if fault:
                found.append(f"{module}, line {imported.line}: {fault}")
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        found.append(f"import cycle: {' <- '.join(error.args[1])}")
    return found


# -- kinds answer for themselves -----------------------------------------------------------------

KIND_FLAGS = {"flat", "has_yoke", "is_flat", "rocks", "slides"}
"""Attributes that reveal the kind of a follower."""

KIND_WORDS = {
    "translating-roller", "oscillating-roller", "translating-flat", "oscillating-flat",
    "slider-crank", "four-bar", "inner", "outer", "groove", "slider", "lever", "crank", "guide",
    "pivot", "roller", "face", "rocker",
}  # fmt: skip
"""Names of followers, linkages, contacts and their parts."""

KIND_TEXT = re.compile(
    rf"""\b({"|".join(KIND_FLAGS)})\b|["']({"|".join(KIND_WORDS)})["']|{PACKAGE}\.kinematics\.mechanism"""
)
"""Stands in every text that has a question."""

NO_KIND = {"LinkedMotion"}
"""Classes of `mechanism` that are no kind: whether there is a linkage at all."""

MOST_KIND_QUESTIONS = 16
"""Places outside `mechanism` that ask what kind of follower, linkage or contact it is."""


def kind_questions(root: Path) -> list[str]:
    """Where the packages below `root` ask what kind a follower, linkage or contact is, a line each.

    Outside `mechanism`, whose rooms know their kinds. A question is a flag that is read, a class of
    `mechanism` in `isinstance`, in a cast or in a case, a comparison with a kind's name, and a
    choice by it from a dictionary that stands there.
    """
    found = []
    for top in (root / PACKAGE, root / "export" / WRITERS):
        for path in sorted(top.rglob("*.py")):
            place = path.relative_to(top.parent).with_suffix("")
            if place.parts[:3] == (PACKAGE, "kinematics", "mechanism"):
                continue
            text = path.read_text("utf-8")
            if not KIND_TEXT.search(text):
                continue
            tree = ast.parse(text, str(path))
            classes = mechanism_names(tree)
            nodes = (n for n in ast.walk(tree) if isinstance(n, ast.expr | ast.pattern))
            lines = (node.lineno for node in nodes if asks_kind(node, classes))
            found += [f"{'.'.join(place.parts)}, line {line}" for line in sorted(lines)]
    return found


def mechanism_names(tree: ast.AST) -> set[str]:
    """Classes that a module imports from `mechanism`."""
    return {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        and (node.module or "").startswith(f"{PACKAGE}.kinematics.mechanism")
        for alias in node.names
        if alias.name[:1].isupper() and alias.name not in NO_KIND
    }


def asks_kind(node: ast.AST, classes: set[str]) -> bool:
    """Whether a node of a syntax tree asks for a kind; `classes` are those of `mechanism`."""
    match node:
        case ast.Attribute(attr=name, ctx=ast.Load()):
            return name in KIND_FLAGS
        case ast.Call(func=ast.Name("isinstance" | "issubclass" | "cast")):
            return any(names_in(each) & classes for each in node.args)
        case ast.MatchClass(cls=ast.Name(name)):
            return name in classes
        case ast.MatchValue(value=value):
            return bool(words_in(value))
        case ast.Compare(ops=ops):
            asked = any(isinstance(op, ast.Eq | ast.NotEq | ast.In | ast.NotIn) for op in ops)
            return asked and any(words_in(each) for each in (node.left, *node.comparators))
        case ast.Subscript(value=ast.Dict(keys=keys)):
            return any(each is not None and words_in(each) for each in keys)
    return False


def names_in(node: ast.AST) -> set[str]:
    """Names and quoted names in an argument."""
    inside = list(ast.walk(node))
    quoted = {n.value for n in inside if isinstance(n, ast.Constant) and isinstance(n.value, str)}
    return {n.id for n in inside if isinstance(n, ast.Name)} | quoted


def words_in(node: ast.AST) -> set[str]:
    """Names of kinds in a text, or in a list of texts, that stands there."""
    parts = node.elts if isinstance(node, ast.Tuple | ast.List | ast.Set) else [node]
    return {
        part.value for part in parts if isinstance(part, ast.Constant) and part.value in KIND_WORDS
    }


# -- camgeo keeps them ---------------------------------------------------------------------------


def test_camgeo_keeps_the_rules() -> None:
    assert find_violations(ROOT) == []


def test_kinds_are_asked_for_no_more_often() -> None:
    assert len(kind_questions(ROOT)) <= MOST_KIND_QUESTIONS


def test_stages_are_named_once() -> None:
    names = [name for row in STAGES for name in row]
    assert len(names) == len(set(names))


def test_there_is_something_to_test() -> None:
    found = find_modules(ROOT)
    assert {"camgeo", "camgeo.errors", "camgeo.kinematics", "camgeo.design.design"} <= found.keys()


# -- what a run imports --------------------------------------------------------------------------

RUN = """
import json, runpy, sys
report, *arguments = sys.argv[1:]
code = 0
if arguments:
    sys.argv = ["camgeo", *arguments]
    try:
        runpy.run_module("camgeo", run_name="__main__")
    except SystemExit as end:
        code = end.code or 0
else:
    import camgeo
with open(report, "w") as file:
    json.dump({"code": code, "modules": sorted(sys.modules)}, file)
"""
"""Runs camgeo with the arguments, or only imports it; leaves exit code and modules in a file."""

SERVER_LIBRARIES = {"starlette", "uvicorn", "websockets"}
"""What only the designer's server imports."""

NOTEBOOK_LIBRARIES = {"IPython", "anywidget", "ipywidgets", "traitlets"}
"""What only notebooks import."""

UNASKED = (
    FORMAT_LIBRARIES
    | SERVER_LIBRARIES
    | NOTEBOOK_LIBRARIES
    | {"scipy", "shapely", "tomlkit", WRITERS}
)

FITS_OF_FILES = {"camgeo.geometry.contour.arcs", "camgeo.geometry.contour.fewest_chords"}
"""A check has the fast fit by chords alone."""


def run(root: Path, report: Path, *arguments: str) -> tuple[object, set[str]]:
    """Exit code of the camgeo in `root`, run in a fresh interpreter, and what it had imported:
    modules and the packages at their top.
    """
    done = subprocess.run(
        [sys.executable, "-c", RUN, str(report), *arguments],
        cwd=root,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
    )
    assert done.returncode == 0, done.stderr
    answer = json.loads(report.read_text("utf-8"))
    loaded = set(answer["modules"])
    return answer["code"], loaded | {name.split(".")[0] for name in loaded}


def test_importing_camgeo_imports_nothing_unasked(tmp_path: Path) -> None:
    _, loaded = run(ROOT, tmp_path / "report.json")
    assert PACKAGE in loaded
    assert loaded & UNASKED == set()


def test_check_imports_nothing_that_it_does_not_need(tmp_path: Path) -> None:
    scene = "fixtures/effects/conjugate_lever.toml"
    code, loaded = run(ROOT, tmp_path / "report.json", "check", scene)
    assert code in {0, 1}
    assert "numpy" in loaded
    # difflib finds what a misspelt key was meant to be.
    assert loaded & (UNASKED | FITS_OF_FILES | {"difflib"}) == set()


def test_a_check_with_machining_time_imports_no_writer(tmp_path: Path) -> None:
    """The program is planned, which fits its paths and tests its leads for gouges."""
    code, loaded = run(ROOT, tmp_path / "report.json", "check", "fixtures/scenes/setzhub.toml")
    assert code in {0, 1}
    assert loaded & (UNASKED - {"scipy", "shapely"}) == set()


def test_a_check_of_an_engraved_disc_imports_a_font_and_nothing_that_plots(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    text = (ROOT / "fixtures/scenes/querhub.toml").read_text("utf-8")
    text = text[: text.index("[[tool]]")]
    engraving = "[[part.engraving]]\nheight = 3\ndepth = 0.2\nradius = 20\n"
    scene.write_text(f"{text}\n{engraving}", "utf-8")
    code, loaded = run(ROOT, tmp_path / "report.json", "check", str(scene))
    assert code in {0, 1}
    assert loaded & UNASKED == {"matplotlib"}
    assert "matplotlib.ft2font" in loaded
    # What looks for fonts on the machine, and writes what it finds into the user's folder.
    assert "matplotlib.font_manager" not in loaded


def test_a_build_imports_no_library_of_verification(tmp_path: Path) -> None:
    scene, out = "fixtures/scenes/setzhub.toml", str(tmp_path / "out")
    words = ("build", scene, "-o", out, "--only", "dxf,gcode,stl,3mf,csv,asc")
    code, loaded = run(ROOT, tmp_path / "report.json", *words)
    assert code in {0, 1}
    assert loaded & FORMAT_LIBRARIES == {"ezdxf", "manifold3d"}


# -- the rules find violations ---------------------------------------------------------------------

SOUND = {
    "__init__.py": "from camgeo.design.design import Design\n",
    "__main__.py": "from camgeo.app.cli.main import main\n",
    "errors.py": "import math\n",
    "kinematics/__init__.py": "",
    "kinematics/plan.py": "import numpy as np\nfrom camgeo.errors import GeometryError\n",
    "dynamics/__init__.py": "",
    "dynamics/effects/__init__.py": "",
    "dynamics/effects/effect.py": "",
    "dynamics/effects/spring.py": "from camgeo.dynamics.effects.effect import Effect\n",
    "dynamics/effects/registry.py": "def load():\n    from camgeo.dynamics.effects import tables\n",
    "dynamics/effects/tables.py": "",
    "dynamics/effects/shake/__init__.py": "",
    "dynamics/effects/shake/modes.py": "",
    "dynamics/effects/shake/response.py": "from camgeo.dynamics.effects.shake.modes import mode\n",
    "design/__init__.py": "",
    "design/design.py": (
        "from camgeo.kinematics.plan import MotionPlan\n"
        "from camgeo.dynamics.effects.registry import load\n"
        "def solve():\n    from scipy.optimize import brentq\n"
    ),
    "app/__init__.py": "",
    "app/cli/__init__.py": "",
    "app/cli/main.py": "from camgeo.design.design import Design\n",
}


def package_tree(folder: Path, changes: dict[str, str]) -> Path:
    for name, text in (SOUND | changes).items():
        path = folder / PACKAGE / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8")
    return folder


def test_a_correct_tree_has_no_violation(tmp_path: Path) -> None:
    assert find_violations(package_tree(tmp_path, {})) == []


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        (
            "errors.py",
            "import camgeo.design.design",
            "errors, line 1: imports camgeo.design.design, a later",
        ),
        ("errors.py", "from camgeo import kinematics", "imports camgeo.kinematics, a later"),
        (
            "errors.py",
            "from .kinematics import plan",
            "imports camgeo.kinematics.plan, a later stage",
        ),
        (
            "kinematics/new.py",
            "from ..design.design import Design",
            "imports camgeo.design.design, a later stage",
        ),
        ("kinematics/new.py", "from .. import design", "imports camgeo.design, a later stage"),
        ("kinematics/new.py", "import camgeo", "imports camgeo, a later stage"),
        ("kinematics/new.py", "from camgeo import Design", "imports camgeo, a later stage"),
        (
            "kinematics/new.py",
            "def f():\n    import camgeo.app.cli.main",
            "line 2: imports camgeo.app.cli",
        ),
        (
            "kinematics/new.py",
            "class A:\n    def f(self):\n        import camgeo.app.cli",
            "line 3: impo",
        ),
        (
            "kinematics/new.py",
            "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import camgeo.design.design",
            "line 3: imports camgeo.design.design, a later stage",
        ),
        (
            "kinematics/new.py",
            "import importlib\nimportlib.import_module('camgeo.app.cli.main')",
            "line 2: imports camgeo.app.cli.main, a later stage",
        ),
        (
            "kinematics/new.py",
            "__import__('camgeo.app.cli')",
            "imports camgeo.app.cli, a later stage",
        ),
        ("app/cli/main.py", "import camgeo.__main__", "imports camgeo.__main__, a later stage"),
        ("extra.py", "", "camgeo.extra: has no stage"),
        ("extra/deep.py", "", "camgeo.extra.deep: has no stage"),
        (
            "kinematics/table.py",
            "def f():\n    from camgeo.kinematics import plan",
            "import cycle: camgeo.kinematics.plan",
        ),
        ("app/cli/dxf.py", "def f():\n    import ezdxf.math", "the format library ezdxf"),
        ("app/cli/plot.py", "from matplotlib import pyplot", "the format library matplotlib"),
        ("app/cli/solid.py", "import trimesh, manifold3d", "the format library manifold3d"),
        ("app/cli/solid.py", "import trimesh, manifold3d", "the format library trimesh"),
        ("app/cli/read.py", "import lxml.etree", "the format library lxml"),
        ("app/cli/read.py", "import networkx", "the format library networkx"),
        ("app/cli/serve.py", "import starlette", "imports starlette, which is no library"),
        ("app/cli/read.py", "import pandas", "imports pandas, which is no library of the engine"),
        ("part/glyphs.py", "import matplotlib", "imports matplotlib outside a function"),
        ("part/glyphs.py", "def f():\n    import ezdxf", "the format library ezdxf"),
        ("part/other.py", "def f():\n    import matplotlib", "the format library matplotlib"),
        ("kinematics/root.py", "from scipy.optimize import brentq", "scipy outside a function"),
        (
            "kinematics/root.py",
            "if 1:\n    import scipy",
            "line 2: imports scipy outside a function",
        ),
        ("kinematics/root.py", "class A:\n    import scipy", "scipy outside a function"),
        ("app/cli/build.py", "def f():\n    import camgeo_export.dxf", "imports the writers"),
        (
            "design/design.py",
            "from camgeo.dynamics.effects.spring import x",
            "imports camgeo.dynamics.effects.spring",
        ),
        (
            "design/design.py",
            "def f():\n    from camgeo.dynamics.effects import spring",
            "camgeo.dynamics.effects.spring",
        ),
        (
            "dynamics/effects/mass.py",
            "import camgeo.dynamics.effects.spring",
            "imports camgeo.dynamics.effects.spring",
        ),
        (
            "dynamics/effects/mass/a.py",
            "from camgeo.dynamics.effects import spring",
            "imports camgeo.dynamics.effects.spring",
        ),
        (
            "dynamics/effects/registry.py",
            "def f():\n    from camgeo.dynamics.effects import spring",
            "effects.spring",
        ),
    ],
)
def test_each_rule_finds_its_breach(tmp_path: Path, name: str, text: str, expected: str) -> None:
    changes = {name: text + "\n"}
    if "cycle" in expected:
        changes["kinematics/plan.py"] = "from camgeo.kinematics.table import read\n"
    found = find_violations(package_tree(tmp_path, changes))
    assert any(expected in line for line in found), found


@pytest.mark.parametrize(
    "question",
    [
        "return follower.is_flat",
        "return 'a' if spec.follower.rocks else 'b'",
        "return isinstance(follower, TranslatingRoller)",
        "return isinstance(follower, int | TranslatingRoller)",
        "return cast('TranslatingRoller', follower)",
        "return contact == 'inner'",
        "return contact in ('outer', 'groove')",
        "return 'groove' != contact",
        "return {'inner': -1, 'outer': 1}[contact]",
        "match follower:\n        case TranslatingRoller():\n            pass",
        "match contact:\n        case 'inner':\n            pass",
    ],
)
def test_each_question_for_a_kind_is_found(tmp_path: Path, question: str) -> None:
    head = "from camgeo.kinematics.mechanism.rollers import TranslatingRoller\n"
    text = f"{head}def f(follower, contact, spec):\n    {question}\n"
    tree = package_tree(tmp_path, {"kinematics/mechanism/own.py": text, "check/own.py": text})
    (line,) = kind_questions(tree)
    assert line.startswith("camgeo.check.own, line ")


@pytest.mark.parametrize(
    "answer",
    [
        "return follower.reach",
        "return isinstance(follower, int)",
        "return {'inner': -1, 'outer': 1}",
        "return 'inner'",
        "follower.rocks = True",
        "return [sign for name, sign in contact.sides]",
    ],
)
def test_an_answer_is_no_question(tmp_path: Path, answer: str) -> None:
    text = f"def f(follower, contact):\n    {answer}\n"
    assert kind_questions(package_tree(tmp_path, {"check/own.py": text})) == []


def test_what_a_run_imports_is_seen(tmp_path: Path) -> None:
    changes = {
        "__init__.py": "",
        "__main__.py": "from camgeo.app.cli.main import main\nraise SystemExit(main())\n",
        "app/cli/main.py": "def main():\n    import shapely\n    return 1\n",
    }
    tree = package_tree(tmp_path, changes)
    assert run(tree, tmp_path / "report.json")[1] & UNASKED == set()
    code, loaded = run(tree, tmp_path / "report.json", "check")
    assert code == 1
    assert loaded & UNASKED == {"shapely"}
