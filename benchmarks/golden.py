"""Bytes of every file and the answer of every command, compared with those of an earlier revision.

Both are made in this run. Each scene of all folders of fixtures is built in every format that
pyproject.toml declares and that it can be written in, and with each machine profile where it is
milled; its report, setup sheet, pictures and tables are written, and what the commands answer is
kept as JSON. What is asked without a scene follows. What the earlier tree lacks is left out.

What may differ is masked: hashes (the identity of the scene is in the files, and changes their own
ones), the size of a 3MF file, which contains one in compressed form, and measured seconds. JSON is
compared key by key. Exits with 1 if anything else differs.

    python benchmarks/golden.py --against REV [--keep FOLDER] [--processes N] [SCENE ...]

`--keep` holds the earlier answers for the next run against the same revision.
"""

from __future__ import annotations

import argparse
import io
import itertools
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
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

ROOT: Final = Path(__file__).resolve().parents[1]

PROFILES: Final = ("fanuc", "grbl", "haas", "heidenhain", "linuxcnc", "mach3", "sinumerik")

HASH: Final = re.compile(
    rb"(?<![0-9a-f])[0-9a-f]{64}(?![0-9a-f])|(?<=sha256[ :])[0-9a-f]{12,}|(?<=sha256-)[\w+/]{43}="
)

SIZE: Final = re.compile(rb'("format": "3mf",\s+"sha256": "0+",\s+"bytes": )\d+')

MACHINE: Final = re.compile(r'^machine = ".*"$', re.MULTILINE)

MEASURED: Final = re.compile(r"(.*_)?seconds|spread|sha256")
"""Keys of what is measured anew in each run, and of hashes."""

TIME: Final = re.compile(r"[\d.]+ m?s\b")
"""A measured time in a sentence."""

WITH_TIMES: Final = ("explain", "accuracy", "sweep", "optimise")
"""Commands whose JSON has measured times."""

CERTIFICATE: Final = "certificate.json"

ANSWER, SAID, CODE = "answer.txt", "said.txt", "code.txt"
"""Files with what a command printed, with its notes, and its exit code."""

BARE: Final = {
    **{f"machine {name}": f"machines {name} --json" for name in PROFILES},
    "machines": "machines --json",
    "laws": "laws --task all --json",
    "laws, places": "laws --places --json",
    "table of a law": "table --law modified-sine --step 0.05 --json",
    "printed table": "table --law modified-sine --step 0.1 --printed",
    "slotted lever": "slotted-lever --frame 150 --swing 60 --speed 90 --json",
    "import": "import {fixtures}/reference/ocv/setzhub.ocv -o {out}/setzhub.toml",
    "compare": "compare {fixtures}/scenes/inch.toml {fixtures}/scenes/tappet.toml --json",
    "sweep": "sweep {fixtures}/scenes/setzhub.toml --vary follower.base_radius=45:56:4 "
    "--ask transmission-angle,peak:kappa,diameter,verdict --json -o {out}/rows.csv",
    "optimise": "optimise {fixtures}/scenes/setzhub.toml --vary follower.base_radius=45:56 "
    "--least diameter --keep transmission-angle>=42 --evaluations 20 --json -o {out}/best.toml",
    "accuracy": "accuracy {fixtures}/scenes/tappet.toml --tolerances 1e-1,1e-2 --ripple --json",
    "tolerance": "tolerance {fixtures}/tolerance/lever.toml --count 128 --json",
    "tolerance of a pair": "tolerance {fixtures}/tolerance/pair.toml --count 0 --json",
}
"""Calls without a scene of their own; scenes to start from follow."""


def scene_calls(scene: Path, text: str, folder: Path) -> dict[str, str]:
    """The calls for a scene, by name, in an order in which later ones may read earlier files."""
    calls = {
        "check": "check {scene} --json",
        "check, text": "check {scene}",
        "build": "build {scene} -o {out} --force --only {formats}",
        "verify": "verify {all}/build --scene {scene} --json -o {out}/verification.json",
        "table": "table {scene} --step 5 -o {out}/table.csv",
        "table, JSON": "table {scene} --step 30 --json",
        "size": "size {scene} --json",
        "explain": "explain {scene} build --json",
        "report": "report {scene} --quick -o {out}/report.html",
        "report, JSON": "report {scene} --quick --json",
        "replay": "replay {scene} --step 10 --json",
        "probe": "probe {scene} --step 10 -o {out}/points.csv --json",
        "inspect": "inspect {scene} {all}/probe/points.csv --align free --json",
        "plot": "plot {scene} -o {out}/plot.svg",
    }
    if MACHINE.search(text):
        calls |= {
            "setup": "setup {scene} -o {out}/setup.html",
            "setup, JSON": "setup {scene} --json",
        }
        for name in PROFILES:
            copy = with_machine(scene, text, name, folder)
            calls[f"gcode for {name}"] = f"build {copy} -o {{out}} --force --only gcode"
    return calls


def with_machine(scene: Path, text: str, name: str, folder: Path) -> Path:
    """The scene with another machine, beside what it may name."""
    place = folder / name
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    for each in scene.parent.iterdir():
        if each.suffix != ".toml":
            (place / each.name).symlink_to(each)
    copy = place / scene.name
    copy.write_text(MACHINE.sub(f'machine = "{name}"', text), "utf-8")
    return copy


@dataclass(frozen=True, slots=True)
class Tree:
    """A checkout whose commands are called, with the formats that it declares."""

    env: Mapping[str, str]
    formats: tuple[str, ...]

    @classmethod
    def of(cls, root: Path, folder: Path) -> Tree:
        """With the entry points of its pyproject.toml, as if it were installed."""
        project = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["project"]
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
        path = os.pathsep.join(map(str, (folder, root, root / "export")))
        env = {**os.environ, "PYTHONPATH": path}
        env.pop("PYTHONDONTWRITEBYTECODE", None)
        return cls(env, tuple(groups["camgeo.writers"]))

    def call(self, words: str, out: Path, **places: object) -> int:
        """Run a command; what it prints and writes lies in `out`."""
        out.mkdir(parents=True)
        given = {"out": out, "all": out.parent, "fixtures": ROOT / "fixtures", **places}
        done = subprocess.run(
            (sys.executable, "-m", "camgeo", *(word.format(**given) for word in words.split())),
            env=self.env, cwd=out, capture_output=True, check=False,
        )  # fmt: skip
        (out / ANSWER).write_bytes(done.stdout)
        (out / SAID).write_bytes(done.stderr)
        (out / CODE).write_text(f"{done.returncode}\n", "utf-8")
        return done.returncode

    def call_all(self, calls: Mapping[str, str], place: Path, scene: Path | None = None) -> None:
        """All calls, each into a folder of its name; of formats those that can be written."""
        for name, words in calls.items():
            out = place / name
            if "{formats}" not in words:
                self.call(words, out, scene=scene)
                continue
            if self.call(words, out, scene=scene, formats=",".join(self.formats)) == 0:
                continue
            possible = [
                each
                for each in self.formats
                if not self.call(words, out / f"only {each}", scene=scene, formats=each)
            ]
            shutil.rmtree(out)
            self.call(words, out, scene=scene, formats=",".join(possible) or "dxf")


def masked(path: Path, hashes: list[bytes], folders: list[bytes]) -> bytes:
    """The content of a file without what may differ."""
    data = path.read_bytes()
    if path.suffix == ".3mf":
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            data = b"".join(name.encode() + archive.read(name) for name in archive.namelist())
    for folder in folders:
        data = data.replace(folder, b"...")
    for each in hashes:
        for digits in range(64, 7, -1):  # a file may name the first digits alone
            data = data.replace(each[:digits], b"0" * digits)
    return SIZE.sub(rb"\1?", HASH.sub(b"0" * 64, data))


def leaves(data: Any, measured: bool, way: str = "") -> Iterator[tuple[str, str]]:
    """The values of a JSON document by their keys, without what is measured."""
    if isinstance(data, dict):
        for key, each in data.items():
            if not (measured and MEASURED.fullmatch(key)):
                yield from leaves(each, measured, f"{way}.{key}" if way else key)
    elif isinstance(data, list):
        for number, each in enumerate(data):
            yield from leaves(each, measured, f"{way}[{number}]")
    else:
        text = json.dumps(data)
        yield way, TIME.sub("...", text) if measured else text


def differing(name: str, before: bytes, after: bytes) -> str:
    """Where two files or answers differ first; "" if they do not."""
    if before == after:
        return ""
    measured = name.startswith(WITH_TIMES)
    try:
        old, new = (list(leaves(json.loads(each), measured)) for each in (before, after))
    except ValueError:
        pairs = itertools.zip_longest(before.splitlines(), after.splitlines())
        line, (one, other) = next(
            (n, each) for n, each in enumerate(pairs, 1) if each[0] != each[1]
        )
        return f"line {line}: {(one or b'')[:80]!r} became {(other or b'')[:80]!r}"
    for one, two in itertools.zip_longest(old, new, fillvalue=("nothing", "")):
        if one != two:
            return f"{' '.join(one)[:120]} became {' '.join(two)[:120]}"
    return ""


def files(place: Path) -> dict[str, bytes]:
    """What lies below a folder, by path, masked."""
    hashes = {
        json.loads(each.read_bytes())["scene"]["sha256"].encode()
        for each in place.rglob(CERTIFICATE)
    }
    folders = [str(place).encode(), str(ROOT).encode()]
    found = sorted(each for each in place.rglob("*") if each.is_file())
    return {
        each.relative_to(place).as_posix(): masked(each, sorted(hashes), folders) for each in found
    }


def compare(before: Path, after: Path) -> list[str]:
    """What differs between two folders."""
    old, new = files(before), files(after)
    found = [f"{name}: only before" for name in old.keys() - new.keys()]
    found += [f"{name}: only now" for name in new.keys() - old.keys()]
    for name in old.keys() & new.keys():
        what = differing(name, old[name], new[name])
        found += [f"{name}: {what}"] if what else []
    return sorted(found)


def tracked(revision: str) -> list[Path]:
    """The scenes of fixtures that both trees have."""
    listed = subprocess.run(
        ("git", "ls-tree", "-r", "--name-only", revision, "fixtures"),
        cwd=ROOT, capture_output=True, text=True, check=True,
    )  # fmt: skip
    found = (ROOT / each for each in listed.stdout.splitlines() if each.endswith(".toml"))
    return [each for each in found if each.is_file() and "[follower]" in each.read_text("utf-8")]


def tree_of(revision: str, folder: Path) -> Path:
    """The tree of a revision, unpacked below `folder`."""
    packed = subprocess.run(
        ("git", "archive", revision), cwd=ROOT, capture_output=True, check=True
    ).stdout
    with tarfile.open(fileobj=io.BytesIO(packed)) as archive:
        archive.extractall(folder, filter="data")
    return folder


def templates(earlier: Tree, folder: Path) -> dict[str, str]:
    """Calls for all scenes to start from, which the refusal of another one lists."""
    earlier.call("new none", folder / "new")
    _, listed = (folder / "new" / SAID).read_text("utf-8").split("choose from")
    kinds = re.findall(r"[a-z]+(?:-[a-z]+)*", listed)
    return {f"new {kind}": f"new {kind} -o {{out}}/scene.toml" for kind in kinds}


def main() -> int:
    """Call, compare, print what differs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--against", metavar="REV", required=True)
    parser.add_argument("--keep", metavar="FOLDER", type=Path)
    parser.add_argument("--processes", metavar="N", type=int, default=os.cpu_count() or 1)
    parser.add_argument("scenes", metavar="SCENE", nargs="*", type=Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        work = Path(temporary)
        here = Tree.of(ROOT, work / "here")
        earlier = Tree.of(tree_of(arguments.against, work / "tree"), work / "earlier")
        keep: Path = (arguments.keep or work / "before").resolve()
        scenes = [each.resolve() for each in arguments.scenes] or tracked(arguments.against)

        def judge(scene: Path | None) -> tuple[str, int, list[str]]:
            if scene is None:
                name, calls = "without a scene", BARE | templates(earlier, work / "kinds")
            else:
                name = "-".join(scene.relative_to(ROOT / "fixtures").with_suffix("").parts)
                text = scene.read_text("utf-8")
                calls = scene_calls(scene, text, keep / "machines" / name)
            before = keep / name
            if not (before / "whole").exists():
                shutil.rmtree(before, ignore_errors=True)
                earlier.call_all(calls, before, scene)
                (before / "whole").touch()
            now = work / "now" / name
            here.call_all(calls, now, scene)
            (now / "whole").touch()
            found = compare(before, now)
            count = sum(each.is_file() for each in now.rglob("*"))
            shutil.rmtree(now)
            return name, count, found

        bad = 0
        with ThreadPoolExecutor(arguments.processes) as pool:
            for name, count, found in pool.map(judge, [*scenes, *[None] * (not arguments.scenes)]):
                bad += bool(found)
                print(f"{name:40} {count:4} files {'' if found else 'same'}", flush=True)
                for each in found:
                    print(f"    {each}", flush=True)
    return 1 if bad else 0


if __name__ == "__main__":
    raise SystemExit(main())
