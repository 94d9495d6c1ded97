"""The result of `camgeo machines`, rendered as text and as JSON."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

import pytest

from camgeo.app.answers.answer import text
from camgeo.app.answers.machines import machine
from camgeo.app.cli.main import main
from camgeo.milling import machine as profiles
from tests.answers.documents import document

FOLDER = Path(profiles.__file__).parent / "machines"

Capture = pytest.CaptureFixture[str]


@pytest.mark.parametrize("name", profiles.names())
def test_a_profile_is_shown_with_all_its_keys(name: str) -> None:
    found = machine(name)
    shown = document(found)
    keys = {each["key"]: each["value"] for each in shown["keys"]}

    def check(table: dict[str, object], path: str) -> None:
        for key, value in table.items():
            quoted = key if key.replace("_", "").isalnum() else json.dumps(key)
            if isinstance(value, dict):
                check(value, f"{path}{quoted}.")
            elif path + quoted != "evidence":
                assert tomllib.loads(f"x = {keys[path + quoted]}")["x"] == value

    table = tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8"))
    check(table, "")
    lines = text(found).splitlines()
    for key, value in keys.items():
        assert any(re.match(rf"{re.escape(key)} += {re.escape(value)}", line) for line in lines)
    assert [each["text"] for each in shown["evidence"]] == [
        each["text"] for each in table["evidence"]
    ]
    assert all(f"    {each['text']}" in lines for each in shown["evidence"])


def test_a_profile_of_ones_own_is_checked(tmp_path: Path, capsys: Capture) -> None:
    source = (FOLDER / "grbl.toml").read_text(encoding="utf-8")
    own = tmp_path / "router.toml"
    own.write_text(source[: source.index("[[evidence]]")].replace('"Grbl"', '"my router"'))
    assert main(["machines", str(own)]) == 0
    assert '= "my router"' in capsys.readouterr().out
    own.write_text(own.read_text().replace('unit = "s"', 'unit = "min"').replace("G21", "{g21}"))
    assert main(["machines", str(own)]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert 'dwell.unit = min: must be one of "s", "ms"' in captured.err
    own.write_text(own.read_text().replace('unit = "min"', 'unit = "ms"').replace("{z}", "{Z}"))
    assert main(["machines", str(own), "--json"]) == 2
    (fault,) = json.loads(capsys.readouterr().out)["faults"]
    assert fault["key"] == "retract.blocks"
    assert "{z}" in fault["message"]
