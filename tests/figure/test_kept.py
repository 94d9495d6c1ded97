"""The figures that commands draw of what they found, mark by mark."""

from __future__ import annotations

from pathlib import Path

import pytest

from camgeo.app.cli import plot
from camgeo.pictures import (
    sweep,  # noqa: F401  what `sweep` draws
)
from camgeo.pictures.model import Figure
from tests import kept

FIXTURES = Path(__file__).parents[2] / "fixtures"

CALLS = """
    plot milling/moved_clamps.toml backplot -o {}/backplot.svg
    plot scenes/groove.toml cam mechanism -o {}/groove.svg
    plot effects/yoke.toml mechanism -o {}/yoke.svg
    plot scenes/points.toml motion -o {}/points.svg
    plot refused/global_undercut.toml cam -o {}/undercut.svg
    plot scenes/inch.toml cams -o {}/none.svg
    size scenes/tappet.toml -o {}/size.svg
    laws --task U-U --curved 0.5 -o {}/laws.svg
    slotted-lever --frame 50 --crank 80 --speed 90 -o {}/slotted-lever.svg
    replay scenes/cut_lobe.toml --step 5 -o {}/replay.svg
    probe scenes/inch.toml --step 10 -o {}/points.csv
    inspect scenes/inch.toml {}/points.csv --tolerance 0.02 -o {}/inspect.svg
    compare scenes/inch.toml scenes/tappet.toml --ask diameter,peak:a -o {}/compare.svg
    tolerance tolerance/lever.toml --count 128 -o {}/tolerance.svg
    sweep scenes/inch.toml --vary follower.base_radius=1:2:3 --vary cam.speed=60,90 \
        --ask transmission-angle,verdict --picture {}/map.svg
    sweep scenes/inch.toml --vary follower.base_radius=1:2:3 --ask peak:a,diameter \
        --picture {}/curves.svg
    sweep scenes/inch.toml --vary follower.base_radius=1:2 --samples 4 --ask diameter,max:mu \
        --least diameter --largest max:mu --picture {}/front.svg
    sweep scenes/inch.toml --vary follower.base_radius=1:2:2 --vary follower.roller_radius=0.2,0.3 \
        --vary motion.1.law=modified-sine,polynomial-345 --ask diameter --picture {}/axes.svg
    optimise scenes/inch.toml --vary follower.base_radius=1:3 --least diameter \
        --largest transmission-angle --evaluations 9 -o {}/optimise.svg
    optimise scenes/inch.toml --vary follower.base_radius=1:3 --least diameter \
        --keep transmission-angle>=60 --evaluations 9 -o {}/course.svg
"""


def test_what_commands_draw_is_as_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def marks(figure: Figure, _suffix: str) -> bytes:
        return kept.marks(figure).encode()

    monkeypatch.chdir(FIXTURES)
    monkeypatch.setattr(plot, "drawn", marks)
    calls = list(kept.called(CALLS, tmp_path))
    (tmp_path / "points.csv").unlink()
    kept.compare("figure/commands.txt", [*calls, *kept.files(tmp_path)])
