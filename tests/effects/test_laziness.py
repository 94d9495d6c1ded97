"""What is not requested is neither computed nor imported, and changes no byte of the geometry."""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator
from importlib import import_module
from pathlib import Path

import pytest

from camgeo.design.design import Design
from camgeo.design.writing import CERTIFICATE, make_files
from camgeo.dynamics.effects.graph import FOUND_SUFFIX, node_name
from camgeo.dynamics.effects.registry import EFFECTS, find_effect
from camgeo.dynamics.effects.results import CAMSHAFT_WINDUP, FINDERS, VIBRATION
from tests.effects.scenes import SCENES, design
from tests.imported import imported_anew
from tests.long_form import LONG
from tests.waiting import PATIENCE

SCENE = "plate_translating"

COMPUTING = {find_effect(name).compute.partition(":")[0]: name for name in EFFECTS}
"""The effects by the modules that compute them."""

TABLES = {
    "kinematics": "",
    "inertia": "mass = 0.8",
    "gravity": "",
    "load": "constant = 20",
    "spring": (
        "preload = 80\n"
        "wire = { diameter = 2, coil_diameter = 20, active_coils = 5, free_length = 90 }"
    ),
    "spring-surge": "",
    "friction": "guide = 0.1",
    "contact-force": "",
    "reactions": "",
    "roller-spin": "moment_of_inertia = 1e-5\ntraction = 0.05",
    "lift-off": "",
    "drive-torque": "fluctuation = 0.05",
    "power-balance": "",
    "speed-fluctuation": "moment_of_inertia = 0.02\nno_load_speed = 66\nstall_torque = 40",
    "camshaft-windup": "stiffness = 2e4\nmoment_of_inertia = 0.01\ndamping = 0.05",
    "contact-pressure": "rating = 8000",
    "vibration": "natural_frequency = 60\ndamping = 0.05",
    "shock-spectrum": "",
    "balance": "",
}
"""A table for each effect; "spring" gives a force to those that need one of any origin."""

TOGETHER = tuple(name for name in EFFECTS if name != CAMSHAFT_WINDUP)
"""Those that one scene can name: its cam turns in one way."""


def with_data(*names: str) -> tuple[str, ...]:
    """`names`, and of the effects those that bring the data without which they cannot be."""
    found = dict.fromkeys(names)
    waiting = list(names)
    while waiting:
        effect = find_effect(waiting.pop())
        for needed in effect.needs:
            if find_effect(needed).tabled and needed not in found:
                found[needed] = None
            waiting.append(needed)
        for keys in effect.keys:
            tables = [key.removeprefix("effects.") for key in keys if key.startswith("effects.")]
            if tables and not found.keys() & set(tables):
                found["spring" if "spring" in tables else tables[0]] = None
                waiting.append("spring" if "spring" in tables else tables[0])
    return tuple(found)


def text_of(names: tuple[str, ...]) -> str:
    return "\n".join(f"[effects.{name}]\n{TABLES[name]}" for name in names)


def reached(names: Iterable[str], following: Callable[[str], Iterable[str]]) -> set[str]:
    """`names`, and all that follows from them step by step."""
    found, waiting = set(names), list(names)
    while waiting:
        further = {*following(waiting.pop())} - found
        found |= further
        waiting += further
    return found


def expected(names: tuple[str, ...]) -> set[str]:
    """All that is needed, directly or not, for the effects `names` of a scene that names them."""
    return reached(
        names, lambda each: (*find_effect(each).needs, *{*find_effect(each).uses} & {*names})
    )


SETS = [
    *((name,) for name in EFFECTS),
    *[each for each in itertools.combinations(EFFECTS, 2) if each != FINDERS],
]


def test_every_effect_has_a_table_here() -> None:
    assert tuple(TABLES) == EFFECTS


@pytest.mark.parametrize("names", SETS, ids="+".join)
@pytest.mark.usefixtures("no_effect_imported")
def test_only_what_is_needed_runs_and_once_and_is_imported(names: tuple[str, ...]) -> None:
    named = with_data(*names)
    found = design(SCENE, text_of(named))
    assert computing(sys.modules) == set()
    for name in names:
        found.effect(name)
    runs = [run.name for run in found.ledger.runs if run.name.startswith("effects.")]
    needed = reached(names, found.effects.inputs)
    assert sorted(runs) == sorted(nodes(found, names))
    assert needed <= expected(named)
    assert computing(sys.modules) == needed
    for name in named:
        found.effect(name)
    assert computing(sys.modules) == expected(named)


def nodes(of: Design, names: tuple[str, ...]) -> set[str]:
    """What the ledger has of the effects `names`: at the found speed those that depend on it, with
    their inputs that do, and all that it is found from in the state of the scene.
    """
    catalogue = of.effects.catalogue
    needed = {each for name in names for each in (name, *catalogue.dependencies(name))}
    finder = catalogue.finder
    if finder is None:
        return {node_name(name) for name in needed}
    asked = {*names} - {finder}
    needed = {each for name in asked for each in (name, *catalogue.dependencies(name))}
    moved = {name for name in needed if catalogue.depends_on_speed(name)}
    stated = needed - moved
    rounds = set()
    if moved or finder in names:
        stated |= {finder} | catalogue.rigid().dependencies(finder)
        if VIBRATION in of.scene.effects:  # whose train has no mass here, says round 1
            rounds = {f"{node_name(VIBRATION)} in round 1"}
    found = {node_name(name) + FOUND_SUFFIX for name in moved}
    return rounds | {node_name(name) for name in stated} | found


@pytest.fixture
def no_effect_imported() -> Iterator[None]:
    """As in a fresh interpreter: none that computes is in `sys.modules`; put back afterwards."""
    with imported_anew(COMPUTING.__contains__):
        yield


def test_what_was_imported_before_is_back_in_its_package() -> None:
    name = "camgeo.dynamics.effects.kinematics"
    before = import_module(name)
    with imported_anew(name.__eq__):
        assert import_module(name) is not before
    assert sys.modules[name] is before
    assert sys.modules[before.__package__ or ""].kinematics is before


def computing(modules: Iterable[str]) -> set[str]:
    """The effects among whose `modules` is the one that computes them."""
    return {COMPUTING[name] for name in modules if name in COMPUTING}


RUN = """
import json, sys
import camgeo
from camgeo.scene.scene import load_scene
design = camgeo.load(sys.argv[1])
if sys.argv[2:]:
    design.findings
    [design.effects.findings(name) for name in design.scene.effects]
json.dump(sorted(sys.modules), sys.stdout)
"""


def modules_of(effects: str, folder: Path, *judge: str) -> set[str]:
    """What a fresh interpreter has imported after loading a scene with effects, and optionally
    judging it.
    """
    scene = folder / "scene.toml"
    scene.write_text(f"{(SCENES / f'{SCENE}.toml').read_text('utf-8')}\n{effects}\n", "utf-8")
    done = subprocess.run(
        [sys.executable, "-c", RUN, str(scene), *judge],
        capture_output=True, text=True, check=True, timeout=PATIENCE,
    )  # fmt: skip
    return set(json.loads(done.stdout))


def test_a_scene_without_effects_imports_nothing_of_them(tmp_path: Path) -> None:
    loaded = modules_of("", tmp_path, "judge")
    assert not {name for name in loaded if name.startswith("camgeo.dynamics.effects")}
    assert not loaded & {"scipy", "shapely", "mpmath"}


def test_loading_a_scene_with_all_effects_imports_only_what_declares_them(tmp_path: Path) -> None:
    """The frame's own data, and what reads the tables, nothing else."""
    prefix = "camgeo.dynamics.effects."
    loaded = modules_of(text_of(TOGETHER), tmp_path)
    found = {each.removeprefix(prefix) for each in loaded if each.startswith(prefix)}
    assert found == {"effect", "registry", "results", "tables", "wording"}


def test_a_drawing_of_a_scene_with_all_effects_imports_none_that_computes(tmp_path: Path) -> None:
    code = (
        "import json, sys\nfrom camgeo.app.cli.main import main\n"
        "assert main(['build', *sys.argv[1:], '--only', 'dxf', '--json']) in (0, 1)\n"
        "print(json.dumps(sorted(sys.modules)))"
    )
    scene = SCENES.parent / "effects" / "press.toml"
    done = subprocess.run(
        [sys.executable, "-c", code, str(scene), "-o", str(tmp_path)],
        capture_output=True, text=True, check=True, timeout=PATIENCE,
    )  # fmt: skip
    assert (tmp_path / "press.dxf").exists()
    assert computing(json.loads(done.stdout.splitlines()[-1])) == set()


@pytest.mark.parametrize(
    "names", [("kinematics",), ("vibration",), ("lift-off",), TOGETHER], ids=len
)
def test_a_fresh_interpreter_imports_effects_and_their_needs(
    names: tuple[str, ...], tmp_path: Path
) -> None:
    """As above, where each effect alone and each two stand for all that they need; and no library
    that none of them needs.
    """
    named = with_data(*names)
    loaded = modules_of(text_of(named), tmp_path, "judge")
    assert computing(loaded) == expected(named)
    assert not loaded & {"ezdxf", "trimesh", "manifold3d", "matplotlib", "camgeo_export", "mpmath"}


def test_flights_and_trimmed_flanks_are_imported_where_there_are_some(tmp_path: Path) -> None:
    held = "[effects.inertia]\nmass = 0.1\n[effects.spring]\nstiffness = 4\npreload = 300\n"
    loaded = modules_of(f"{held}[effects.lift-off]", tmp_path, "judge")
    assert computing(loaded) >= {"lift-off", "spring"}
    flown = {"effects.lift_off.flight", "state.written"}
    assert not loaded & {f"camgeo.dynamics.{each}" for each in flown}


def geometry(effects: str) -> dict[str, bytes]:
    found = design(SCENE, effects)
    contents, _ = make_files(found.discs, ("dxf", "gcode", "stl", "3mf", "svg"), 0.01)
    assert not [run for run in found.ledger.runs if run.name.startswith("effects.")]
    return contents


@pytest.fixture(scope="module")
def bare() -> dict[str, bytes]:
    return geometry("")


# A change by any single effect would also show with all of them together.
@pytest.mark.parametrize("names", [TOGETHER, *((name,) for name in EFFECTS if LONG)], ids="+".join)
def test_effects_change_no_byte_of_the_geometry(
    names: tuple[str, ...], bare: dict[str, bytes]
) -> None:
    """Of the certificate neither, but that a density also gives the part its mass."""
    found = geometry(text_of(with_data(*names)))
    certificate = json.loads(found.pop(CERTIFICATE))
    findings = certificate["findings"]
    weighed = [each for each in findings if each["name"] == "mass"]
    assert len(weighed) == ("balance" in names)
    certificate["findings"] = [each for each in findings if each not in weighed]
    assert certificate == json.loads(bare[CERTIFICATE])
    assert found == {name: data for name, data in bare.items() if name != CERTIFICATE}
