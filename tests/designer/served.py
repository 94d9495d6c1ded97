"""A designer served on loopback in a thread, with a stand-in for what computes."""

from __future__ import annotations

import asyncio
import contextlib
import http.client
import json
import threading
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import uvicorn
from websockets import Origin
from websockets.sync.client import ClientConnection, connect

from camgeo.app.designing.children import Job, JobResult
from camgeo.app.designing.desk import Desk
from camgeo.app.designing.work import Recent, run
from camgeo_export.designer.serve import Address, Keys, application, listening, make_server
from camgeo_export.designer.session import Jobs, Session, body
from tests.waiting import PATIENCE

Compute = Callable[[Job, float], Mapping[str, Any]]


def cancel(_: str) -> None:
    """There is no process to be ended."""


class Clock:
    """Seconds that pass only where a test says so."""

    def __init__(self) -> None:
        self.now = 1000.0

    def monotonic(self) -> float:
        return self.now


def computed(job: Job, _: float) -> Mapping[str, Any]:
    """What jobs give, without computing: texts are names of values."""
    if job.kind == "change":
        if "edits" not in job.arguments:
            return {"text": job.text, "refused": "only edits are known here", "faults": []}
        text = "".join(f"{key} = {value}\n" for key, value in job.arguments["edits"].items())
        return {"text": text, "label": text.strip(), "faults": [], "charts": []}
    if job.kind == "build":
        return {"files": [{"name": "cam ä.dxf", "bytes": "Y2Ft", "size": 3}], "faults": []}
    return {"faults": [], "of": job.text}


def computing() -> Callable[[Job, float], Mapping[str, Any]]:
    """What computes, in this process and one job after the other."""
    recent, lock = Recent(), threading.Lock()

    def compute(job: Job, _: float) -> Mapping[str, Any]:
        with lock:
            return run(job, recent)

    return compute


@dataclass(frozen=True)
class Served:
    """A running server.

    Attributes
    ----------
    desk : what it serves.
    session : of its pages.
    server : that runs.
    keys : that let in.
    port : at which it listens.
    """

    desk: Desk
    session: Session
    server: uvicorn.Server
    keys: Keys
    port: int

    @property
    def host(self) -> str:
        return f"127.0.0.1:{self.port}"

    @property
    def cookie(self) -> str:
        return f"camgeo-design-{self.port}={self.keys.cookie}"

    def get(
        self, path: str = "/", *, method: str = "GET", let_in: bool = True, **headers: str
    ) -> http.client.HTTPResponse:
        """The reply to a request; names of headers have _ for -."""
        found = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)
        given = {"Cookie": self.cookie} if let_in else {}
        given |= {key.replace("_", "-"): value for key, value in headers.items()}
        with contextlib.closing(found):
            found.request(method, path, headers=given)
            reply = found.getresponse()
            reply.text = reply.read()  # type: ignore[attr-defined]  # the connection ends here
            return reply

    @contextlib.contextmanager
    def page(self) -> Generator[Client]:
        """A page that is connected."""
        with connect(
            f"ws://{self.host}/ws",
            origin=Origin(f"http://{self.host}"),
            additional_headers={"Cookie": self.cookie},
            max_size=None,
            open_timeout=PATIENCE,
            ping_interval=None,
            compression=None,
        ) as found:
            yield Client(found)


@dataclass(frozen=True)
class Client:
    """A page, as the server sees it."""

    socket: ClientConnection

    def say(self, kind: str, **arguments: Any) -> None:
        self.socket.send(json.dumps({"kind": kind, **arguments}))

    def hear(self, *kinds: str, **having: Any) -> dict[str, Any]:
        """The next message of one of these kinds in which all these values are."""
        while True:
            found: dict[str, Any] = json.loads(self.socket.recv(PATIENCE))
            if found["kind"] in kinds and all(found.get(key) == having[key] for key in having):
                return found


@contextlib.contextmanager
def served(folder: Path, name: str | None = None, compute: Compute = computed) -> Generator[Served]:
    """A server of a scene in `folder`, with its journals beside it."""
    desk = Desk(folder, folder.parent / "states")
    if name is None:
        desk.begin()
    else:
        desk.open(name)
    keys = Keys()
    with listening("127.0.0.1", 0) as socket:
        address = Address("127.0.0.1", socket.getsockname()[1])
        jobs = Jobs(desk, lambda job, most: JobResult(body(compute(job, most))), cancel)
        session = Session(desk, jobs)
        server = make_server(application(session, address, keys))

        async def serve() -> None:
            working = asyncio.create_task(session.run())
            await server.serve(sockets=[socket])
            working.cancel()
            jobs.close()

        thread = threading.Thread(target=asyncio.run, args=(serve(),))
        thread.start()
        try:
            yield Served(desk, session, server, keys, address.port)
        finally:
            server.should_exit = True
            thread.join()
            desk.close()
