"""Sends the steps of a table to the workers and brings what they made into the store.

Cases that need the same bodies come in packages. A package is prepared first, which says what these are; a body is condensed once, whatever the
number of packages that need it; then the cases are pressed on their bodies. At most a few steps for each thread of the cluster are with the
scheduler at the same time.
A step that fails, or whose worker is lost, is done again elsewhere, a few times; one that takes much longer than others is done a second
time beside the first. Either comes to the same bytes, which the names of the entries say.
"""

import asyncio
import contextlib
import json
import queue
import signal
import statistics
import sys
import threading
import time
import uuid
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cloudpickle
from distributed import Client, Future

from . import worker
from .worker import Settings, Suited, lose_silent, perform, put, suitability

PLACES_PER_STEP = 12
"""Places of one case that are pressed in one step: the bodies are read once for them. A package of several cases is pressed in one step."""
STEPS_PER_THREAD = 8
"""Steps with the scheduler for every thread of the cluster: enough that none waits, few enough that the scheduler has room."""
LEAST_STEPS = 16
ATTEMPTS = 5
"""Times that a step is begun before it counts as failed."""
GIVE_UP = 20
"""Failed steps after which no further ones are begun: they have a common cause."""
POLL = 5.0
"""Seconds between two looks at the workers."""
UNSUITED = 10.0
"""Seconds after which workers that all lack the program are reported as an error."""
SLOW = 4.0
"""A step is done a second time when it has taken so many times as long as the median of its kind ..."""
LEAST_SLOW = 20.0
"""... and at least so many seconds, once every step that is left has a worker."""
PRIORITY = {"condense": 2, "press": 1, "prepare": 0}


def say(kind: str, **values: Any) -> None:
    """One event for the program."""
    print(json.dumps({"kind": kind, **values}), flush=True)


class Failed(Exception):
    """The table cannot go on."""


@dataclass(eq=False)
class Package:
    """Cases that need the same bodies, with the places that are missing of each."""

    cases: list[int]
    """Their numbers in the table."""
    name: str
    shifts: list[list[float]]
    """Of each case; none of one that is refused."""
    content: dict[str, Any]
    """What `railspring work` reads of them."""
    bodies: list[str] = field(default_factory=list)
    prepared: Future | None = None
    """The step that said which these are: its entry goes to those that press."""
    open: bool = True

    @property
    def places(self) -> int:
        """Places that are missing."""
        return sum(len(shifts) for shifts in self.shifts)


@dataclass(eq=False)
class Step:
    """A step of a package, done again until it has an answer."""

    kind: str
    name: str
    package: Package
    what: dict[str, Any]
    places: int
    done: bool = False
    """Whether it had an answer: a lost worker takes the result of a body with it, which the scheduler then has made again."""
    attempts: int = 0
    begun: float = 0.0
    futures: list[Future] = field(default_factory=list)
    avoid: set[str] = field(default_factory=set)


class Table:
    """The steps of one table on a cluster."""

    def __init__(self, client: Client, settings: Settings, packages: Iterator[Package], total: int) -> None:
        self.client, self.settings, self.packages, self.total = client, settings, packages, total
        self.token = uuid.uuid4().hex[:8]
        self.store = Path(settings.store)
        self.events: queue.SimpleQueue[Future] = queue.SimpleQueue()
        self.open: dict[str, Step] = {}
        self.condensed: dict[str, Step] = {}
        self.waiting: dict[str, list[Package]] = defaultdict(list)
        self.seconds: dict[str, list[float]] = defaultdict(list)
        self.counts: Counter[str] = Counter()
        self.more = True
        self.threads = 0
        self.workers: set[str] = set()
        self.failures: list[str] = []
        self.number = 0
        self.looked = -POLL
        self.unsuited_since: float | None = None
        self.noticed: set[str] = set()
        self.all_begun = 0.0

    def run(self) -> None:
        """Does all of it."""
        self.from_workers(lambda: self.client.register_plugin(Suited(self.settings)))
        while True:
            self.look()
            self.begin_packages()
            if not self.open and not self.more:
                left = self.total - self.counts["places"] - self.counts["refused"]
                if left > 0 and not self.failures:
                    raise Failed(f"{left} places have no answer")
                return
            with contextlib.suppress(queue.Empty):
                self.ended(self.events.get(timeout=0.5))
                while True:
                    self.ended(self.events.get_nowait())
            if self.client.status != "running":
                raise Failed("the scheduler has gone; what was made is in the store")

    # what is begun

    def begin_packages(self) -> None:
        """Takes up packages as long as the cluster has use for them."""
        if len(self.failures) >= GIVE_UP:
            self.more = False
        while self.more and len(self.open) < max(LEAST_STEPS, STEPS_PER_THREAD * self.threads):
            package = next(self.packages, None)
            if package is None:
                self.more = False
                return
            self.begin(Step("prepare", f"prepare {package.name}", package, {"do": "prepare"}, package.places))

    def begin(self, step: Step, beside: bool = False) -> None:
        """Submits a step, again or beside itself too."""
        self.number += 1
        if not beside:
            step.attempts += 1
        step.begun = time.monotonic()
        key = f"{step.kind}-{step.name} #{self.number}-{self.settings.table}-{self.token}"
        needed = [] if step.kind != "press" else [self.condensed[entry].futures[-1] for entry in step.package.bodies]
        if step.kind == "press" and step.package.prepared is not None:
            needed.append(step.package.prepared)
        others = sorted(self.workers - step.avoid) if step.avoid else []
        # a function without a name in a module goes to the cluster by value, and with it what it calls
        future = self.client.submit(
            lambda *given: perform(*given), self.settings, step.what, step.package.content, needed,
            key=key, resources={self.settings.name: 1}, priority=PRIORITY[step.kind], pure=False, retries=0,
            **({"workers": others, "allow_other_workers": True} if others else {}),
        )
        step.futures.append(future)
        self.open[key] = step
        future.add_done_callback(self.events.put)

    def press(self, package: Package) -> None:
        """Begins the places of a package whose bodies are all there."""
        if not package.open or not all(self.condensed[entry].done for entry in package.bodies):
            return
        package.open = False
        parts = [package.shifts]
        if len(package.cases) == 1:
            [shifts] = package.shifts
            parts = [[shifts[first : first + PLACES_PER_STEP]] for first in range(0, len(shifts), PLACES_PER_STEP)]
        for part in parts:
            what = {"do": "press", "shifts_mm": part}
            self.begin(Step("press", package.name, package, what, sum(len(shifts) for shifts in part)))

    # what has ended

    def ended(self, future: Future) -> None:
        """A step that has an answer, or none."""
        step = self.open.pop(future.key, None)
        if step is None:
            return
        answer = self.answer_of(future)
        if answer is not None and "failed" not in answer:
            self.seconds[step.kind].append(time.monotonic() - step.begun)
            for other in [other for other in step.futures if other is not future]:
                self.open.pop(other.key, None)
                other.cancel()
            # the bytes of a body stay with the workers as long as somebody may need them
            step.futures = [future] if step.kind != "press" else []
            self.answered(step, answer)
        elif not any(other.key in self.open for other in step.futures):
            self.again(step, future, answer)

    def answer_of(self, future: Future) -> dict[str, Any] | None:
        """What a step has come to, or nothing. The worker that has it may hang: once it is lost, the scheduler has it made again."""
        if future.status != "finished":
            return None
        try:
            return self.from_workers(future.result)
        except (Exception, asyncio.CancelledError):
            if future.status == "finished":
                raise
            return None

    def answered(self, step: Step, answer: dict[str, Any]) -> None:
        package = step.package
        if step.kind == "prepare":
            self.refused(package, package.shifts, answer["refused"])
            if not answer["entries"]:
                return
            package.bodies, package.prepared = [body["entry"] for body in answer["bodies"]], step.futures[0]
            for body in answer["bodies"]:
                self.waiting[body["entry"]].append(package)
                if body["entry"] not in self.condensed:
                    what = {"do": "condense", "entry": body["entry"]}
                    condense = Step("condense", f"{body['name']} of {package.name}", package, what, 0)
                    self.condensed[body["entry"]] = condense
                    self.begin(condense)
            self.press(package)
        elif step.kind == "condense":
            waiting = self.waiting.pop(step.what["entry"], [])
            if not answer["entries"]:
                # no case that needs it can have it made
                reason = answer["refused"][0][1]
                for refused in waiting:
                    refused.open = False
                    self.refused(refused, refused.shifts, [[number, reason] for number in range(len(refused.cases))])
                return
            step.done = True
            for package in waiting:
                self.press(package)
        else:
            self.refused(package, step.what["shifts_mm"], answer["refused"])
            try:
                for name, content in zip(answer["entries"], answer["contents"] or (), strict=False):
                    put(self.store, name, content)
            except OSError as cause:
                raise Failed(f"{self.store}: {cause}") from None
            self.counts["places"] += len(answer["entries"])
            self.progress()

    def refused(self, package: Package, shifts: list[list[float]], reasons: list[list[Any]]) -> None:
        """Cases that cannot be made anywhere: their shifts are not asked for again."""
        for number, reason in reasons:
            if not shifts[number]:
                continue
            self.counts["refused"] += len(shifts[number])
            shifts[number] = []
            say("refused", case=package.cases[number], reason=reason)
        self.progress()

    def again(self, step: Step, future: Future, failure: dict[str, str] | None) -> None:
        """A step without an answer is begun again, elsewhere if that is possible, unless it was begun often enough."""
        if failure is not None:
            step.avoid.add(failure["worker"])
            reason = f"{failure['worker']}: {failure['failed']}"
        elif future.status == "error":
            cause = future.exception()
            reason = f"{type(cause).__name__}: {next(iter(str(cause).splitlines()), '')}"
        else:
            reason = "the scheduler has lost it"
        if step.attempts < ATTEMPTS and len(self.failures) < GIVE_UP:
            self.counts["again"] += 1
            say("notice", text=f"{step.name}: again, {step.attempts + 1} of {ATTEMPTS} times: {reason}")
            if step.kind == "press":
                self.bodies_again(step.package)
            self.begin(step)
            return
        self.failures.append(f"{step.name}: {reason}")
        lost = [step.package] if step.kind != "condense" else self.waiting.pop(step.what["entry"], [])
        for package in lost:
            package.open = False

    def bodies_again(self, package: Package) -> None:
        """Begins again what the cluster has lost of the bodies of a package, and forgets which they are where that was lost: a step finds out itself."""
        if package.prepared is not None and package.prepared.status not in ("finished", "pending"):
            package.prepared = None
        for entry in package.bodies:
            body = self.condensed[entry]
            if body.futures[-1].status not in ("finished", "pending") and body.futures[-1].key not in self.open:
                self.begin(body)

    def progress(self) -> None:
        say("progress", done=self.counts["places"] + self.counts["refused"], total=self.total)

    # the workers

    def lose_silent(self) -> None:
        """Has the scheduler take off the workers that say nothing."""
        silent = self.client.run_on_scheduler(lose_silent, self.settings.silence)
        for address in silent:
            say("notice", text=f"{address}: nothing heard for {self.settings.silence:.0f} s or more: its steps go to other workers")

    def from_workers(self, ask: Callable[[], Any]) -> Any:
        """What a call comes to that waits for workers; those that hang are lost meanwhile, and it is made again if it had waited for one of them."""
        answers: queue.SimpleQueue[tuple[Any, BaseException | None]] = queue.SimpleQueue()

        def asked() -> None:
            try:
                answers.put((ask(), None))
            except BaseException as cause:  # a cancelled future is no Exception
                answers.put((None, cause))

        for attempt in range(ATTEMPTS):
            # not waited for where it never ends
            threading.Thread(target=asked, daemon=True).start()
            while True:
                with contextlib.suppress(queue.Empty):
                    answer, cause = answers.get(timeout=POLL)
                    break
                self.lose_silent()
            if cause is None:
                return answer
            if not isinstance(cause, OSError) or attempt + 1 == ATTEMPTS:
                raise cause
            self.lose_silent()
        raise AssertionError

    def look(self) -> None:
        """Looks at the workers now and then, and at steps that take long."""
        now = time.monotonic()
        if now - self.looked < POLL:
            return
        self.looked = now
        self.lose_silent()
        threads = self.client.nthreads()
        gone = self.workers - set(threads)
        self.counts["workers_lost"] += len(gone)
        self.workers, self.threads = set(threads), sum(threads.values())
        self.progress()
        self.beside(now)
        if any(self.seconds.values()):
            return
        if not self.workers:
            self.once("the cluster has no worker yet: waiting for one")
            self.unsuited_since = None
            return
        reasons = self.from_workers(lambda: self.client.run(suitability, self.settings.name, on_error="ignore"))
        unsuited = Counter(reason for reason in reasons.values() if reason)
        if sum(unsuited.values()) < len(reasons):
            for reason, count in unsuited.items():
                self.once(f"{count} of {len(reasons)} workers take no part: {reason}")
            self.unsuited_since = None
            return
        self.unsuited_since = self.unsuited_since or now
        if now - self.unsuited_since > UNSUITED:
            reason, _ = unsuited.most_common(1)[0]
            raise Failed(f"none of {len(reasons)} workers has this program: {reason}")

    def once(self, text: str) -> None:
        """A notice that is not said again."""
        if text not in self.noticed:
            self.noticed.add(text)
            say("notice", text=text)

    def beside(self, now: float) -> None:
        """Begins a second time what takes much longer than others, once every step that is left has a worker."""
        # before, a step may only wait for a worker
        if self.more or len(self.open) > self.threads:
            self.all_begun = now
            return
        for step in list(self.open.values()):
            known = self.seconds[step.kind]
            usual = SLOW * statistics.median(known) if known else 0.0
            if len(step.futures) == 1 and now - max(step.begun, self.all_begun) > max(LEAST_SLOW, usual):
                self.counts["beside"] += 1
                say("notice", text=f"{step.name}: takes long, begun a second time")
                self.begin(step, beside=True)


def packages_of(lines: Iterator[str]) -> Iterator[Package]:
    """The packages on standard input, read as they are needed."""
    for line in lines:
        value = json.loads(line)
        yield Package(value["cases"], value["name"], value["shifts_mm"], value["package"])


def main() -> int:
    """Reads the settings and the packages, and makes the places."""
    # the program decides when to stop
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    given = json.loads(sys.stdin.readline())
    scheduler, total = given.pop("scheduler"), given.pop("places")
    given["programs"] = tuple(given["programs"])
    settings = Settings(**given)
    cloudpickle.register_pickle_by_value(worker)
    begun = time.monotonic()
    failed: str | None = None
    table: Table | None = None
    try:
        with Client(scheduler, timeout="30s", name=f"railspring-{settings.table}", set_as_default=False) as client:
            table = Table(client, settings, packages_of(sys.stdin), total)
            try:
                table.run()
            finally:
                if client.status == "running":
                    table.from_workers(lambda: client.unregister_worker_plugin(settings.name))
            failed = table.failures[0] if table.failures else None
    except (Failed, OSError, TimeoutError, ValueError) as cause:
        failed = str(cause) or type(cause).__name__
    counts = table.counts if table else Counter()
    seconds = {} if table is None else {kind: [len(all), sum(all)] for kind, all in table.seconds.items()}
    say(
        "ended", failed=failed, places=counts["places"], again=counts["again"], beside=counts["beside"],
        workers_lost=counts["workers_lost"], seconds=time.monotonic() - begun, steps=seconds,
    )
    return 0
