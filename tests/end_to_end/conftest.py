"""Each fixture scene is built once a session, by the command line."""

from __future__ import annotations

import io
import json
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any, Final

import pytest

from camgeo import load
from camgeo.app.cli.main import main
from tests.answers.documents import validator
from tests.end_to_end.built import SCENES, Built
from tests.long_form import LONG
from tests.quick import BUILT

REPEATED: Final = {
    "conjugate_carriage": "test_conjugate builds it and its return disc",
    "conjugate_lever": "test_conjugate and test_pair build such discs",
    "feed": "plate_translating",
    "four_bar": "setzhub",
    "points": "measured",
    "querhub": "setzhub",
    "schnitt": "setzhub",
    "shuttle": "setzhub",
    "vorschub": "setzhub",
}
"""Scenes that are built in the long form only, with what is of the same kind: discs and files of
these differ by the motion alone. What motions and linkages are is tested where they are computed.
"""

MEASURED: Final = {
    "test_gcode": ("constant_breadth", "cut_lobe", "groove_clearance", "inch", "measured", "ring",
                   "straight_moves", "tappet"),
    "test_dxf": (SOLID := ("crank_slider", "d_shaft", "flat_rocker", "groove", "hub_and_holes",
                           "knife_edge", "plate_translating", "swallow_tail", "trimmed_ring")),
    "test_solids": SOLID,
}  # fmt: skip
"""Modules that measure files independently of camgeo, with the scenes of which they do, besides the
one that the quick tests build. What is written of each scene is so measured in one format at least,
and verified by camgeo in all. The long form measures all files.
"""

HUBS: Final = {"d_shaft", "hub_and_holes"}
"""Scenes that are not measured by `test_gcode`, which knows the walls of a disc alone: their
programs clear areas and change tools. As those of other jobs they are simulated when verified."""


def _wanted(module: str, scene: str) -> bool:
    """Whether a module of this folder examines what is built of a scene."""
    if module == "test_gcode" and scene in HUBS:
        return False
    if LONG or scene == BUILT:
        return True
    return scene in MEASURED.get(module, (scene,)) and scene not in REPEATED


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what another module measures of a scene, and what repeats another scene."""
    kept: list[pytest.Item] = []
    left: list[pytest.Item] = []
    for item in items:
        call: Any = getattr(item, "callspec", None)
        here = item.path.parent == Path(__file__).parent
        path = call.params.get("built") if call and here else None
        (kept if path is None or _wanted(item.path.stem, Path(path).stem) else left).append(item)
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
    validator("camgeo.app.answers.build").validate(json.loads(reported.getvalue()))
    return built
