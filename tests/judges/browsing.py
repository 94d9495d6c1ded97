"""Chromium as a person uses it, driven by playwright: it is looked at and waited for, but not long.

Whatever is waited for comes within `PATIENCE` or is refused with what did not come; a browser that
does not answer at all is ended.
"""

from __future__ import annotations

import os
import re
import signal
import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from tests.judges import chromium
from tests.judges.programs_of_others import Refusal
from tests.waiting import PATIENCE

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserType, ConsoleMessage, Page, WebSocket

LONGEST: Final = 6.0 * PATIENCE
"""Seconds after which a browser that tests share is ended."""

OPTIONS: Final = ("--no-sandbox", "--enable-unsafe-swiftshader")  # WebGL without a graphics card

NUMBERS: Final = re.compile(r'\{"kind": "(\w+)", (?:.*?, )??"revision": (\d+)')
"""The kind of a message to the page, and the revision of the scene that it tells of."""


def missing() -> str:
    """Why it cannot be driven here; empty if it can."""
    if not find_spec("playwright"):
        return "Python has no module playwright, pip install playwright"
    return chromium.CHROMIUM.absent()


@contextmanager
def driven(most: float) -> Generator[Browser]:
    """A browser, which is ended after `most` seconds; see `launched`."""
    from playwright.sync_api import sync_playwright  # where there is no playwright, too

    with sync_playwright() as playwright, launched(playwright.chromium, most) as browser:
        yield browser


@contextmanager
def launched(kind: BrowserType, most: float) -> Generator[Browser]:
    """A browser of a kind, which is ended after `most` seconds.

    Raises
    ------
    Refusal
        If it does not do in time what it is asked for, or ends itself.
    """
    from playwright.sync_api import Error  # where there is no playwright, too

    browser = kind.launch(
        executable_path=chromium.CHROMIUM.path,
        args=list(OPTIONS),
        timeout=1e3 * PATIENCE,
    )
    end = threading.Timer(most, os.kill, (number_of(browser), signal.SIGTERM))
    end.start()
    try:
        yield browser
    except Error as error:
        if not end.is_alive():
            raise Refusal(f"it has not ended within {most:g} s") from error
        raise Refusal(error.message.strip().replace("\n", "; ")[:400]) from error
    finally:
        end.cancel()
        if browser.is_connected():
            browser.close()


def number_of(browser: Browser) -> int:
    """The number of the browser's first process."""
    session = browser.new_browser_cdp_session()
    told = session.send("SystemInfo.getProcessInfo")["processInfo"]
    session.detach()
    return next(int(each["id"]) for each in told if each["type"] == "browser")


@dataclass(frozen=True)
class Visit:
    """A page in a window of its own.

    Attributes
    ----------
    page : as playwright drives it.
    host : the only one that it may ask.
    faults : what it has said on its console, and what it has asked of other hosts.
    heard : by their kind the revision of the last message that its socket has received, or how many
        have come, of those without one.
    """

    page: Page
    host: str
    faults: list[str] = field(default_factory=list)
    heard: dict[str, int] = field(default_factory=dict)

    def ask(self, what: str, script: str, argument: Any = None, most: float = PATIENCE) -> Any:
        """What a function of the page gives, once it gives anything that is true.

        `what` is what did not come if it does not: Refusal says so.
        """
        from playwright.sync_api import TimeoutError as Late  # where there is no playwright, too

        try:
            given = self.page.wait_for_function(script, arg=argument, timeout=1e3 * most)
        except Late:
            raise Refusal(f"{what}: not within {most:g} s") from None
        return given.json_value()

    def until(self, what: str, is_so: Callable[[], bool], most: float = PATIENCE) -> None:
        """Wait until something is so; Refusal with `what` if it does not become so."""
        for _ in range(int(most / STEP)):
            if is_so():
                return
            self.page.wait_for_timeout(1e3 * STEP)  # lets it hear what comes
        raise Refusal(f"{what}: not within {most:g} s")

    def drawn(self) -> None:
        """Wait until what has come is on the screen."""
        self.ask("two frames", FRAMES)

    def check(self) -> None:
        """Refusal if the page has said anything, or asked another host."""
        if self.faults:
            raise Refusal("; ".join(self.faults)[:400])


STEP: Final = 0.02
"""Seconds between two looks."""

FRAMES: Final = """() => new Promise((done) =>
  requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(() => done(true)))))"""


@contextmanager
def visit(browser: Browser, host: str, path: str = "/", **window: Any) -> Generator[Visit]:
    """A page of `host`; `window` is what playwright's `new_context` takes.

    Raises
    ------
    Refusal
        If it says anything on its console, or asks another host for anything.
    """
    context = browser.new_context(**window)
    context.set_default_timeout(1e3 * PATIENCE)
    page = context.new_page()
    found = Visit(page, host)
    page.on("console", lambda message: found.faults.extend(_said(message)))
    page.on("pageerror", lambda error: found.faults.append(f"an error: {error}"))
    page.on("request", lambda asked: found.faults.extend(_strange(asked.url, host)))
    page.on("websocket", lambda socket: _listen(socket, found))
    try:
        page.goto(f"http://{host}{path}")
        yield found
        found.check()
    finally:
        if browser.is_connected():
            context.close()


def _said(message: ConsoleMessage) -> list[str]:
    return [] if chromium.SLOW in message.text else [f"{message.type}: {message.text}"]


def _strange(url: str, host: str) -> list[str]:
    own = (f"http://{host}/", "data:", f"blob:http://{host}/")
    return [] if url.startswith(own) else [f"it asks for {url}"]


def _listen(socket: WebSocket, visit: Visit) -> None:
    visit.faults.extend(_strange(socket.url.replace("ws:", "http:", 1), visit.host))

    def heard(told: str | bytes) -> None:
        match = NUMBERS.match(str(told)[:4000])
        kind = match[1] if match else str(told)[10:40].partition('"')[0]
        visit.heard[kind] = int(match[2]) if match else visit.heard.get(kind, 0) + 1

    socket.on("framereceived", heard)


def memory(number: int) -> int:
    """Bytes of main memory that a process has, with all that it has started; 0 without `/proc`."""
    try:
        pages = Path(f"/proc/{number}/statm").read_text().split()[1]
        threads = [*Path(f"/proc/{number}/task").iterdir()]
        children = [Path(each, "children").read_text().split() for each in threads]
    except OSError:
        return 0
    own = int(pages) * os.sysconf("SC_PAGE_SIZE")
    return own + sum(memory(int(each)) for some in children for each in some)
