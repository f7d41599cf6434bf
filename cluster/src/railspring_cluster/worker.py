"""What runs on the workers. It is sent there by value: a worker needs ``distributed`` and the program alone."""

import asyncio
import json
import os
import re
import shutil
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from distributed import WorkerPlugin, get_worker
from distributed.scheduler import heartbeat_interval

TEMPORARY = ".railspring-"
"""Begin of the names of files that are not complete; the store removes them when they are old."""


@dataclass(frozen=True)
class Settings:
    """What all steps of a table have in common."""

    table: str
    """Name of the table."""
    program: str
    """Hash of the program that asks: a worker runs the same one, or nothing."""
    version: str
    """Its version, for messages."""
    programs: tuple[str, ...]
    """Where a worker looks for it: paths, or names on its search path."""
    store: str
    """Folder of the store of the machine that asks."""
    token: str
    """A file in that folder: a worker that sees it shares the store."""
    cache: str | None
    """Folder of the store on the workers, relative to the folder of each; none: the shared one, or one in that folder."""
    threads: int
    """Threads of a step."""
    memory_limit_gib: float | None
    """Memory of a step; none: the worker's, by the number of its steps at the same time."""
    fresh: bool
    """Whether places that a store has are made again."""
    silence: float
    """Seconds after which a worker that says nothing is lost."""

    @property
    def name(self) -> str:
        """Name of the plugin, and of the resource that a worker with the right program has: another one for every run."""
        return f"railspring-{self.program[:12]}-{self.token.rpartition('-')[2]}"


class Suited(WorkerPlugin):
    """Looks for the program on a worker, one that joins later too, and opens the worker to the steps if it is the same."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.name = settings.name
        self.program: str | None = None
        self.reason: str | None = None
        self.folder = ""
        self.shared = False

    async def setup(self, worker: Any) -> None:
        """Says to the scheduler how many steps the worker takes at the same time."""
        self.program, self.reason = await asyncio.to_thread(same_program, self.settings)
        self.folder, self.shared = store_of(self.settings, worker.local_directory)
        steps = worker.state.nthreads if self.program else 0
        await worker.set_resources(**{self.settings.name: steps})

    async def teardown(self, worker: Any) -> None:
        """Closes the worker to further steps."""


def same_program(settings: Settings) -> tuple[str | None, str | None]:
    """Path of the program with the right hash, or why there is none."""
    reasons = []
    for name in settings.programs:
        path = shutil.which(name)
        if path is None:
            reasons.append(f"{name} is not there")
            continue
        try:
            said = subprocess.run([path, "work", "--check"], capture_output=True, timeout=60, check=True).stdout
            found = json.loads(said)
        except (OSError, subprocess.SubprocessError, ValueError) as cause:
            reasons.append(f"{path} is no such program ({cause})")
            continue
        if found.get("program") == settings.program:
            return path, None
        reasons.append(
            f"{path} is another build (version {found.get('version')}, {str(found.get('program'))[:12]}; "
            f"wanted {settings.version}, {settings.program[:12]})"
        )
    return None, "; ".join(reasons)


def store_of(settings: Settings, local: str) -> tuple[str, bool]:
    """The folder of a worker's store, and whether it is that of the machine that asks."""
    if settings.cache is None and (Path(settings.store) / settings.token).is_file():
        return settings.store, True
    return str(Path(local) / (settings.cache or "railspring-store")), False


def suitability(name: str, dask_worker: Any) -> str | None:
    """Why a worker takes no steps; none if it does."""
    plugin = dask_worker.plugins.get(name)
    return "the program was not looked for" if plugin is None else plugin.reason


async def lose_silent(silence: float, dask_scheduler: Any) -> list[str]:
    """On the scheduler: takes the workers off that have said nothing for so many seconds; their addresses.

    A process that was stopped, or a machine that hangs, keeps its connections. The scheduler itself looks for that after five minutes unless it
    is set otherwise. Others get the steps of these workers, and make again what they had; a worker that goes on joins again with its nanny.
    """
    now = time.time()
    # heartbeats come less often on large clusters
    limit = max(silence, 10 * heartbeat_interval(len(dask_scheduler.workers)))
    silent = [address for address, worker in dask_scheduler.workers.items() if now - worker.last_seen > limit]
    for address in silent:
        await dask_scheduler.remove_worker(address, stimulus_id=f"railspring-silent-{now}", close=False)
    return silent


def put(folder: Path, name: str, content: bytes) -> None:
    """Writes an entry of a store, complete or not at all.

    The name comes from another machine: what is no entry's name is refused, so that nothing is written elsewhere.
    """
    if not re.fullmatch(r"[a-z-]{1,40}-[0-9a-f]{64}\.artefact", name):
        raise OSError(f"a worker sent {name!r}, which is no entry of a store")
    target = folder / name
    try:
        if target.stat().st_size == len(content):
            return
    except OSError:
        pass
    folder.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(prefix=TEMPORARY, dir=folder)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(temporary, 0o644)
        os.replace(temporary, target)
    except BaseException:
        os.unlink(temporary)
        raise


def perform(
    settings: Settings, step: dict[str, Any], package: dict[str, Any], before: list[dict[str, Any]]
) -> dict[str, Any]:
    """Does a step of a package, with the entries that steps before have made.

    The answer is that of ``railspring work``, and under ``contents`` the files of its entries; none where the store is shared. Where there is
    none, ``failed`` says why, and ``worker`` where: another worker may have one.
    """
    worker = get_worker()
    plugin = worker.plugins[settings.name]
    folder = Path(plugin.folder)
    memory = settings.memory_limit_gib
    if memory is None and worker.memory_manager.memory_limit:
        memory = worker.memory_manager.memory_limit / worker.state.nthreads / 2**30
    command = [plugin.program, "work", "--cache", str(folder), "--threads", str(settings.threads)]
    if memory is not None:
        command += ["--memory-limit", str(memory)]
    task = {"program": settings.program, "fresh": settings.fresh, "step": step, "package": package}
    try:
        for made in before:
            for name, content in zip(made.get("entries", ()), made.get("contents") or (), strict=False):
                put(folder, name, content)
        done = subprocess.run(command, input=json.dumps(task).encode(), capture_output=True)
        if done.returncode != 0:
            said = done.stderr.decode(errors="replace").strip().splitlines()
            reason = f"{said[-1] if said else 'no message'} (exit code {done.returncode})"
            return {"failed": reason, "worker": worker.address}
        answer: dict[str, Any] = json.loads(done.stdout)
        contents = None if plugin.shared else [(folder / name).read_bytes() for name in answer["entries"]]
    except (OSError, ValueError) as cause:
        return {"failed": str(cause), "worker": worker.address}
    answer["contents"] = contents
    return answer
