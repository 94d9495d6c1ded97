"""Each fixture scene is built once a session, by the command line."""

from __future__ import annotations

import io
import json
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any, Final

import pytest

from camgeo import load
from camgeo.cli.main import main
from tests.answers.documents import validator
from tests.end_to_end.built import SCENES, Built
from tests.long_form import some
from tests.quick import BUILT

MEASURED: Final = {"test_gcode": 0, "test_dxf": 1, "test_solids": 1}
"""Modules that measure files independently of camgeo, each those of every other scene, from this
number on. What is written of each scene is so measured in one format at least, and verified by
camgeo in all. The long form measures all files, and the scene that the quick tests build is
measured in all formats.
"""

HUBS: Final = {"d_shaft", "hub_and_holes"}
"""Scenes that are not measured by `test_gcode`, which knows the walls of a disc alone: their
programs clear areas and change tools. As those of other jobs they are simulated when verified."""


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what another module measures of a scene."""
    kept: list[pytest.Item] = []
    left: list[pytest.Item] = []
    for item in items:
        call: Any = getattr(item, "callspec", None)
        first = MEASURED.get(item.path.stem) if item.path.parent == Path(__file__).parent else None
        path = call.params.get("built") if call and first is not None else None
        wanted = path is None or path.stem == BUILT or path in some(SCENES, of=2, first=first or 0)
        if path is not None and item.path.stem == "test_gcode":
            wanted &= path.stem not in HUBS
        (kept if wanted else left).append(item)
    if left:
        config.hook.pytest_deselected(items=left)
        items[:] = kept


@pytest.fixture(scope="session", params=SCENES, ids=lambda path: path.stem)
def built(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Built:
    """The scene and its folder of files."""
    folder = tmp_path_factory.mktemp(request.param.stem)
    built = Built(load(request.param), folder)
    # In the formats of the scene, and as STEP, which no scene need name.
    formats = ",".join((*built.design.scene.output.formats, "step"))
    # A disc that is trimmed breaks a limit, and is made.
    broken = 1 if built.is_trimmed else 0
    with redirect_stdout(io.StringIO()) as reported:
        words = ["build", str(request.param), "-o", str(folder), "--only", formats, "--json"]
        assert main(words) == broken
    validator("camgeo.answers.build").validate(json.loads(reported.getvalue()))
    return built
