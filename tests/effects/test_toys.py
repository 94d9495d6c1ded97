"""A new effect, in another distribution or in camgeo itself, from scene to files."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from pathlib import Path
from typing import Any, Final

import pytest

from tests.copies import commands, copied, replaced, run_copy
from tests.effects.scenes import SCENES
from tests.waiting import PATIENCE

PARSER: Final = """
def parse(table):
    return table["gain"], table.get("gap", 0.0)
"""

DECLARATION: Final = """Effect(
    name="noise",
    title="noise of the follower",
    compute="MODULE:compute",
    schema={
        "description": "How loud the follower is.",
        "type": "object",
        "required": ["gain"],
        "additionalProperties": False,
        "properties": {
            "gain": {"description": "By force.", "type": "number", "minimum": 0, "x-unit": "N m"},
            "gap": {"description": "Play of the roller.", "$ref": "#/$defs/length"},
        },
    },
    parse=parse,
    rules=(Only(ONE_DISC),),
    needs=(CONTACT_FORCE,),
    keys=(("cam.speed",),),
)"""

IMPORTS: Final = """
from camgeo.dynamics.effects.effect import Effect, Only
from camgeo.dynamics.effects.registry import ONE_DISC
from camgeo.dynamics.effects.results import CONTACT_FORCE
"""

RESULT: Final = """
from dataclasses import dataclass

from camgeo.check.finding import Finding
from camgeo.dynamics.effects.effect import Column
from camgeo.dynamics.effects.results import CONTACT_FORCE


@dataclass(frozen=True)
class Noise:
    findings: tuple
    columns: tuple
    error: None = None


def compute(request):
    gain, gap = request.data
    force = request.results[CONTACT_FORCE]
    loudest = gain * force.extremes.magnitude + gap
    return Noise(
        (Finding("loudest", "ok", f"as loud as {loudest:g}", loudest),),
        (Column("noise", "N mm", lambda phi, side: gain * abs(force.normal(phi, side))),),
    )
"""

SPRING: Final = """
[effects.spring]
stiffness = 4
preload = 80
"""

NOISE: Final = f"{SPRING}\n[effects.noise]\ngain = 2\n"

GAIN: Final = 2000.0
"""Result of `NOISE`, in N mm."""


def distribution(folder: Path) -> Path:
    """A distribution of its own, as pip would unpack it into `folder`."""
    package = folder / "toy_noise"
    package.mkdir()
    declared = DECLARATION.replace("MODULE", "toy_noise.result")
    (package / "__init__.py").write_text(f"{IMPORTS}{PARSER}\nEFFECT = {declared}\n", "utf-8")
    (package / "result.py").write_text(RESULT, "utf-8")
    metadata = folder / "toy_noise-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: toy-noise\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text("[camgeo.effects]\nnoise = toy_noise:EFFECT\n")
    return folder


def tree(folder: Path) -> Path:
    """A copy of camgeo with the effect as one of its own: a module, and one of the registry."""
    effects = copied(folder) / "dynamics" / "effects"
    (effects / "noise.py").write_text(RESULT, "utf-8")
    declared = DECLARATION.replace("MODULE", "camgeo.dynamics.effects.noise")
    replaced(
        effects / "registry.py",
        *(
            (line, f"{new}\n{line}")
            for line, new in {
                "DECLARED: Final = {": PARSER,
                "        Effect(\n            **_module_fields(DRIVE_TORQUE)": f"{declared},",
            }.items()
        ),
    )
    return folder


@pytest.fixture(scope="module", params=[distribution, tree])
def home(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that has the effect, for the path of an interpreter."""
    found: Path = request.param(tmp_path_factory.mktemp("home"))
    return found


def scene(folder: Path, effects: str, name: str = "plate_translating") -> Path:
    path = folder / "scene.toml"
    path.write_text(f"{(SCENES / f'{name}.toml').read_text('utf-8')}\n{effects}", "utf-8")
    return path


def finding(reported: str) -> dict[str, Any]:
    """The finding of the effect in the document of a check."""
    (found,) = (
        each for each in json.loads(reported)["effects"]["noise"] if each["name"] == "loudest"
    )
    assert isinstance(found, dict)
    return found


@pytest.fixture(scope="module")
def said(home: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[int, str]]:
    """What calls of camgeo say of scenes with the effect; one interpreter makes them all."""
    folder = tmp_path_factory.mktemp("scenes")
    for each in ("loud", "mm", "inch"):
        (folder / each).mkdir()
    loud = scene(folder / "loud", NOISE)
    quiet = f"{SPRING}\n[effects.noise]\ngain = 0\ngap = 3\n"
    calls: dict[str, tuple[str | Path, ...]] = {
        "explain": ("explain", loud),
        "check": ("check", loud, "--json"),
        "mm": ("check", scene(folder / "mm", quiet), "--json"),
        "inch": ("check", scene(folder / "inch", quiet, "inch"), "--json"),
        "build": ("build", loud, "--only", "csv", "-o", folder / "out"),
    }
    ended = commands(home, *([str(word) for word in call] for call in calls.values()))
    answers = {
        name: (code, out + errors) for name, (code, out, errors) in zip(calls, ended, strict=True)
    }
    tables = [each.read_text("utf-8") for each in (folder / "out").glob("*.csv")]
    return answers | {"table": (len(tables), "".join(tables))}


def test_it_is_computed_with_what_it_needs(said: dict[str, tuple[int, str]]) -> None:
    explained, checked = said["explain"][1], said["check"][1]
    assert "effects.noise" in explained
    assert "effects.contact-force" in explained
    loud = finding(checked)["value"]
    assert loud > GAIN * 80.0  # of the preload alone


def test_its_lengths_are_in_the_unit_of_the_scene(said: dict[str, tuple[int, str]]) -> None:
    assert finding(said["mm"][1])["value"] == 3.0
    assert finding(said["inch"][1])["value"] == pytest.approx(3.0 * 25.4, rel=1e-15)


def test_its_columns_are_in_the_table(said: dict[str, tuple[int, str]]) -> None:
    code, reported = said["build"]
    assert code == 0, reported
    count, table = said["table"]
    assert count == 1
    lines = [line for line in table.splitlines() if not line.startswith("#")]
    (name,) = (each for each in next(csv.reader(lines)) if "noise" in each)
    rows = list(csv.DictReader(lines))
    assert max(float(row[name]) for row in rows) > GAIN * 80.0


def test_editors_know_it(home: Path) -> None:
    code = (
        "from camgeo.dynamics.effects.registry import effect_names\n"
        "from camgeo.scene.schema import whole_schema\n"
        "import json; print(json.dumps(whole_schema(effect_names())))"
    )
    noise = json.loads(run_copy(home, "-c", code).stdout)["properties"]["effects"]["properties"][
        "noise"
    ]
    assert noise["description"] == "How loud the follower is. Not with a conjugate pair."


def test_no_other_distribution_is_searched_unless_a_scene_names_an_unknown_effect(
    tmp_path: Path,
) -> None:
    code = (
        "import importlib.metadata, sys\n"
        "def refuse(**_): raise AssertionError('looked at')\n"
        "importlib.metadata.entry_points = refuse\n"
        "import camgeo; camgeo.load(sys.argv[1])"
    )
    run_ = [sys.executable, "-c", code]
    subprocess.run([*run_, str(scene(tmp_path, SPRING))], check=True, timeout=PATIENCE)
    named = subprocess.run(
        [*run_, str(scene(tmp_path, NOISE))], capture_output=True, text=True, check=False
    )
    assert "looked at" in named.stderr
