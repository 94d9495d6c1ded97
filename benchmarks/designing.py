"""CPU time of what the live designer computes for a change, against all findings of the same scene.

In one warm process, scene by scene, each round in alternating order, after an edit that makes the
strokes of the motion a little longer, or the base circle, the roller or the arm a little larger, as
a drag does:

- "moved": the text changed and what is painted of it during a drag, as JSON;
- "painted": everything that is painted of it, without the change of the text and the form;
- "findings": the findings with next steps and places, without milling programs, as JSON;
- "judged": `Design.findings` of the scene made of that text, which the others are multiples of.

The medians of the rounds and of their ratios are reported, with the bytes of the JSON of what is
painted, and the geometric means of the ratios.


    python benchmarks/designing.py [--rounds 15] [SCENE ...]
"""

from __future__ import annotations

import argparse
import json
import platform
import statistics
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np

from camgeo.app.designing.children import Job
from camgeo.app.designing.work import Recent, painted, prepared
from camgeo.design.design import Design
from camgeo.scene.scene import parse_scene

ROOT: Final = Path(__file__).resolve().parents[1]

SCENES: Final = sorted((ROOT / "fixtures" / "scenes").glob("*.toml"))

WAYS: Final = ("plan", "sizes")

NAMES: Final = ("moved", "painted", "findings")


def edits(values: Mapping[str, Any], way: str, number: int) -> dict[str, Any]:
    """Values by key for a drag; none if the scene has nothing to drag."""
    factor = 1.0 + 1e-6 * number
    if way == "plan":
        places = enumerate(values["motion"], start=1)
        found = {
            f"motion[{k}].to": float(each["to"]) * factor for k, each in places if "to" in each
        }
        return found if any(found.values()) else {}
    follower = values["follower"]
    key = next(k for k in ("base_radius", "roller_radius", "arm") if k in follower)
    return {f"follower.{key}": float(follower[key]) * factor}


def timed(make: Callable[[], Any]) -> tuple[float, int]:
    """CPU time [s] of a result with its JSON, and the size of that in bytes."""
    began = time.process_time()
    text = json.dumps(make(), separators=(",", ":"))
    return time.process_time() - began, len(text)


def judged(text: str, file: str) -> list[str]:
    """The findings of the scene."""
    return [each.sentence for each in Design(parse_scene(text, file)).findings]


def drawn(job: Job, recent: Recent) -> Callable[[], Any]:
    """What paints the scene of a job."""
    return lambda: painted(recent.design(job), recent)


def measure(
    run: Callable[[Job], dict[str, Any]], path: Path, rounds: int
) -> dict[tuple[str, str], float]:
    """Print the row of one scene; the ratio of each way and name."""
    file, stated = str(path), path.read_text("utf-8")
    values = parse_scene(stated, file).values
    cells, found, size = "", {}, 0
    for way in WAYS:
        text, recent = stated, Recent()
        times: dict[str, list[float]] = {name: [] for name in (*NAMES, "judged")}
        for number in range(rounds + 1):
            asked = {"edits": edits(values, way, number), "moving": True}
            change = Job("change", text, file, "", asked)
            if not asked["edits"]:
                break
            took = {"moved": timed(partial(run, change))}
            text = run(change)["text"]
            job = Job("findings", text, file, "", {"machining": False})
            makers: dict[str, Callable[[], Any]] = {
                "painted": drawn(job, recent),
                "findings": partial(run, job),
                "judged": partial(judged, text, file),
            }
            for name in sorted(makers, reverse=bool(number % 2)):
                took[name] = timed(makers[name])
            if number:  # the first round loads
                for name, (seconds, _) in took.items():
                    times[name].append(seconds)
                size = took["painted"][1]
        if not times["judged"]:
            cells += f"{'-':>9}" * (2 * len(NAMES) + 1)
            continue
        cells += f"{1e3 * statistics.median(times['judged']):9.1f}"
        for name in NAMES:
            ratio = statistics.median(
                one / other for one, other in zip(times[name], times["judged"], strict=True)
            )
            found[way, name] = ratio
            cells += f"{1e3 * statistics.median(times[name]):9.1f}{ratio:9.2f}"
    print(f"{path.stem:<20}{cells}{size:9d}", flush=True)
    return found


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", type=Path, default=SCENES)
    parser.add_argument("--rounds", type=int, default=15)
    arguments = parser.parse_args()
    print(
        f"Python {platform.python_version()}, numpy {np.__version__}, {platform.machine()};"
        f" CPU ms, median of {arguments.rounds} rounds, and as a multiple of the findings"
    )
    heads = "".join(f"{name:>9}{'ratio':>9}" for name in NAMES)
    print(f"{'':<20}" + f"{'judged':>9}{heads}" * len(WAYS) + f"{'bytes':>9}")
    run = prepared()
    rows = [measure(run, path.resolve(), arguments.rounds) for path in arguments.scenes]
    means = ""
    for way in WAYS:
        means += f"{'':9}"
        for name in NAMES:
            mean = statistics.geometric_mean(row[way, name] for row in rows if (way, name) in row)
            means += f"{mean:18.2f}"
    print(f"{'geometric mean':<20}{means}")


if __name__ == "__main__":
    main()
