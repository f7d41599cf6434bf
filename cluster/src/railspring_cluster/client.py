"""Sends the steps of a table to the workers and brings what they made into the store.

A case is prepared first, which says what bodies it needs; a body is condensed once, whatever the number of cases that need it; then the case
is pressed on its bodies, some places at a time. At most a few steps for each thread of the cluster are with the scheduler at the same time.
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
"""Places that are pressed in one step: so many are lost with a worker at most, and the bodies are read once for them."""
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
class Case:
    """A case with places that are missing."""

    number: int
    name: str
    shifts: list[float]
    study: dict[str, Any]
    bodies: list[str] = field(default_factory=list)
    prepared: Any = None
    open: bool = True


@dataclass(eq=False)
class Step:
    """A step of a case, done again until it has an answer."""

    kind: str
    name: str
    case: Case
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

    def __init__(self, client: Client, settings: Settings, cases: Iterator[Case], total: int) -> None:
        self.client, self.settings, self.cases, self.total = client, settings, cases, total
        self.token = uuid.uuid4().hex[:8]
        self.store = Path(settings.store)
        self.events: queue.SimpleQueue[Future] = queue.SimpleQueue()
        self.open: dict[str, Step] = {}
        self.condensed: dict[str, Step] = {}
        self.waiting: dict[str, list[Case]] = defaultdict(list)
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
            self.begin_cases()
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

    def begin_cases(self) -> None:
        """Takes up cases as long as the cluster has use for them."""
        if len(self.failures) >= GIVE_UP:
            self.more = False
        while self.more and len(self.open) < max(LEAST_STEPS, STEPS_PER_THREAD * self.threads):
            case = next(self.cases, None)
            if case is None:
                self.more = False
                return
            self.begin(Step("prepare", f"prepare {case.name}", case, {"do": "prepare"}, len(case.shifts)))

    def begin(self, step: Step, beside: bool = False) -> None:
        """Submits a step, again or beside itself too."""
        self.number += 1
        if not beside:
            step.attempts += 1
        step.begun = time.monotonic()
        key = f"{step.kind}-{step.name} #{self.number}-{self.settings.table}-{self.token}"
        bodies = [] if step.kind != "press" else [self.condensed[entry].futures[-1] for entry in step.case.bodies]
        others = sorted(self.workers - step.avoid) if step.avoid else []
        # a function without a name in a module goes to the cluster by value, and with it what it calls
        future = self.client.submit(
            lambda *given: perform(*given), self.settings, step.what, step.case.study, bodies,
            key=key, resources={self.settings.name: 1}, priority=PRIORITY[step.kind], pure=False, retries=0,
            **({"workers": others, "allow_other_workers": True} if others else {}),
        )
        step.futures.append(future)
        self.open[key] = step
        future.add_done_callback(self.events.put)

    def press(self, case: Case) -> None:
        """Begins the places of a case whose bodies are all there."""
        if not case.open or not all(self.condensed[entry].done for entry in case.bodies):
            return
        case.open = False
        for first in range(0, len(case.shifts), PLACES_PER_STEP):
            shifts = case.shifts[first : first + PLACES_PER_STEP]
            what = {"do": "press", "shifts_mm": shifts, "prepared": case.prepared}
            self.begin(Step("press", case.name, case, what, len(shifts)))

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
            step.futures = [future] if step.kind == "condense" else []
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
        case = step.case
        if answer.get("refused") is not None:
            cases = [case] if step.kind != "condense" else self.waiting.pop(step.what["entry"], [])
            for refused in cases:
                refused.open = False
                self.counts["refused"] += len(refused.shifts) if step.kind != "press" else step.places
                say("refused", case=refused.number, reason=answer["refused"])
            self.progress()
            return
        if step.kind == "prepare":
            case.bodies, case.prepared = [body["entry"] for body in answer["bodies"]], answer["prepared"]
            for body in answer["bodies"]:
                self.waiting[body["entry"]].append(case)
                if body["entry"] not in self.condensed:
                    what = {"do": "condense", "entry": body["entry"]}
                    condense = Step("condense", f"{body['name']} of {case.name}", case, what, 0)
                    self.condensed[body["entry"]] = condense
                    self.begin(condense)
            self.press(case)
        elif step.kind == "condense":
            step.done = True
            for waiting in self.waiting.pop(step.what["entry"], []):
                self.press(waiting)
        else:
            try:
                for name, content in zip(answer["entries"], answer["contents"] or (), strict=False):
                    put(self.store, name, content)
            except OSError as cause:
                raise Failed(f"{self.store}: {cause}") from None
            self.counts["places"] += step.places
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
                self.bodies_again(step.case)
            self.begin(step)
            return
        self.failures.append(f"{step.name}: {reason}")
        lost = [step.case] if step.kind != "condense" else self.waiting.pop(step.what["entry"], [])
        for case in lost:
            case.open = False

    def bodies_again(self, case: Case) -> None:
        """Begins again what the cluster has lost of the bodies of a case."""
        for entry in case.bodies:
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


def cases_of(lines: Iterator[str]) -> Iterator[Case]:
    """The cases on standard input, read as they are needed."""
    for line in lines:
        value = json.loads(line)
        yield Case(value["case"], value["name"], value["shifts_mm"], value["study"])


def main() -> int:
    """Reads the settings and the cases, and makes the places."""
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
            table = Table(client, settings, cases_of(sys.stdin), total)
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
