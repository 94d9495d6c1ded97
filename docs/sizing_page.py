"""Writes docs/sizing.md and its picture: `python docs/sizing_page.py`. A test holds the page."""

from __future__ import annotations

import math
import textwrap
from pathlib import Path
from typing import Final

import camgeo
from camgeo.check.judge import transmission_angle_limit
from camgeo.check.sizing.arm import size_with_arm
from camgeo.check.sizing.smallest import Rating, Sizing, rate, size
from camgeo.check.sizing.task import Task, task_of
from camgeo.design import Design

HERE: Final = Path(__file__).parent
PAGE: Final = HERE / "sizing.md"
PICTURE: Final = HERE / "images" / "size-schnitt.svg"
SCENE: Final = "fixtures/scenes/schnitt.toml"

ROLLERS: Final = (0.1, 1.0, 4.0)
"""Rollers of the table of arms, in times of the scene's."""

ARMS: Final = (40.0, 160.0)
"""Range of arms of that table [mm]."""

TEXT: Final = """# Sizing

How small may the cam be? `camgeo size` answers for the transmission angle and the ratio r_R/r_K
that a scene asks for under `[limits]`, or that the command is told:

```sh
camgeo size {scene} -o size.svg
```

![Where the cam axis may lie: the exact region, and Flocke's inside it](images/size-schnitt.svg)

*`{scene}`: the rocker in its starting position. Blue, where the cam axis may lie for a
transmission angle of {angle:g} degrees over the whole turn; hatched, Flocke's region; red, where
the roller is too large for the curvature of the pitch curve. The dashed circle is the smallest
base circle.*

| | r_G [mm] | l_1 [mm] | mu [deg] | r_R/r_K |
|---|---|---|---|---|
{rows}
This page is made by `python docs/sizing_page.py`.

## The region

Place the follower in its starting position and look for the cam axis P, a point of the plane. At
each cam angle the parts u and v of the pitch curve's tangent, across and along the follower, are
linear in P, and a transmission angle of at least mu is u >= tan(mu) |v|: two half-planes. All cam
angles together leave a convex region, and the smallest base circle belongs to its point nearest
to the roller centre. camgeo finds that point by exchange: the nearest point for some half-planes,
then those that it violates most join, whose cam angles are roots of a slope, until none is
violated.

Flocke's construction (Wirsig, section 2.4.1, with eqs. 2.41 and 2.42 corrected) takes the largest
velocities of both senses at both end positions, where they never are. Its region lies inside the
exact one: it always keeps the angle, with a base circle that is larger than need be. It knows
nothing of the curvature; where the rule r_R <= ratio r_K (eq. 3.36) asks for more than the angle,
its proposal is too small, and `camgeo size` says so.

## With the curvature

The places that keep r_R/r_K are no convex set, and there may be several places from which each
way leads farther out. So the whole plane is searched, by exclusion. A cell of places, a patch of
directions and distances seen from the roller centre, is left out when at one cam angle all of it
breaks a condition: u and v change inside a cell by no more than its half diagonal, which bounds
both conditions. The cells that are left are halved, up to a width of 1e-4 of their distance, as
long as they are nearer than the best place found. No place nearer than the bound that remains
keeps the conditions; the best place is then enclosed to the last digits from the neighbourhoods
that are left, and the cam angles at which it is extreme join the ones asked until it breaks none.
For the scene above the bound is {bound:.3f} mm, the answer {answer:.3f} mm.

## When there is no answer

A rocker that swings by psi_H cannot keep more than about 90 degrees - psi_H/2, wherever its cam
axis lies: then the region is empty, and the message tells the largest angle that can be kept. A
guide keeps any angle below 90 degrees. Where an angle below the limit can be kept the region
reaches to infinity, and far out the pitch curve is nearly a circle, so that any roller finds a
cam that is large enough: base circles are searched up to four times r_R/ratio plus the arm, and
at least up to 40 times that of the angle alone. If there is none up to there, the message says up
to where, and the least ratio that was found. All this holds behind a linkage too, which changes
the rocker's motion and nothing else.

## The arm

`--arm LOW HIGH` looks for the arm of an oscillating follower within a range too. The swing is
given, by the scene or by the linkage, and so all lengths of the mechanism scale with the arm: for
the transmission angle alone the smallest base circle is proportional to it, and the shortest arm
is the best. The roller does not scale. To a short arm it is a large one, and r_R/r_K decides; a
longer arm may then be better, which is why the range is searched, but none beyond the length at
which the transmission angle alone asks for as much. LOW is a matter of the design: the hub of the
pivot, the roller's pin, the force on them; it must exceed the roller radius. The table has the
best arm of {low:g} to {high:g} mm for the scene above with other rollers.

| roller radius [mm] | best arm [mm] | r_G [mm] | r_G, shortest arm | r_G, longest arm |
|---|---|---|---|---|
{arms}"""


def sized() -> tuple[Design, Task, Sizing]:
    """The scene of the page and its answer."""
    design = camgeo.load(HERE.parent / SCENE)
    task, limits = task_of(design.cam), design.scene.limits
    return design, task, size(task, transmission_angle_limit(task.cam, limits), limits.radius_ratio)


def page() -> str:
    """The text of docs/sizing.md."""
    _, task, sizing = sized()
    rated = {
        "present design": rate(task, task.present),
        "Flocke": sizing.flocke,
        "transmission angle alone, exact": sizing.for_angle,
        "both, exact": sizing.answer,
    }
    assert sizing.answer is not None
    text = TEXT.format(
        scene=SCENE,
        angle=math.degrees(sizing.angle),
        rows="".join(_row(name, rating) for name, rating in rated.items()),
        bound=sizing.none_below,
        answer=sizing.answer.base_radius,
        low=ARMS[0],
        high=ARMS[1],
        arms="".join(_arms(task, sizing, share) for share in ROLLERS),
    )
    return "\n\n".join(_wrapped(each) for each in text.split("\n\n"))


def _wrapped(paragraph: str) -> str:
    if paragraph.startswith(("#", "|", "```", "!")):
        return paragraph
    end = "\n" if paragraph.endswith("\n") else ""
    return textwrap.fill(paragraph, 100, break_on_hyphens=False, break_long_words=False) + end


def _row(name: str, rating: Rating | None) -> str:
    assert rating is not None
    mu, ratio = math.degrees(rating.transmission_angle[0]), rating.radius_ratio[0]
    lengths = f"{rating.base_radius:.3f} | {abs(rating.place):.3f}"
    return f"| {name} | {lengths} | {mu:.3f} | {ratio:.3f} |\n"


def _arms(task: Task, sizing: Sizing, share: float) -> str:
    roller = share * task.follower.roller_radius
    other = task_of(task.cam.sized(roller_radius=roller))
    best, found = size_with_arm(other, sizing.angle, sizing.ratio, *ARMS)
    ends = [size_with_arm(other, sizing.angle, sizing.ratio, arm, arm)[1] for arm in ARMS]
    arm = best.follower.arm
    cells = [each.answer for each in (found, *ends)]
    told = " | ".join("none" if each is None else f"{each.base_radius:.2f}" for each in cells)
    return f"| {roller:g} | {arm:.2f} | {told} |\n"


def picture() -> bytes:
    """The region."""
    from camgeo.figure import size as region
    from camgeo_export.plots.render import render

    design, task, sizing = sized()
    return render(region.figure(design.name, task, sizing), PICTURE.suffix)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    PICTURE.write_bytes(picture())
