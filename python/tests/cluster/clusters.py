"""Clusters of two workers on this machine, and how one of the workers dies."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext

import distributed
import psutil

# Read when Ray is imported: no reports of usage, and the loopback interface alone, as on other systems than Linux.
os.environ |= {"RAY_USAGE_STATS_ENABLED": "0", "RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0"}

import ray

WAIT_S = 30.0
STORE_BYTES = 200_000_000


@contextmanager
def ray_cluster(workers: int = 2) -> Iterator[None]:
    """Ray with so many CPUs; no process of it remains."""
    ours = set(psutil.Process().children(recursive=True))
    ray.init(
        num_cpus=workers,
        object_store_memory=STORE_BYTES,
        include_dashboard=False,
        log_to_driver=False,
        logging_level="ERROR",
    )
    started = set(psutil.Process().children(recursive=True)) - ours
    try:
        yield
    finally:
        ray.shutdown()
        _, left = psutil.wait_procs(started, WAIT_S)
        assert not left, f"Ray left {left}"


@contextmanager
def dask_cluster(workers: int = 2) -> Iterator[distributed.Client]:
    """So many processes of one thread."""
    with (
        distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, host="127.0.0.1", dashboard_address="127.0.0.1:0", memory_limit=0
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


CLUSTERS = {"cores": nullcontext, "ray": ray_cluster, "dask": dask_cluster}


def kill_worker_of_ray() -> None:
    """One that is planning."""

    def planning() -> list[psutil.Process]:
        children = psutil.Process().children(recursive=True)
        return [child for child in children if _title(child) in ("ray::_figures", "ray::MapBatches(Planning.figures)")]

    _kill(_first(planning).pid)


def kill_worker_of_dask(client: distributed.Client) -> None:
    """One that is planning."""
    pids = client.run(os.getpid)

    def planning() -> list[int]:
        return [pids[worker] for worker, tasks in client.processing().items() if tasks]

    _kill(_first(planning))


def _title(process: psutil.Process) -> str:
    try:
        return process.cmdline()[0]
    except (psutil.Error, IndexError):
        return ""


def _first(find):
    until = time.monotonic() + WAIT_S
    while not (found := find()):
        assert time.monotonic() < until, "no worker is planning"
        time.sleep(0.01)
    return found[0]


def _kill(pid: int) -> None:
    os.kill(pid, signal.SIGKILL)
