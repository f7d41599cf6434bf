"""How many places a second a cluster makes, by simulation: where scheduler, client or store become the limit.

``python -m railspring_cluster.model COSTS`` reads a JSON object with the fields of :class:`Costs` and ``runs``, a list of
``[workers, packages]``, and prints for each run the places a second and how busy everything was.

A package is a prepare step and press steps; bodies are condensed before, and count with their number. Workers take steps beside each other.
Client, scheduler and store do one thing after the other: the client reads and submits a step and takes its answer, the scheduler handles it,
the store gets the entry of each place. Steps with the scheduler are at most so many for every worker, as in ``client``.
"""

import heapq
import json
import random
import sys
from collections import deque
from dataclasses import dataclass

from .client import LEAST_STEPS, PLACES_PER_STEP, STEPS_PER_THREAD


@dataclass(frozen=True)
class Costs:
    """Measured seconds."""

    prepare: float
    """A prepare step on a worker."""
    place: float
    """A place on a worker."""
    read: float
    """Reading the bodies in a press step on a worker."""
    client: float
    """A step on the client."""
    scheduler: float
    """A step on the scheduler."""
    store: float
    """An entry in the store."""
    places: int
    """Places of a package."""
    cases: int = 1
    """Cases of a package; those of several are pressed in one step."""


class Server:
    """Does one thing after the other."""

    def __init__(self) -> None:
        self.free = 0.0
        self.busy = 0.0

    def serve(self, now: float, seconds: float) -> float:
        """When what comes now is done."""
        self.free = max(self.free, now) + seconds
        self.busy += seconds
        return self.free


def simulate(costs: Costs, workers: int, packages: int, seed: int = 1) -> dict[str, float]:
    """A table of so many packages on so many workers, whose steps take between half and one and a half of their mean."""
    numbers = random.Random(seed)
    client, scheduler, store = Server(), Server(), Server()
    events: list[tuple[float, int, str, int]] = []
    ready: deque[tuple[str, int]] = deque()
    idle, left, open_, counter, busy, end = workers, packages, 0, 0, 0.0, 0.0
    at_once = PLACES_PER_STEP if costs.cases == 1 else costs.places
    window = max(LEAST_STEPS, STEPS_PER_THREAD * workers)

    def at(time: float, what: str, places: int) -> None:
        nonlocal counter
        counter += 1
        heapq.heappush(events, (time, counter, what, places))

    def submit(now: float, what: str, places: int) -> None:
        nonlocal open_
        open_ += 1
        at(scheduler.serve(client.serve(now, costs.client / 2), costs.scheduler / 2), f"queue {what}", places)

    now = 0.0
    while True:
        while left and open_ < window:
            left -= 1
            submit(now, "prepare", costs.places)
        while ready and idle:
            what, places = ready.popleft()
            idle -= 1
            seconds = costs.prepare if what == "prepare" else costs.read + places * costs.place
            seconds *= numbers.uniform(0.5, 1.5)
            busy += seconds
            at(now + seconds, f"done {what}", places)
        if not events:
            break
        now, _, what, places = heapq.heappop(events)
        kind, _, step = what.partition(" ")
        if kind == "queue":
            # the places of a package that was begun come before the next one
            (ready.appendleft if step == "press" else ready.append)((step, places))
        elif kind == "done":
            idle += 1
            at(client.serve(scheduler.serve(now, costs.scheduler / 2), costs.client / 2), f"answer {step}", places)
        else:
            open_ -= 1
            end = now
            if step == "prepare":
                for first in range(0, places, at_once):
                    submit(now, "press", min(at_once, places - first))
            else:
                end = store.serve(now, costs.store * places)
    return {
        "workers": workers,
        "packages": packages,
        "seconds": end,
        "places_per_second": packages * costs.places / end,
        "workers_busy": busy / (workers * end),
        "client_busy": client.busy / end,
        "scheduler_busy": scheduler.busy / end,
        "store_busy": store.busy / end,
    }


def main() -> int:
    """The runs that are asked for, a line each."""
    given = json.load(sys.stdin)
    runs = given.pop("runs")
    costs = Costs(**given)
    for workers, packages in runs:
        print(json.dumps(simulate(costs, workers, packages)), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
