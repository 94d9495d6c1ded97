"""What each command says, in words and as a document, on scenes that use its branches."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import pytest

from camgeo.app import answers
from tests import kept
from tests.answers.documents import FIXTURES, SCENES, validator
from tests.thinned import WHOLE, share

FOLLOWING: Final = {"files", "scenes"}
"""Names of calls that read what the one before has written; of others a usual run makes a share."""

KEPT: Final = {
    "check": """
    check scenes/conjugate_lever.toml
    check scenes/inch.toml
    check scenes/inch.toml --json
    check effects/yoke.toml --json
    check refused/undercut_tappet.toml --json
    check refused/global_undercut.toml
    check milling/moved_clamps.toml
    check milling/moved_clamps.toml --json
    check found/dead_centre.toml --json
    """,
    "explain": """
    explain scenes/conjugate_lever.toml
    explain scenes/inch.toml --json
    explain refused/undercut_tappet.toml
    """,
    "size": """
    size scenes/setzhub.toml
    size scenes/setzhub.toml --json
    size scenes/inch.toml
    size scenes/tappet.toml --radius-of-curvature 3 --json
    size scenes/tappet.toml
    size scenes/flat_rocker.toml
    size scenes/plate_translating.toml --transmission-angle 50 --radius-ratio 0.5
    size tolerance/lever.toml --arm 65 75
    size scenes/crank_slider.toml
    size scenes/four_bar.toml --json
    """,
    "table": """
    table scenes/inch.toml --step 45
    table scenes/inch.toml --step 45 --json
    table scenes/four_bar.toml --step 60
    table scenes/conjugate_carriage.toml --step 90
    table scenes/measured.toml --step 90
    table effects/conjugate_lever.toml --step 90
    table --law modified-sine --step 0.1 --printed
    table --law polynomial-345 --step 0.25
    table --law modified-sine --step 0.3
    table
    table scenes/inch.toml --law modified-sine
    table --law no-such-law
    """,
    "setup": """
    setup milling/moved_clamps.toml --json
    setup milling/moved_clamps.toml
    setup scenes/conjugate_lever.toml
    setup scenes/inch.toml
    setup scenes/inch.toml --json
    setup effects/yoke.toml
    """,
    "replay": """
    replay scenes/inch.toml --step 10
    replay scenes/inch.toml --step 10 --json
    replay scenes/conjugate_lever.toml --step 10 --json
    replay scenes/conjugate_lever.toml --step 10
    replay scenes/cut_lobe.toml --step 5
    replay scenes/groove.toml --step 10 --flank outer
    replay scenes/inch.toml --step 11
    """,
    "probe": """
    probe scenes/inch.toml --step 30 --ball 1.5 --tolerance 0.02
    probe scenes/inch.toml --step 30 --ball 1.5 --tolerance 0.02 --json
    probe scenes/conjugate_lever.toml --spacing 40 --json
    probe scenes/groove.toml --spacing 30
    probe scenes/tappet.toml --step 30 --ball 50
    probe scenes/tappet.toml --step 31
    probe scenes/tappet.toml --step 3 --spacing 4
    """,
    "laws": """
    laws
    laws --task all --json
    laws --task all --law cycloidal modified-sine
    laws --places
    laws --task R-U --inflection 0.4
    laws --task U-U --curved 0.5
    laws --law modified-sine polynomial-345 --speed 120 --span 60 --stroke 25
    laws --law modified-sine polynomial-345 --speed 120 --span 60 --stroke 25 --json
    laws --speed 120
    laws --task B-B --a0 1 --a1 2
    """,
    "machines": """
    machines
    machines --json
    machines haas
    machines linuxcnc --json
    machines none
    """,
    "slotted-lever": """
    slotted-lever --frame 150 --swing 60 --speed 90
    slotted-lever --frame 150 --swing 60 --speed 90 --json
    slotted-lever --frame 50 --crank 80 --speed 90
    slotted-lever --frame 50 --crank 80 --speed 90 --table --step 30
    slotted-lever --frame 150 --swing 60 --speed 90 --table --printed --from 5 --to 95 --step 45
    slotted-lever --frame 50 --crank 50 --speed 90
    slotted-lever --frame 50 --swing 180 --speed 90
    """,
    "accuracy": """
    accuracy scenes/inch.toml --tolerances 1e-1 --speed 600 --json
    """,
    "compare": """
    compare scenes/inch.toml scenes/tappet.toml
    compare scenes/inch.toml scenes/tappet.toml --json
    compare scenes/inch.toml scenes/inch.toml scenes/plate_translating.toml --ask diameter,peak:a
    compare scenes/inch.toml
    compare scenes/inch.toml scenes/tappet.toml --ask nothing
    """,
    "sweep": """
    sweep scenes/inch.toml --vary follower.base_radius=1:2:3 \
        --ask transmission-angle,peak:a,diameter
    sweep scenes/inch.toml --vary follower.base_radius=1:2:3 --ask transmission-angle,verdict --json
    sweep scenes/inch.toml --vary follower.base_radius=1:2 --samples 3 --ask diameter --json
    sweep scenes/inch.toml --vary follower.base_radius=-1,2 \
        --vary motion.1.law=modified-sine,polynomial-345 --ask verdict
    sweep scenes/inch.toml --vary follower.no=1,2 --ask verdict
    sweep scenes/inch.toml
    """,
    "optimise": """
    optimise scenes/inch.toml --vary follower.base_radius=1:3 --least diameter \
        --keep transmission-angle>=60 --evaluations 12
    optimise scenes/inch.toml --vary follower.base_radius=1,2,3 --least diameter \
        --largest transmission-angle --evaluations 9 --json
    optimise scenes/inch.toml --vary follower.base_radius=1:2 --least diameter \
        --keep transmission-angle>=89 --evaluations 8
    optimise scenes/inch.toml --vary follower.base_radius=1:2
    """,
    "tolerance": """
    tolerance tolerance/lever.toml --count 128
    tolerance tolerance/lever.toml --count 0 --json
    tolerance tolerance/lever.toml --seed 3 --json
    tolerance tolerance/lever.toml --count 127
    tolerance scenes/inch.toml
    """,
    "files": """
    build scenes/inch.toml -o {}/inch --only dxf,csv,gcode,stl
    build scenes/inch.toml -o {}/inch --only dxf,csv,gcode,stl --json
    verify {}/inch --scene scenes/inch.toml
    verify {}/inch --scene scenes/inch.toml --json --force
    replay scenes/inch.toml {}/inch/inch.dxf --step 10
    replay scenes/inch.toml {}/inch/inch.dxf --step 10 --json
    lint {}/inch/inch.ngc --machine linuxcnc
    lint {}/inch/inch.ngc --machine haas --stock-top 5
    lint {}/inch/inch.ngc --machine linuxcnc --scene scenes/inch.toml --json
    probe scenes/inch.toml --step 10 --ball 1.5 -o {}/points.csv --lift {}/lift.csv
    inspect scenes/inch.toml {}/points.csv --tolerance 0.02
    inspect scenes/inch.toml {}/points.csv --align free --json
    inspect scenes/inch.toml {}/points.csv --align rotation --robust
    report scenes/inch.toml --quick
    report effects/conjugate_lever.toml --quick --json
    report refused/global_undercut.toml --quick
    build refused/undercut_tappet.toml -o {}/none
    report refused/undercut_tappet.toml
    """,
    "scenes": """
    new oscillating-flat
    import reference/ocv/setzhub.ocv
    import reference/ocv/vorschub.ocv
    """,
}
"""Calls by the name of the file in which what they say is kept; {} is a folder for files."""


def judged(document: dict[str, Any]) -> None:
    """A document is what its schema says."""
    name = document["schema"].removeprefix("camgeo/").replace("-", "_")
    validator(f"{answers.__name__}.{name}").validate(document)


@pytest.mark.long
@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_documents_of_every_scene_are_what_their_schemas_say(scene: Path, tmp_path: Path) -> None:
    commands = ("check", "explain", "probe --step 10", "replay", "setup", "size", "table --step 45")
    calls = "\n".join(f"{command} {scene} --json" for command in commands)
    assert len([*kept.called(calls, tmp_path, judged)]) == len(commands)


@pytest.mark.parametrize("name", KEPT)
def test_what_is_said_is_as_kept(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(FIXTURES)
    every, calls = name in FOLLOWING, KEPT[name].strip().splitlines()
    made = kept.called("\n".join(calls if every else share(calls, 3)), tmp_path, judged)
    kept.compare(f"answers/{name}.txt", made, whole=every or WHOLE)
