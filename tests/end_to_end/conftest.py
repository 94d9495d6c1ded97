"""Each fixture scene is built once a session, by the command line."""

from __future__ import annotations

import io
import json
from contextlib import redirect_stdout

import pytest

from camgeo import load
from camgeo.cli.main import main
from tests.answers.documents import validator
from tests.end_to_end.built import SCENES, Built


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
