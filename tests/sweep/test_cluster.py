"""The cluster: the rows of the loop bit for bit, whatever dies; one scheduler and two workers on
loopback for all tests."""

from __future__ import annotations

import logging
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from camgeo.app.cli.main import main
from camgeo.errors import CamgeoError, GeometryError, VersionError
from camgeo.studies.sweep import cluster
from camgeo.studies.sweep import rows as engine
from camgeo.studies.sweep.cluster import Cluster
from camgeo.studies.sweep.rows import Loop, compute_rows
from camgeo.studies.sweep.sweep import sweep
from tests.sweep.driver import NEVER
from tests.sweep.families import FIXTURES, family
from tests.sweep.kills import swept
from tests.sweep.logged import Deadly, by_point
from tests.sweep.processes import AT_ONCE, Processes
from tests.sweep.test_rows import work_on

pytest.importorskip("distributed", reason="needs camgeo[cluster]")
psutil = pytest.importorskip("psutil")

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="kills processes as POSIX does")

SCENE = str(FIXTURES / "scenes" / "setzhub.toml")

ASK = ("transmission-angle", "laws")


@pytest.fixture(scope="module")
def processes(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Processes]:
    found = Processes(tmp_path_factory.mktemp("cluster"), AT_ONCE)
    try:
        found.wait()
        yield found
    finally:
        found.end()


def test_only_loopback_is_listened_to(processes: Processes) -> None:
    listening = processes.listening()
    assert len(listening) >= 2 * 3  # scheduler and workers: for work, and for the dashboard
    assert set(listening) == {"127.0.0.1"}


def test_a_call_with_a_cluster(processes: Processes, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["sweep", SCENE, "--vary", "follower.base_radius=45:60:16", "--ask", ",".join(ASK)]
    assert main([*words, "--json"]) == 0
    loop = capsys.readouterr().out
    assert main([*words, "--json", "--cluster", processes.address]) == 0
    assert capsys.readouterr().out == loop


def test_the_rows_of_the_loop_whatever_dies(processes: Processes, tmp_path: Path) -> None:
    """A killed worker costs no row; a design that ends its workers is a row that says so."""
    found = family("follower.base_radius=45:56:12")
    plain = work_on(found, *ASK)
    # The one that is killed comes first, lest it is lost with the worker of the other one.
    points = sorted(found.points(), key=lambda point: (point[0] == 47) - (point[0] == 50))
    work = Deadly.made_of(plain, tmp_path / "mark")
    rows = by_point(Cluster(processes.address).rows(work, iter(points)))
    loop = by_point(Loop().rows(plain, iter(points)))
    (dead,) = (point for point in points if point[0] == 47)
    assert rows.keys() == loop.keys()
    assert rows[dead].reason.startswith("the process that computed it died, 1 time:")
    assert {**rows, dead: loop[dead]} == loop


def in_small_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    """However fast the machine is."""
    monkeypatch.setattr(engine, "CHUNK", NEVER)
    monkeypatch.setattr(engine, "MOST_IN_CHUNK", 4)


def forget(mine: str, dask_scheduler: Any) -> None:
    """In the scheduler: hang up on all clients but mine, whose chunks it then forgets."""
    for name, each in dask_scheduler.client_comms.items():
        if name != mine:
            each.comm.abort()


def test_what_the_scheduler_forgets_is_handed_out_again(
    processes: Processes, monkeypatch: pytest.MonkeyPatch
) -> None:
    in_small_chunks(monkeypatch)
    found = family("follower.base_radius=45:60:40")
    work = work_on(found, *ASK)
    chunks = Cluster(processes.address).rows(work, found.points())
    rows = list(next(chunks))
    with closing(processes.client()) as client:
        client.run_on_scheduler(forget, client.id)
    rows += [row for chunk in chunks for row in chunk]
    assert sorted(rows, key=lambda row: row.point) == list(compute_rows(work, found.points()))


def become(version: str) -> None:
    """In a worker: a camgeo of that version."""
    from camgeo.studies.sweep import rows

    vars(rows)["__version__"] = version


def test_one_worker_of_another_version_is_enough(processes: Processes) -> None:
    found = family("follower.base_radius=45:60:16")
    work = work_on(found, "laws")
    with closing(processes.client()) as client:
        worker = next(iter(client.nthreads()))
        client.run(become, "0.1", workers=[worker])
        try:
            with pytest.raises(VersionError, match=rf"a worker has camgeo 0\.1, .*{worker}"):
                list(Cluster(processes.address).rows(work, found.points()))
        finally:
            client.run(become, work.versions.camgeo, workers=[worker])


def test_a_store_that_a_cluster_began_is_resumed(processes: Processes, tmp_path: Path) -> None:
    """By the cluster or by any other engine; closing the rows ends what is handed out."""
    store, part = tmp_path / "runs.sqlite", family("follower.base_radius=45:60:4")
    whole = family("follower.base_radius=45:60:16")
    sweep(part, ASK, store=store, engine=Cluster(processes.address)).close()
    chosen = Cluster(processes.address)
    with closing(sweep(whole, ASK, store=store, existing="resume", engine=chosen)) as result:
        assert result.computed == 12
        assert tuple(result.rows) == compute_rows(work_on(whole, *ASK), whole.points())


# Bad addresses ------------------------------------------------------------------------------------


NO_ADDRESS = r"cluster = .*: must be tcp://HOST:PORT"

OPEN = r"cluster = tcp://.*: leaves this computer without TLS"

HOSTS = ("10.0.0.5", "0.0.0.0", "node-7.example", "[2001:db8::1]")

OWN_HOSTS = ("127.0.0.1", "127.1.2.3", "localhost", "[::1]")


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("localhost", NO_ADDRESS),
        ("127.0.0.1:8786", NO_ADDRESS),
        ("http://a:1", NO_ADDRESS),
        ("tcp://a:0", NO_ADDRESS),
        ("tcp://a:99999", NO_ADDRESS),
        *((f"tcp://{host}:8786", OPEN) for host in HOSTS),
    ],
)
def test_addresses_that_are_refused(address: str, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        Cluster(address)


def test_this_machine_is_reached_without_tls_and_others_with_it() -> None:
    for host in HOSTS:
        Cluster(f"tls://{host}:8786")
    for host in OWN_HOSTS:
        Cluster(f"tcp://{host}:8786")


def test_dask_says_nothing_of_its_own() -> None:
    """Not even where a worker was killed before its rows were fetched; afterwards it may again."""
    logger = logging.getLogger("distributed.client")
    with cluster._quiet():
        assert not logger.isEnabledFor(logging.CRITICAL)
    assert logger.isEnabledFor(logging.CRITICAL)


@pytest.mark.parametrize(
    "address", ["tcp://127.0.0.1:1", "tls://127.0.0.1:1", "tls://no.invalid:1"]
)
def test_a_cluster_that_cannot_be_reached_is_a_sentence(
    address: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "REACHED", 0.5)
    words = ["sweep", SCENE, "--vary", "follower.base_radius=45,46", "--ask", "laws"]
    assert main([*words, "--cluster", address]) == 2
    told = capsys.readouterr().err
    assert f"no Dask scheduler can be reached at {address}: " in told
    assert "Traceback" not in told


def test_a_missing_extra_names_its_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    found = family()
    with pytest.raises(CamgeoError, match=r"not installed .*pip install 'camgeo\[cluster\]'"):
        list(Cluster("tcp://127.0.0.1:1").rows(work_on(found, "laws"), found.points()))


def test_dask_is_imported_for_a_cluster_only() -> None:
    code = (
        "import sys; from camgeo.app.cli.main import main;"
        f"main(['sweep', {SCENE!r}, '--vary', 'follower.base_radius=45,46', '--ask', 'laws']);"
        "assert not {'dask', 'distributed', 'camgeo.studies.sweep.cluster'} & sys.modules.keys()"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr


# Kills --------------------------------------------------------------------------------------------


@pytest.mark.long  # in the usual form the pool's, which has the same store and driver
def test_killed_drivers_and_workers_lose_no_row_and_repeat_few(
    processes: Processes, tmp_path: Path
) -> None:
    """The small form of `python -m tests.sweep.kills`."""
    found = swept(tmp_path, processes.address, 120, each=1, computing=processes.computing)
    assert sorted(victim for victim, _ in found.killed) == ["driver", "worker"]


@pytest.mark.long  # starts all processes again
def test_a_restarted_scheduler_loses_nothing(
    processes: Processes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    in_small_chunks(monkeypatch)
    found = family("follower.base_radius=45:60:400")
    told: list[str] = []

    def restart(words: str) -> None:
        if not told:
            scheduler = processes.started[0]
            scheduler.kill()
            scheduler.wait()
            processes.started[0] = processes.schedule(processes.address.rsplit(":", 1)[1])
            processes.started.pop()
            processes.start_workers()  # those of a scheduler that is gone end
        told.append(words)

    chosen = Cluster(processes.address)
    with closing(sweep(found, ASK, engine=chosen, progress=restart)) as result:
        assert len(told) > 1
        assert tuple(result.rows) == compute_rows(work_on(found, *ASK), found.points())
