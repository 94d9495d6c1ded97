"""Writes docs/laws.md and its pictures: `python docs/laws_page.py`, with camgeo-export installed.

The texts are in docs/laws, one file a family; what stands in them as `<!-- word -->` is put in from
the code: tables of characteristic values, of choice, of misprints, and pictures. A test holds the
page to the texts and to the code; the pictures are renewed by running this and are not compared,
for their bytes depend on matplotlib's version too.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from camgeo.kinematics.laws import ALIASES, FAMILIES, make_law
from camgeo.kinematics.laws.law import Law, characteristic
from camgeo.kinematics.motion import ENDS, NAMES, TASKS
from camgeo.kinematics.planning.build import best_law, criterion_size, equal_accelerations
from camgeo.kinematics.planning.requests import CRITERIA
from camgeo.numeric.extremes import Extreme

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HERE = Path(__file__).parent
PAGE = HERE / "laws.md"
TEXTS = HERE / "laws"
PICTURES = HERE / "images" / "laws"
MISPRINTS = HERE.parent / "fixtures" / "tables" / "errata.csv"

NOTE = "<!-- Made from docs/laws and from camgeo by docs/laws_page.py; change it there. -->\n"

BEFORE = ("conventions", "choice")
AFTER = ("data", "auto", "errata")
"""Texts before and after those of the families."""

GENERAL = ("polynomial-5", "polynomial-7", "polynomial")
"""Families that are described outside the table of tasks."""

Parameters = Mapping[str, float]

BOUNDARY: dict[str, Parameters] = {
    "R-R": {},
    "R-G": {"v1": 2.0},
    "R-U": {"a1": -5.0},
    "R-B": {"v1": 2.0, "a1": 2.0},
    "G-R": {"v0": 2.0},
    "G-G": {"v0": 0.5, "v1": 1.5},
    "G-U": {"v0": 0.5, "a1": -5.0},
    "G-B": {"v0": 0.5, "v1": 1.5, "a1": 2.0},
    "U-R": {"a0": 5.0},
    "U-G": {"a0": 5.0, "v1": 0.5},
    "U-U": {"a0": 6.0, "a1": -6.0},
    "U-B": {"a0": 2.0, "v1": 2.0, "a1": 2.0},
    "B-R": {"v0": 2.0, "a0": -2.0},
    "B-G": {"v0": 1.5, "a0": -2.0, "v1": 0.5},
    "B-U": {"v0": 2.0, "a0": -2.0, "a1": -2.0},
    "B-B": {"v0": 1.0, "a0": 2.0, "v1": 1.0, "a1": -2.0},
}
"""Boundary values at which the page compares laws, for each task."""

FURTHER: dict[str, dict[str, tuple[Parameters, ...]]] = {
    "modified-sine": {"R-G": ({"v1": 1.0},), "G-R": ({"v0": 1.0},)},
    "modified-trapezoid": {"R-U": ({"inflection": 0.526294328940461},)},
    "harmonic-combination": {"R-U": ({"inflection": 0.528787514567007},)},
    "sine-straight": {"U-U": ({"curved": 0.25}, {"curved": 0.75})},
    "polynomial": {
        "B-B": (
            {"v0": 0.0, "v1": 0.0},
            {"v0": 0.0, "a0": 0.0, "v1": 0.0},
            {"v0": 0.0, "a0": 0.0, "v1": 0.0, "a1": -5.0},
            {"v0": 0.0, "a0": 0.0, "j0": 0.0, "v1": 0.0, "a1": 0.0},
        )
    },
}
"""More examples than the one of each task."""

MEMBERS: dict[str, Parameters] = {
    "modified sine": {"sine": 0.25, "cosine": 0.75},
    "modified trapezoid": {"sine": 0.25, "cosine": 0.25},
    "cycloidal (inclined sine)": {"sine": 0.5, "cosine": 0.5},
    "parabola": {"sine": 0.0, "cosine": 0.0},
    "simple sine": {"sine": 0.0, "cosine": 1.0},
    "modified trapezoid, longer flanks": {"sine": 1.0 / 3.0, "cosine": 1.0 / 3.0},
    "modified sine, 20 % straight": {"sine": 0.25, "cosine": 0.75, "curved": 0.8},
    "modified sine, 50 % straight": {"sine": 0.25, "cosine": 0.75, "curved": 0.5},
    "modified trapezoid, 20 % straight": {"sine": 0.25, "cosine": 0.25, "curved": 0.8},
    "cycloidal, 50 % straight": {"sine": 0.5, "cosine": 0.5, "curved": 0.5},
    "simple sine, 50 % straight": {"sine": 0.0, "cosine": 1.0, "curved": 0.5},
}
"""Members of the SCCA family that have names, and some with a straight stretch."""

DRAWN: dict[str, tuple[tuple[str, Parameters], ...]] = {
    "modified-sine": (
        ("R-R", {}),
        ("R-R", {"inflection": 0.35}),
        ("R-G", {"v1": 2.0}),
        ("G-G", {"v0": 0.5, "v1": 1.5}),
    ),
    "scca": tuple(
        ("R-R", MEMBERS[name])
        for name in (
            "modified trapezoid",
            "modified sine",
            "cycloidal (inclined sine)",
            "modified sine, 50 % straight",
        )
    ),
    "simple-sine": (("R-R", {}), ("U-U", {"inflection": 0.35})),
    "sine-straight": (
        ("U-U", {"curved": 1.0}),
        ("U-U", {"curved": 0.5}),
        ("U-U", {"curved": 0.25}),
    ),
    "polynomial": tuple(("B-B", given) for given in FURTHER["polynomial"]["B-B"]),
    **{
        name: tuple((task, BOUNDARY[task]) for task in ("R-R", "U-U", "R-B", "G-G"))
        for name in ("polynomial-5", "polynomial-7")
    },
}
"""What a picture shows, where it is not the first example of each task."""


def page() -> str:
    """The page's text."""
    head, *rest = (_section(name) for name in (*BEFORE, *FAMILIES, *AFTER))
    title, _, below = head.partition("\n")
    return f"{title}\n\n{NOTE}{below}" + "".join(f"\n{text}" for text in rest)


def _section(name: str) -> str:
    """A text with its insertions."""
    text = (TEXTS / f"{name}.md").read_text(encoding="utf-8")

    def put(match: re.Match[str]) -> str:
        word, *arguments = match[1].split()
        return INSERTS[word](name, *arguments)

    return re.sub(r"<!-- (.*?) -->\n", put, text)


# What is put in ---------------------------------------------------------------------------------


def _picture(family: str) -> str:
    alt = f"f, f', f'', f''' of {family} over z"
    return f"![{alt}](images/laws/{family}.svg)\n"


def examples(family: str) -> list[tuple[str, Parameters]]:
    """The tasks of a family, each with the parameters that the page shows."""
    found: list[tuple[str, Parameters]] = []
    further = FURTHER.get(family, {})
    for task, taken in FAMILIES[family].parameters.items():
        found.append((task, _given(taken, task)))
        found += [
            (task, given if family == "polynomial" else {**_given(taken, task), **given})
            for given in further.get(task, ())
        ]
    return found


def _given(taken: Sequence[str], task: str) -> Parameters:
    """Example values; a turn's acceleration only where no inflection point decides it."""
    return {
        key: value
        for key, value in BOUNDARY[task].items()
        if key in taken and not (key[0] == "a" and "inflection" in taken)
    }


def _values(family: str) -> str:
    rows = [
        [task, _parameters(given), *_cells(make_law(family, task, **given))]
        for task, given in examples(family)
    ]
    return _law_table(["task", "parameters"], rows)


def _members(family: str) -> str:
    rows = [
        [label, _parameters(given), *_cells(make_law(family, "R-R", **given))]
        for label, given in MEMBERS.items()
    ]
    return _law_table(["member", "parameters"], rows)


def _law_table(first: list[str], rows: list[list[str]]) -> str:
    heads = [*first, "C_v", "C_a", "C_a*", "C_j", "C_j*", "C_Mdyn", "C_Mdyn*", "f'' jumps at"]
    if all(row[-1] == "–" for row in rows):
        heads, rows = heads[:-1], [row[:-1] for row in rows]
    if not any(row[1] for row in rows):
        heads, rows = [heads[0], *heads[2:]], [[row[0], *row[2:]] for row in rows]
    return _table(heads, rows)


def _cells(law: Law) -> list[str]:
    values = characteristic(law)
    extremes = (
        values.velocity,
        values.acceleration,
        values.deceleration,
        values.jerk,
        values.braking_jerk,
        values.moment,
        values.braking_moment,
    )
    jumps = ", ".join(_place(z) for z in jumps_of(law, 2))
    shocks = ", ".join(_place(z) for z in jumps_of(law, 1))
    jumps_text = f"shock (f' jumps) at {shocks}" if shocks else jumps or "–"
    return [*(_extreme(extreme) for extreme in extremes), jumps_text]


def jumps_of(law: Law, order: int) -> list[float]:
    """z at which f' (1) or f'' (2) of a law jumps, what its task has beyond the ends included."""
    places = [0.0, *law.borders, 1.0]
    near = 1e-9
    limits = []
    for z in places:
        left, right = (law(np.array([min(max(z + side, 0.0), 1.0)])) for side in (-near, near))
        limits.append([float(left[order][0]), float(right[order][0])])
    # An end that the task leaves open is met by the neighbour.
    open_ends = {1: "GB", 2: "UB"}[order]
    if law.task[0] not in open_ends:
        limits[0][0] = 0.0
    if law.task[-1] not in open_ends:
        limits[-1][1] = 0.0
    size = max(abs(value) for pair in limits for value in pair)
    return [
        z
        for z, (left, right) in zip(places, limits, strict=True)
        if abs(right - left) > 1e-3 * max(size, 1.0)
    ]


def _extreme(extreme: Extreme) -> str:
    return f"{_number(extreme.value)} ({_place(extreme.place)})"


def _number(value: float) -> str:
    """Four digits, and more where they stand before the point."""
    if abs(value) < 5e-13:
        return "0"
    text = f"{value:.4g}" if abs(value) < 1e4 else f"{value:.0f}"
    return text.replace("-", "−")


def _place(z: float) -> str:
    return f"{z:.4f}".rstrip("0").rstrip(".")


def _parameters(given: Parameters) -> str:
    return ", ".join(f"{key} = {_number(value)}" for key, value in given.items())


def _table(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    cells = [list(heads)]
    lines = [_row(cells[0]), "|" + "---|" * len(cells[0])]
    lines += [_row(row) for row in rows]
    return "\n".join(lines) + "\n"


def _row(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _tasks(_name: str) -> str:
    """Tafel 1: which families are made for which task."""

    def made(task: str) -> str:
        names = [name for name, family in FAMILIES.items() if task in family.tasks]
        own = [name for name in names if name not in GENERAL]
        return "<br>".join(f"`{name}`" for name in own) or "polynomials"

    rows = [
        [f"**{start}** {NAMES[start]}", *(made(f"{start}-{end}") for end in ENDS)] for start in ENDS
    ]
    return _table(["from \\ to", *(f"**{end}** {NAMES[end]}" for end in ENDS)], rows)


def _choice(_name: str, task: str, *values: str) -> str:
    """The laws for a task without jumps of f'', with the smallest of each value in bold.

    `values` are boundary values in place of those of `BOUNDARY`, as "v1=1".
    """
    known = {key: float(value) for key, value in (text.split("=") for text in values)}
    compared = _compared(task, {**BOUNDARY[task], **known})
    sizes = [
        [criterion_size(characteristic(law), name) for name in CRITERIA] for _, law in compared
    ]
    best = [min(column) for column in zip(*sizes, strict=True)]
    rows = []
    for (given, law), row in zip(compared, sizes, strict=True):
        cells = [
            f"**{_number(size)}**" if size <= least * (1.0 + 1e-9) else _number(size)
            for size, least in zip(row, best, strict=True)
        ]
        rows.append([f"`{law.name}`", _parameters(given), *cells])
    heads = ["law", "parameters", "largest f'", "f''", "f'''", "f' f''"]
    if all(not row[1] for row in rows):
        heads, rows = [heads[0], *heads[2:]], [[row[0], *row[2:]] for row in rows]
    return _table(heads, rows)


def _compared(task: str, known: Parameters) -> list[tuple[Parameters, Law]]:
    """Laws with their parameters; a turn is as the law has it, with both parts equally hard."""
    found: list[tuple[Parameters, Law]] = []
    for name, family in FAMILIES.items():
        # SCCA has the modified sine for its default; it has a table of its own.
        if task not in family.tasks or name in ("polynomial", "scca"):
            continue
        taken = family.parameters[task]
        given = {
            key: value
            for key, value in known.items()
            if key in taken and not (key[0] == "a" and "inflection" in taken)
        }
        if "inflection" in taken and task != "R-R":
            given["inflection"] = equal_accelerations(name, task, given)
        law = make_law(name, task, **given)
        met = {"v0": law.start.velocity, "v1": law.end.velocity}
        fits = all(abs(value - known.get(key, 0.0)) < 1e-9 for key, value in met.items())
        if fits and not jumps_of(law, 1) and not jumps_of(law, 2):
            found.append((given, law))
    return found


def _auto(_name: str) -> str:
    """What `auto` picks, by task and by what is kept small."""
    rows = []
    for task in TASKS:
        known = {**dict.fromkeys(("v0", "a0", "v1", "a1"), 0.0), **BOUNDARY[task]}
        laws = [best_law(task, known, {}, {name: 1.0}) for name in CRITERIA]
        rows.append([task, _parameters(BOUNDARY[task]), *(f"`{law.name}`" for law in laws)])
    return _table(["task", "boundary values", *CRITERIA], rows)


def _misprints(_name: str) -> str:
    """The misprinted cells that are not the shifted digit of one column."""
    with MISPRINTS.open(encoding="utf-8", newline="") as stream:
        cells = [row for row in csv.DictReader(stream) if not _shifted(row)]
    titles = {
        "poly345": "3-4-5 polynomial",
        "inclined_sine": "inclined sine",
        "mod_acc_trapezoid": "modified trapezoid",
        "mod_sine": "modified sine",
    }
    columns = {"f": "f", "f1": "f'", "f2": "f''"}
    return _table(
        ["table", "z", "column", "printed", "correct"],
        (
            [
                titles[row["table"]],
                row["z"],
                columns[row["column"]],
                row["printed"].replace("-", "−"),
                row["correct_rounded"].replace("-", "−"),
            ]
            for row in cells
        ),
    )


def _shifted(row: Mapping[str, str]) -> bool:
    return abs(float(row["printed"]) - float(row["correct_rounded"])) > 0.5


def _aliases(_name: str) -> str:
    return "".join(f"`{alias}` is another name of `{name}`.\n" for alias, name in ALIASES.items())


INSERTS: dict[str, Callable[..., str]] = {
    "picture": _picture,
    "values": _values,
    "members": _members,
    "tasks": _tasks,
    "choice": _choice,
    "auto": _auto,
    "misprints": _misprints,
    "aliases": _aliases,
}


# Pictures ---------------------------------------------------------------------------------------

SIZE = (7.6, 4.9)
"""Width and height of a picture [inch]."""

POINTS = 481
"""Places of each region at which a curve is drawn, before matplotlib leaves out what is straight;
it does that for paths of more than 128 points."""

BESIDE = 0.06
"""How much of the neighbours is shown, in z."""

ROOM = 0.5
"""Least reach of an arrow, as a multiple of what the curves need on the other side of zero."""

STYLES: tuple[dict[str, Any], ...] = (
    {"color": "#12365c", "linestyle": "-", "linewidth": 1.7},
    {"color": "#c2571a", "linestyle": (0, (6, 2)), "linewidth": 1.5},
    {"color": "#2f8a57", "linestyle": (0, (2, 1.4)), "linewidth": 1.5},
    {"color": "#8a8a8a", "linestyle": (0, (7, 1.6, 1.4, 1.6)), "linewidth": 1.5},
)
"""Line styles, which differ in their dashes and also in lightness."""


def drawn(family: str) -> tuple[tuple[str, Parameters], ...]:
    """What the picture of a family shows: tasks and parameters, four at most."""
    if family in DRAWN:
        return DRAWN[family]
    first = {task: (task, given) for task, given in reversed(examples(family))}
    shown = tuple(reversed(first.values()))
    if len(shown) == 1 and "inflection" in FAMILIES[family].parameters.get("R-R", ()):
        return (*shown, ("R-R", {"inflection": 0.35}))
    return shown


def picture(family: str) -> str:
    """The picture of a family as SVG."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    from camgeo_export.plots import RC

    with rc_context(
        {**RC, "svg.hashsalt": "camgeo", "font.size": 8.5, "path.simplify_threshold": 0.2}
    ):
        figure = Figure(figsize=SIZE)
        FigureCanvasSVG(figure)
        panels = figure.subplots(
            2, 2, sharex=True,
            gridspec_kw={
                "left": 0.07, "right": 0.985, "bottom": 0.16, "top": 0.955,
                "hspace": 0.16, "wspace": 0.17,
            },
        )  # fmt: skip
        laws = [make_law(family, task, **given) for task, given in drawn(family)]
        for order, panel in enumerate(panels.flat):
            _draw(panel, laws, order)
        lines = panels[0, 0].get_lines()
        names = {repr(given): name for name, given in MEMBERS.items()}
        labels = [
            names[repr(given)] if family == "scca" else f"{task}  {_parameters(given)}"
            for task, given in drawn(family)
        ]
        wanted = [line for line in lines if line.get_gid() == "law"]
        figure.legend(
            wanted, labels, loc="lower center", ncols=2 if len(labels) > 1 else 1,
            frameon=False, handlelength=4.0, bbox_to_anchor=(0.5, -0.008),
        )  # fmt: skip
        for line in wanted:
            line.set_gid(None)
        stream = io.StringIO()
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": "camgeo"})
    return _lighter(stream.getvalue())


def _lighter(svg: str) -> str:
    """Two decimals of a point are finer than a print; no line ends with a space."""
    svg = re.sub(r"-?\d+\.\d{4,}(?=[ \"\n])", lambda match: _decimals(match[0]), svg)
    svg = re.sub(r"\n([LQ]) ", r"\1", svg)  # one line a path
    return re.sub(r"^ +| +$", "", svg, flags=re.MULTILINE)


def _decimals(number: str) -> str:
    return f"{float(number):.2f}".rstrip("0").rstrip(".")


def _draw(panel: Axes, laws: Sequence[Law], order: int) -> None:
    panel.axhline(0.0, color="#4d4d4d", linewidth=0.7)
    for law, style in zip(laws, STYLES, strict=False):
        z, values = _curve(law, order)
        panel.plot(z, values, gid="law", **style)
    panel.set_xlim(-BESIDE, 1.0 + BESIDE)
    panel.set_xticks([0.0, 0.25, 0.5, 0.75, 1.0], ["0", "0.25", "0.5", "0.75", "1"])
    panel.set_title("f" + "′" * order, loc="left", pad=3.0)
    if order >= 2 and not any(law(np.linspace(0.0, 1.0, POINTS))[order].any() for law in laws):
        panel.set_ylim(-1.0, 1.0)
        panel.set_yticks([0.0])
    arrows = [
        (place, _rises(law, place, order - 1), style["color"])
        for law, style in zip(laws, STYLES, strict=False)
        for place in (jumps_of(law, order - 1) if order >= 2 else ())
    ]
    low, high = panel.get_ylim()
    if any(up for _, up, _ in arrows):
        high = max(high, -ROOM * low)
    if not all(up for _, up, _ in arrows):
        low = min(low, -ROOM * high)
    panel.set_ylim(low, high)
    for place, up, color in arrows:
        panel.annotate(
            "", (place, 0.97 * (high if up else low)), (place, 0.0),
            arrowprops={
                "arrowstyle": "->", "color": color, "linewidth": 1.1,
                "shrinkA": 0.0, "shrinkB": 0.0,
            },
        )  # fmt: skip
    if order >= 2:
        panel.set_xlabel("z", labelpad=1.0)


def _rises(law: Law, place: float, order: int) -> bool:
    left, right = (float(law(np.array([_inside(place + s)]))[order][0]) for s in (-1e-9, 1e-9))
    if place == 0.0:
        return right > 0.0
    if place == 1.0:
        return left < 0.0
    return right > left


def _inside(z: float) -> float:
    return min(max(z, 0.0), 1.0)


def _curve(law: Law, order: int) -> tuple[Any, Any]:
    """A derivative over z, both sides of each border, with what precedes and follows the move."""
    marks = [0.0, *law.borders, 1.0]
    pieces = [np.linspace(a + 1e-12, b - 1e-12, POINTS) for a, b in pairwise(marks)]
    z = np.concatenate(pieces)
    values = law(z)[order]
    ends = law.start, law.end
    for number, end in enumerate(ends):
        if law.task[-number] not in "RG" or (order == 3 and jumps_of(law, 2)):
            continue
        place = float(number)
        beyond = place + (BESIDE if number else -BESIDE)
        speed = end.velocity if law.task[-number] == "G" else 0.0
        at_end, at_beyond = {
            0: (place, place + speed * (beyond - place)),
            1: (speed, speed),
        }.get(order, (0.0, 0.0))
        pair = np.array([at_end, at_beyond]), np.array([place, beyond])
        if number:
            z, values = np.append(z, pair[1]), np.append(values, pair[0])
        else:
            z, values = np.append(pair[1][::-1], z), np.append(pair[0][::-1], values)
    return z, values


def write() -> None:
    """Write the page and the pictures."""
    PAGE.write_text(page(), encoding="utf-8")
    PICTURES.mkdir(parents=True, exist_ok=True)
    for name in FAMILIES:
        (PICTURES / f"{name}.svg").write_text(picture(name), encoding="utf-8")


if __name__ == "__main__":
    write()
