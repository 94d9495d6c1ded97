"""The limits of files that are read, and the numbers, lines and TOML in them."""

from __future__ import annotations

from pathlib import Path

import pytest

from camgeo import reading
from camgeo.errors import FileError
from camgeo.reading import Limits

SMALL = Limits("note", 20, lines=3)


def test_a_file_within_its_limits_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_bytes(b"x" * 20)
    assert reading.read_limited(path, SMALL) == b"x" * 20
    path.write_bytes(b"x" * 21)
    with pytest.raises(FileError, match=r"a.txt: has 21 bytes; at most 20 are allowed in a note"):
        reading.read_limited(path, SMALL)


def test_a_device_without_end_is_not_read_to_its_end() -> None:
    device = Path("/dev/zero")
    if not device.exists():
        pytest.skip("the system has no such device")
    with pytest.raises(FileError, match="zero: has 21 bytes"):
        reading.read_limited(device, SMALL)


@pytest.mark.parametrize("end", [b"\n", b"\r", b"\r\n"])
def test_lines_of_any_system_are_counted(end: bytes) -> None:
    reading.check_text(b"a" + end + b"b" + end + b"c" + end, SMALL, "a.txt")
    with pytest.raises(FileError, match=r"a.txt: has 4 lines; at most 3 are allowed in a note"):
        reading.check_text(4 * (b"a" + end), SMALL, "a.txt")
    assert list(reading.text_lines(b"\xef\xbb\xbfa" + end + b"\xff" + end)) == ["a", "\ufffd"]


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("1.5", 1.5), ("-1e9", -1e9), (" .5 ", 0.5), ("0" * 60, 0.0), ("0" * 61, None),
        ("1.1e9", None), ("nan", None), ("inf", None), ("1_0", None), ("\uff11", None), ("", None),
    ],
)  # fmt: skip
def test_numbers(text: str, number: float | None) -> None:
    assert reading.parse_number(text) == number


@pytest.mark.parametrize(
    "text",
    [
        "a = 1",
        ".".join("a" * 16) + " = 1",
        f'x = "{".".join("a" * 99)}"',
        f"x = '''\n{'.a' * 99}\n'''",
        f"# {'a.' * 99}\nx = 1",
        'x = "' + '\\"' * 99 + 'a.b"',
        "x = [" + "1.5, " * 30_000 + "]",
    ],
)
def test_toml_within_its_limits(text: str) -> None:
    reading.check_toml(text)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("\n\n" + ".".join("a" * 18), "line 3 has more than 16 parts"),
        (" . ".join(['"a.b"'] * 18), "line 1 has more than 16 parts"),
        ("x = '''\n\n'''\n[" + ".".join("a" * 18) + "]", "line 4 has more than"),
        ("x = [" + "1," * 300_001 + "]", "has 300,003 characters"),
        ("a.b = 1\n" * 40_001, "has 40,001 tables and dotted keys; allowed: at most 40,000"),
        ("[a]\n" * 40_001, "has 80,002 tables|has 40,001 tables"),
        ("a = {}\n" * 40_001, "has 40,001 tables"),
    ],
)
def test_toml_beyond_its_limits(text: str, message: str) -> None:
    with pytest.raises(FileError, match=message):
        reading.check_toml(text)
