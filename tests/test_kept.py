"""What a comparison with kept results lets pass."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from tests import kept


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("value 1.5 mm", "value 1.5 mm", True),
        ("value 1.5 mm", "value 1.6 mm", False),
        ("value 1.5 mm", "value 1.5 cm", False),
        ("[1.234567891]", "[1.234567892]", True),
        ("[1.234567891]", "[1.234567899]", False),
        ("[1234567891.5]", "[1234567892.5]", True),
        ("[12.34567]", "[12.34568]", True),
        ("[12.34567]", "[12.34569]", False),
        ("[12345678901]", "[12345678902]", False),
        ("[0.00012]", "[0.00013]", False),
        ("[-2.5]", "[2.5]", False),
        ("[1.00000000001e-5]", "[1e-5]", True),
        ("[1e-5]", "[1e-6]", False),
        ('"cam_angle_deg": 12.34567891', '"cam_angle_deg": 12.34567812', True),
        ('"cam_angle_deg": 12.34567891', '"cam_angle_deg": 12.345671', False),
        ("tool 7", "tool 8", False),
        ("[1.5, 2]", "[1.5]", False),
        ("X12.345678 Y1", "X12.345679 Y1", False),
        ("2.1e-15 deg at 303.75 deg", "0 deg at 0 deg", True),
        ("2.1e-15 deg at 303.75 deg", "0 mm at 0 deg", False),
        ("2.1e-9 deg at 303.75 deg", "2.1e-9 deg at 0 deg", False),
    ],
)
def test_numbers_within_a_billionth_are_the_same(one: str, other: str, same: bool) -> None:
    assert kept.same(one, other) == same
    assert kept.same(other, one) == same


def test_what_two_processors_do_not_agree_on_is_left_open() -> None:
    line = kept.common("9.5 mm at (1.48, 0) mm", "9.5 mm at (-1.48, 0) mm")
    assert line == "9.5 mm at (~, 0) mm"
    assert kept.same(line, "9.5 mm at (7, 0) mm")
    assert not kept.same(line, "9.5 mm at (7, 1) mm")
    assert kept.common("1.5 mm", "1.5 mm") == "1.5 mm"
    with pytest.raises(ValueError, match="one mm\nanother mm"):
        kept.common("one mm", "another mm")


def test_numbers_are_kept_to_ten_digits() -> None:
    assert kept.short(math.pi) == "3.141592654"
    assert kept.short(-2.0 / 3.0 * 1e7) == "-6666666.667"
    assert kept.short(1e-17) == "0"
    assert kept.document({"camgeo": "1", "a": [1, 2.5, None, True, math.inf], "b": "x"}) == (
        '{"a": [1, 2.5, null, true, inf], "b": "x"}'
    )


def test_any_number_that_changes_changes_what_is_kept_of_many() -> None:
    values = np.sin(np.arange(60.0)).reshape(20, 3)
    before = kept.document(kept.summary(values))
    for place in np.ndindex(values.shape):
        changed = values.copy()
        changed[place] += 1e-6
        assert not kept.same(before, kept.document(kept.summary(changed)).replace("\n", ""))
    swapped = values.copy()
    swapped[[4, 5]] = swapped[[5, 4]]
    assert not kept.same(before, kept.document(kept.summary(swapped)))


def test_a_difference_is_found_and_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept, "FOLDER", tmp_path)
    monkeypatch.delenv(kept.WRITTEN_ANEW, raising=False)
    (tmp_path / "a.txt").write_text("## first\n1.5\n\n## second\nx\n\n")
    kept.compare("a.txt", [("first", "1.5\n"), ("second", "x")])
    with pytest.raises(pytest.fail.Exception, match=r"a.txt:5, ## second\nkept  x\nfound y"):
        kept.compare("a.txt", [("first", "1.5\n"), ("second", "y")])
    with pytest.raises(pytest.fail.Exception, match="6 lines, found 3"):
        kept.compare("a.txt", [("first", "1.5\n")])
