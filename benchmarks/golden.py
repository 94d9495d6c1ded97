"""Bytes of every file, compared with those of an earlier revision; both are made in this run.

Builds each scene in every format that it can be written in, with this tree and with the tree of
`--against REV`, which needs git, and compares file by file. What may differ is masked: hashes (the
scene's identity is in the files, and changes their own hashes too) and the size of a 3MF file,
which contains one in compressed form. Scenes that the earlier tree does not have are left out.
Exits with 1 if anything else differs.

    python benchmarks/golden.py --against REV [--keep FOLDER] [SCENE ...]

`--keep` holds the earlier files for the next run against the same revision.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import tomllib
import zipfile
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parents[1]

FORMATS: Final = ("dxf", "gcode", "stl", "3mf", "step", "csv", "svg", "png", "asc")

HASH: Final = re.compile(rb"(?<![0-9a-f])[0-9a-f]{64}(?![0-9a-f])")

SIZE: Final = re.compile(rb'("format": "3mf",\s+"sha256": "0+",\s+"bytes": )\d+')

CERTIFICATE: Final = "certificate.json"


def scenes(revision: str) -> list[Path]:
    """All fixture scenes that can be built and that both trees have."""
    folders = [f"fixtures/{name}" for name in ("scenes", "effects", "milling", "pairs")]
    listed = subprocess.run(
        ("git", "ls-tree", "-r", "--name-only", revision, *folders),
        cwd=ROOT, capture_output=True, text=True, check=True,
    )  # fmt: skip
    earlier = {ROOT / name for name in listed.stdout.splitlines()}
    found = {path for folder in folders for path in (ROOT / folder).glob("*.toml")}
    return sorted(found & earlier)


def environment(tree: Path, folder: Path) -> dict[str, str]:
    """Runs the camgeo of `tree`, with the entry points that its pyproject.toml declares."""
    project = tomllib.loads((tree / "pyproject.toml").read_text("utf-8"))["project"]
    info = folder / "camgeo-0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: camgeo\nVersion: 0\n", "utf-8")
    groups = project.get("entry-points", {})
    lines = [
        line
        for group, points in groups.items()
        for line in (f"[{group}]", *(f"{name} = {place}" for name, place in points.items()))
    ]
    (info / "entry_points.txt").write_text("\n".join(lines) + "\n", "utf-8")
    path = os.pathsep.join(map(str, (folder, tree, tree / "export")))
    return {**os.environ, "PYTHONPATH": path}


def build(scene: Path, out: Path, formats: tuple[str, ...], env: dict[str, str]) -> str:
    """Write the files of a scene into `out`; return the error of the command, or nothing."""
    command = (sys.executable, "-m", "camgeo", "build", str(scene), "-o", str(out), "--force")
    done = subprocess.run(
        (*command, "--only", ",".join(formats)),
        env=env, cwd=out.parent, capture_output=True, text=True, check=False,
    )  # fmt: skip
    return "" if (out / CERTIFICATE).exists() else done.stderr.strip()[-500:]


def build_all(scene: Path, out: Path, env: dict[str, str]) -> None:
    """Write a scene in all formats at once, or, where one is refused, in those that can be."""
    if not build(scene, out, FORMATS, env):
        return
    trial = out.with_name(f"{out.name}-trial")
    possible = []
    for name in FORMATS:
        shutil.rmtree(trial, ignore_errors=True)
        if not build(scene, trial, (name,), env):
            possible.append(name)
    shutil.rmtree(trial, ignore_errors=True)
    if not possible or build(scene, out, tuple(possible), env):
        raise SystemExit(f"{scene.name}: the earlier revision cannot build it")


def masked(path: Path, scene_hash: str) -> bytes:
    """The content of a file without what may differ."""
    data = path.read_bytes()
    if path.suffix == ".3mf":
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            data = b"".join(name.encode() + archive.read(name) for name in archive.namelist())
    for digits in range(64, 7, -1):  # a file may name the first digits alone
        data = data.replace(scene_hash[:digits].encode(), b"0" * digits)
    return SIZE.sub(rb"\1?", HASH.sub(b"0" * 64, data))


def content(folder: Path) -> dict[str, bytes]:
    """The files of a folder by name, masked."""
    certificate = json.loads((folder / CERTIFICATE).read_bytes())
    scene_hash = certificate["scene"]["sha256"]
    return {path.name: masked(path, scene_hash) for path in sorted(folder.iterdir())}


def compare(scene: Path, before: Path, env: dict[str, str], work: Path) -> list[str]:
    """What differs between the files in `before` and those that are made now."""
    certificate = json.loads((before / CERTIFICATE).read_bytes())
    formats = tuple(dict.fromkeys(each["format"] for each in certificate["files"]))
    now = work / "now" / scene.stem
    now.parent.mkdir(parents=True, exist_ok=True)
    trouble = build(scene, now, formats, env)
    if trouble:
        return [f"not built: {trouble}"]
    old, new = content(before), content(now)
    found = [f"{name}: only before" for name in old.keys() - new.keys()]
    found += [f"{name}: only now" for name in new.keys() - old.keys()]
    return found + [f"{name}: differs" for name in old if name in new and old[name] != new[name]]


def tree_of(revision: str, folder: Path) -> Path:
    """The tree of a revision, unpacked below `folder`."""
    packed = subprocess.run(
        ("git", "archive", revision), cwd=ROOT, capture_output=True, check=True
    ).stdout
    with tarfile.open(fileobj=io.BytesIO(packed)) as archive:
        archive.extractall(folder, filter="data")
    return folder


def main() -> int:
    """Build, compare, print what differs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--against", metavar="REV", required=True)
    parser.add_argument("--keep", metavar="FOLDER", type=Path)
    parser.add_argument("scenes", metavar="SCENE", nargs="*", type=Path)
    arguments = parser.parse_args()
    bad = 0
    with tempfile.TemporaryDirectory() as temporary:
        work = Path(temporary)
        (work / "here").mkdir()
        here = environment(ROOT, work / "here")
        earlier: dict[str, str] = {}
        keep: Path = (arguments.keep or work / "before").resolve()
        for scene in [each.resolve() for each in arguments.scenes] or scenes(arguments.against):
            before = keep / scene.parent.name / scene.stem
            if not (before / CERTIFICATE).exists():
                if not earlier:
                    tree = tree_of(arguments.against, work / "tree")
                    earlier = environment(tree, work / "earlier")
                before.parent.mkdir(parents=True, exist_ok=True)
                build_all(scene, before, earlier)
            found = compare(scene, before, here, work)
            bad += bool(found)
            count = len(list(before.iterdir()))
            print(f"{scene.stem:24} {count:3} files {'; '.join(found) or 'same'}", flush=True)
    return 1 if bad else 0


if __name__ == "__main__":
    raise SystemExit(main())
