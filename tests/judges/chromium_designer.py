"""Chromium shows the live designer: every scene is edited and built, every view is looked at."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from tests.judges import axe, browsing, designer_keyboard, designer_strain, designer_views
from tests.judges.browsing import driven, number_of
from tests.judges.designer_page import serving, shown
from tests.judges.designer_scenes import Shown, hostile_scenes, used, workshop

FEW: Final = "effects_groove_lever.toml"
"""The scene of the small form, which is soon built; with it is one that is hostile."""

LONGEST, LONG = 3600.0, 36000.0
"""Seconds after which the browser is ended, in the small form and in the long one."""


def missing() -> str:
    """Why it cannot judge here; empty if it can."""
    return browsing.missing() or axe.missing()


def judge(*, everything: bool) -> str:
    """What has been looked at: a few scenes and views, or everything; Refusal if it is wrong."""
    most = LONG if everything else LONGEST
    with TemporaryDirectory() as name, driven(most) as browser:
        folder = Path(name, "scenes")
        scenes, hostile = workshop(folder), hostile_scenes(folder)
        names = [*scenes, *hostile] if everything else [FEW, hostile[0]]
        seen, views, told = Shown(), 0, []
        with serving(folder) as server:
            for window in designer_views.windows(everything=everything):
                with shown(browser, server.host, server.way, **window.context) as page:
                    views += designer_views.judged(page, folder, window, everything=everything)
            with shown(browser, server.host, server.way) as page:
                for each in names:
                    seen += used(page, folder, each)
            if everything:
                with shown(browser, server.host, server.way) as page:
                    designer_keyboard.planned(page, folder)
                    told.append("one is planned by the keyboard alone")
                with shown(browser, server.host, server.way) as page:
                    number = number_of(browser)
                    told.append(designer_strain.judged(page, folder, server, number, FEW))
    told.insert(0, f"{seen}; {views} views")
    return "; ".join(told)
