"""A design's set of files: certificate, refusals, the same bytes again."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

import camgeo
from camgeo.app.answers.check import check
from camgeo.design import writing as write_module
from camgeo.design import writing as writer_module
from camgeo.design.product import Product
from camgeo.design.writing import Written, find_writer, find_writers, write_files, writer_names
from camgeo.errors import SceneError, ToleranceError
from camgeo.scene.formats.format import (
    LARGEST_TOLERANCE,
    SMALLEST_TOLERANCE,
    Format,
    no_options,
    writer_entries,
)
from tests.findings import known

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

FORMATS = ("3mf", "csv", "dxf", "gcode", "png", "step", "stl", "svg")


class Claims:
    """A writer whose file, read back, is `deviation` off."""

    format = Format("odd", ".txt", no_options)

    def __init__(self, deviation: float) -> None:
        self.deviation = deviation

    def write(self, product: Product, tolerance: float) -> Written:
        return Written(b"text", {"words": 1})

    def measure(self, product: Product, data: bytes) -> float:
        return self.deviation


def test_writers_are_found() -> None:
    assert set(FORMATS) <= set(writer_names())
    assert find_writer("dxf").format.suffix == ".dxf"
    with pytest.raises(SceneError, match=r'no writer for this format.*did you mean "gcode"'):
        find_writer("gcod")
    with pytest.raises(SceneError, match=r"format = pdf: no writer .*\(PDFs are drawn by: camgeo"):
        find_writer("pdf")


def test_report_and_certificate(tmp_path: Path) -> None:
    design = camgeo.load(SCENES / "vorschub.toml")
    report = design.write(tmp_path, ["csv", "dxf", "csv"], tolerance=0.01)
    assert [file.name for file in report.files] == ["vorschub.csv", "vorschub.dxf"]
    assert report.paths[-1] == tmp_path / "certificate.json"
    certificate = json.loads(report.paths[-1].read_bytes())
    assert certificate["tolerance_mm"] == 0.01
    assert certificate["scene"]["sha256"] == design.scene.made
    for record, file in zip(certificate["files"], report.files, strict=True):
        data = (tmp_path / file.name).read_bytes()
        assert record["sha256"] == hashlib.sha256(data).hexdigest()
        assert record["bytes"] == file.size == len(data)
        assert record["deviation_mm"] == file.deviation
        assert known(file.deviation) <= 0.01
    assert [finding["name"] for finding in certificate["findings"]]


def test_the_certificate_has_the_findings_on_parts(tmp_path: Path) -> None:
    """Those of `camgeo check`, with the disc; none of a scene that says nothing of its part."""
    scene = camgeo.load(SCENES / "conjugate_lever.toml").scene
    screw = {"diameter": 5, "height": 6}
    edits = {"part.hub": {"diameter": 40, "height": 12}, "part.set_screw": screw}
    for name, values in (("a", edits | {"limits.diameter": 100.0}), ("b", {"part": None})):
        design = camgeo.Design(scene.with_values({"output.formats": ["csv"], **values}))
        design.write(tmp_path / name, ["csv"])
        certificate = json.loads((tmp_path / name / "certificate.json").read_bytes())
        found = [each for each in certificate["findings"] if "part" in each]
        parts = check(design).parts if name == "a" else {}
        keys = ("part", "name", "severity", "value")
        assert [tuple(map(each.get, keys)) for each in found] == [
            (part, each.name, each.severity, each.value)
            for part, one in parts.items()
            for each in one.findings
        ]
        names = {each["name"] for each in found}
        told = {"disc-angle", "largest-diameter", "smallest-wall", "wall-ratio", "set-screw"}
        assert names == (told if parts else set())


@pytest.mark.parametrize(
    "tolerance",
    [0.0, -1.0, float("nan"), float("inf"), SMALLEST_TOLERANCE * (1.0 - 1e-12),
     LARGEST_TOLERANCE * (1.0 + 1e-12)],
)  # fmt: skip
def test_no_tolerance(tolerance: float, tmp_path: Path) -> None:
    design = camgeo.load(SCENES / "vorschub.toml")
    with pytest.raises(SceneError, match="must be a length of 1e-07 mm to 1 mm") as caught:
        design.write(tmp_path / "out", ["csv"], tolerance=tolerance)
    assert [(each.key, each.value) for each in caught.value.faults] == [
        ("tolerance", f"{tolerance:g}")
    ]
    assert not any(tmp_path.iterdir())


def test_what_is_installed_is_looked_through_once(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[dict[str, EntryPoint]] = []

    def counted() -> dict[str, EntryPoint]:
        calls.append(writer_entries())
        return calls[-1]

    monkeypatch.setattr(writer_module, "writer_entries", counted)
    found = find_writers(FORMATS)
    assert [*found] == [*FORMATS]
    assert all(found[name] is find_writer(name) for name in FORMATS)
    assert len(calls) == 1 + len(FORMATS)


@pytest.mark.parametrize("deviation", [0.0011, float("nan"), float("inf")])
def test_file_that_is_off_is_not_kept(
    deviation: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The certificate's own check, deliberately broken: a writer that misses its tolerance."""
    monkeypatch.setattr(write_module, "find_writers", lambda _: {"odd": Claims(deviation)})
    design = camgeo.load(SCENES / "vorschub.toml")
    with pytest.raises(ToleranceError, match="the odd file, read back, is off"):
        write_files(design.discs, tmp_path / "out", ("odd",), 0.001)
    assert not any(tmp_path.iterdir())


def test_the_same_bytes_in_another_process(tmp_path: Path) -> None:
    """Time, hash seed, folders, home, umask, locale, threads and the caller leave no trace."""
    scene = str(SCENES / "inch.toml")
    code = (
        f"import camgeo, sys;camgeo.load({scene!r}).write(sys.argv[1], {FORMATS!r}, tolerance=0.01)"
    )
    library = ["-c", code, str(tmp_path / "1")]
    program = ["-m", "camgeo", "build", scene, "-o", str(tmp_path / "4")]
    program += ["--only", ",".join(FORMATS), "--tolerance", "0.01"]
    runs = []
    for seed, command in (("1", library), ("4", program)):
        # With these seeds a set of ezdxf's class names comes in two orders.
        environment = dict(os.environ, PYTHONHASHSEED=seed, TZ=f"UTC+{seed}")
        home = tmp_path / f"home {seed}"
        if seed == "4":
            home.mkdir()
            threads = {"OPENBLAS_NUM_THREADS": "2", "OMP_NUM_THREADS": "2"}
            environment |= {"HOME": str(home), "LC_ALL": "C", **threads}
        subprocess.run(
            [sys.executable, *command], check=True, env=environment, stdout=subprocess.PIPE,
            cwd=home if seed == "4" else None, umask=0o077 if seed == "4" else -1,
        )  # fmt: skip
        runs.append({path.name: path.read_bytes() for path in sorted((tmp_path / seed).iterdir())})
    assert len(runs[0]) == len(FORMATS) + 1
    assert runs[0].keys() == runs[1].keys()
    differing = [name for name, data in runs[0].items() if data != runs[1][name]]
    assert not differing
