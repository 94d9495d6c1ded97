"""What options do, what files are written, and what is said of calls that are wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests import kept

FIXTURES = Path(__file__).parents[2] / "fixtures"

WRITTEN = """
    new knife-edge -o {}/new.toml
    new knife-edge -o {}/new.toml
    import reference/ocv/schnitt.ocv -o {}/import.toml
    table scenes/inch.toml --step 30 -o {}/table.csv
    table --law modified-sine --step 0.25 -o {}/law.csv
    table --law modified-sine --step 0.25 --task U-U --curved 0.5
    slotted-lever --frame 50 --crank 80 --speed 90 --csv {}/lever.csv --step 10
    size scenes/inch.toml --transmission-angle 65 --scene {}/size.toml
    replay scenes/inch.toml --step 10 -o {}/replay.csv
    probe scenes/groove.toml --step 30 --ball 1 --tolerance 0.1 -o {}/probe.csv --lift {}/lift.csv
    inspect scenes/groove.toml {}/probe-outer.csv --ball 1 -o {}/inspect.csv
    inspect scenes/groove.toml {}/probe-inner.csv --flank inner --align rotation --json
    probe scenes/inch.toml --step 5 --ball 1.5 -o {}/probe-inch.csv
    inspect scenes/inch.toml {}/probe-inch.csv --ball 1.5 -o {}/inspect-inch.csv
    sweep scenes/inch.toml --vary follower.base_radius=1:2:3 --ask diameter,verdict \
        -o {}/sweep.csv -o {}/sweep.json
    sweep scenes/inch.toml --vary follower.base_radius=1:2:3 --ask diameter,verdict -o {}/sweep.csv
    optimise scenes/inch.toml --vary follower.base_radius=1:3 --least diameter --evaluations 5 \
        --seed 2 -o {}/best.toml -o {}/best.json -o {}/best.csv
    tolerance tolerance/lever.toml --count 0 -o {}/tolerance.csv
    build scenes/points.toml --only csv --tolerance 0.1 -o {}/built
"""

WRONG = """
    lint {}/a.ngc --machine haas --stock-top 5 --clearance 4
    lint {}/a.ngc --machine haas --second-side
    lint {}/a.ngc --machine haas --radius 1:3
    lint {}/a.ngc --machine haas --radius 1234567=3
    lint {}/a.ngc --machine haas
    size scenes/inch.toml --arm 3 4 -o {}/a.svg
    size scenes/inch.toml --arm 4 3
    size scenes/inch.toml --transmission-angle 90
    size scenes/inch.toml --radius-ratio 1.1
    size scenes/inch.toml --scene {}/a.toml -o {}/a.toml
    build scenes/inch.toml --tolerance 0
    build scenes/inch.toml --tolerance 1.0000001
    build scenes/inch.toml --only dxf,stone
    slotted-lever --frame 50 --crank 80 --speed 90 --step 30
    slotted-lever --frame 50 --crank 80 --speed 90 --table --csv {}/a.csv -o {}/b/a.svg
    slotted-lever --frame 50 --crank 80 --speed 0
    laws --task all --v1 1
    laws --speed 9 --span 90
    laws --stroke 9
    table scenes/inch.toml --printed
    table scenes/inch.toml --step 0.0009
    table scenes/inch.toml --step 90.0001
    table scenes/inch.toml --step x
    replay scenes/inch.toml --step 0.0009
    replay scenes/inch.toml --corner -1
    probe scenes/inch.toml --spacing 0
    probe scenes/inch.toml --lift {}/a.txt
    probe scenes/inch.toml --lift {}/a.csv -o {}/a.csv
    inspect scenes/inch.toml {}/none.csv
    inspect scenes/inch.toml {}/none.csv --robust
    accuracy scenes/inch.toml --tolerances 9.99e-8
    accuracy scenes/inch.toml --tolerances 1.0000001
    compare scenes/inch.toml scenes/none.toml
    sweep scenes/inch.toml --vary cam.speed=1,2 --ask verdict --seed 2
    sweep scenes/inch.toml --vary cam.speed=1,2 --ask verdict -o {}/a.sqlite -o {}/b.sqlite
    sweep scenes/inch.toml --vary cam.speed=1,2 --ask verdict --resume
    sweep scenes/inch.toml --vary cam.speed=1,2 --ask verdict -o {}/a.csv -o {}/b/a.csv
    sweep scenes/inch.toml --vary cam.speed=1,2 --ask verdict --show map
    sweep scenes/inch.toml --vary cam.speed=1,2 --ask verdict --show pareto --picture {}/a.svg
    sweep scenes/inch.toml --vary cam.speed=1:2:1 --ask verdict
    sweep scenes/inch.toml --vary cam.speed=1:2 --ask verdict
    sweep scenes/inch.toml --vary cam.speed= --ask verdict
    sweep scenes/inch.toml --vary cam.speed=1,2 --vary cam.speed=1,2 --ask verdict
    sweep scenes/inch.toml --vary cam.speed,follower.offset=1/2,2 --ask verdict
    sweep scenes/inch.toml --vary cam.speed=1,2 --ask peak:zz
    sweep scenes/inch.toml --vary cam.speed=1,2 --ask diametre
    optimise scenes/inch.toml --vary cam.speed=1:2 --least verdict
    optimise scenes/inch.toml --vary cam.speed=1:2 --least diameter --keep diameter=3
    optimise scenes/inch.toml --vary cam.speed=1:2 --least diameter --keep diameter>=x
    optimise scenes/inch.toml --vary cam.speed=1:2 --least diameter --largest diameter
    optimise scenes/inch.toml --vary cam.speed=1:2 --least diameter --ignore nothing
    optimise scenes/inch.toml --vary cam.speed=1:2 --least diameter --evaluations 0
    optimise scenes/inch.toml --vary cam.speed=1:2 --least diameter -o {}/a.csv -o {}/b/a.json
    tolerance tolerance/lever.toml --count 16385
    tolerance tolerance/lever.toml --seed -1 --count 128
    watch scenes/inch.toml --every 0
    design --port 65536
    import reference/ocv/schnitt.ocv -o reference/ocv/schnitt.ocv
    import scenes/inch.toml
    plot effects/yoke.toml shock-spectrum -o {}/a.svg
    plot scenes/conjugate_carriage.toml efects -o {}/a.svg
    plot effects/yoke.toml backplot -o {}/a.svg
    verify {}
    machines {}
"""


def test_what_is_written_is_as_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(FIXTURES)
    calls = list(kept.called(WRITTEN, tmp_path))
    (tmp_path / "built" / "certificate.json").unlink()
    kept.compare("cli/written.txt", [*calls, *kept.files(tmp_path)])


def test_what_is_said_of_wrong_calls_is_as_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(FIXTURES)
    calls = list(kept.called(WRONG, tmp_path))
    assert not list(tmp_path.iterdir())
    kept.compare("cli/wrong.txt", calls)
