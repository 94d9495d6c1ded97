"""Names of earlier versions are read, with a line that states the present one."""

from __future__ import annotations

import pytest

from camgeo.app.cli.command import EARLIER
from camgeo.app.cli.main import COMMANDS, main
from camgeo.scene.toml import TEMPLATE_KINDS
from tests.stability.suite import GROUPS

Capture = pytest.CaptureFixture[str]

SLOTTED = ("--frame", "150", "--swing", "60", "--speed", "90")


@pytest.mark.parametrize(
    ("earlier", "present"),
    [
        (("crank-slide", *SLOTTED), ("slotted-lever", *SLOTTED)),
        (("new", "crank-slider"), ("new", "slider-driven-crank")),
    ],
)
def test_an_earlier_name_does_the_same_and_says_so(
    earlier: tuple[str, ...], present: tuple[str, ...], capsys: Capture
) -> None:
    assert main(present) == 0
    expected = capsys.readouterr()
    assert expected.err == ""
    assert main(earlier) == 0
    found = capsys.readouterr()
    assert found.out == expected.out
    (name,) = set(earlier) - set(present)
    assert found.err == f'camgeo: "{name}" is now called "{EARLIER[name]}"\n'


def test_every_earlier_name_leads_to_one_that_is_read_and_is_listed_no_more() -> None:
    known = {*COMMANDS, *TEMPLATE_KINDS, *GROUPS}
    assert set(EARLIER.values()) <= known
    assert not set(EARLIER) & known
