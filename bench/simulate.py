#!/usr/bin/env python3
"""Simulates servers behind one address: simulate.py STAGES (--rate R | --clients N) [options]

STAGES is a JSON file that scale_check.py writes: measured times of pictures, in seconds. The simulation draws from them
at random. It is a function of its inputs and of the seed. docs/scale.md says what it models, and how well.

A picture goes to the server on which the hash of its model's name places it. That server draws one picture at a time,
in the order in which they came, and encodes several. A picture that comes while as many wait as may is refused with
503; the proxy then tries the next server on the ring and the first one in turns. Servers share the cores of their
machine evenly between all that they do at a time.
"""
import argparse
import bisect
import collections
import dataclasses
import functools
import hashlib
import heapq
import itertools
import json
import random
import sys
from collections.abc import Callable, Iterable, Sequence

Action = Callable[[], None]


@dataclasses.dataclass(frozen=True)
class Stages:
    """Processor time of one picture, seconds."""
    draw: float
    encode: float = 0
    serve: float = 0    # of the server for protocols: a half before it is drawn and a half after it is encoded
    network: float = 0  # of clients and proxy, likewise
    load: float = 0     # to draw it from a model of which nothing is in memory, beyond `draw`


@dataclasses.dataclass(frozen=True)
class Arrival:
    """A picture that is asked for, whatever becomes of the ones before."""
    time: float  # seconds
    model: int
    stages: Stages | None = None  # None: drawn from those of the setup


@dataclasses.dataclass(frozen=True)
class Setup:
    """What is simulated. The defaults of servers are those of surfcastd, the retries those of deploy/haproxy."""
    stages: Sequence[Stages]
    servers: int = 1
    cores: float = float("inf")  # of one machine
    machines: Sequence[int] = ()  # machine of each server; empty: one for each
    network_machine: int | None = None  # of clients and proxy; None: theirs are never short of cores
    models: int = 1
    resident: int = 0            # models in the memory of a server; 0: all, from the beginning
    queue: int = 256             # pictures that may wait in a server
    frames: int = 3              # pictures of a server that are drawn and encoded at a time
    encoders: int = 2
    attempts: int = 4            # of the proxy, for one picture
    arrivals: Iterable[Arrival] = ()
    clients: int = 0             # each asks for a picture, waits for it, and thinks
    think: float = 1             # mean, seconds
    zipf: float = 0              # exponent of the popularity of models among clients; 0: all are alike
    homes: Sequence[int] = ()    # measured server of each model; empty: by the ring
    seconds: float = float("inf")  # nobody asks afterwards
    warm_up: float = 0           # pictures that were asked for earlier are not counted, seconds
    seed: int = 1


@dataclasses.dataclass
class Result:
    """What became of the pictures that were asked for after the warm-up."""
    asked: int = 0
    refused: int = 0
    retried: int = 0  # attempts beyond the first one
    loads: int = 0    # pictures that had to load their model
    begin: float = 0  # of counting, seconds
    end: float = 0
    latencies: list[float] = dataclasses.field(default_factory=list)  # of answered pictures, seconds, ascending
    waits: list[float] = dataclasses.field(default_factory=list)      # in queues, seconds
    drawing: list[float] = dataclasses.field(default_factory=list)    # share of the time, by server
    processors: list[float] = dataclasses.field(default_factory=list)  # share of the cores in use, by machine
    in_system: float = 0  # mean number of pictures

    def percentile(self, percent: float) -> float:
        return percentile(self.latencies, percent)


def percentile(ascending: Sequence[float], percent: float) -> float:
    """By linear interpolation; 0 of nothing."""
    if not ascending:
        return 0
    place = percent / 100 * (len(ascending) - 1)
    low = int(place)
    high = min(low + 1, len(ascending) - 1)
    return ascending[low] + (place - low) * (ascending[high] - ascending[low])


def popularity(models: int, zipf: float) -> list[float]:
    """Cumulative weights of models."""
    return list(itertools.accumulate(1 / rank ** zipf for rank in range(1, models + 1)))


def poisson(rate: float, seconds: float, models: int = 1, zipf: float = 0, seed: int = 1) -> list[Arrival]:
    """Arrivals that know nothing of each other, `rate` a second."""
    dice, weights = random.Random(seed), popularity(models, zipf)
    times, time = [], dice.expovariate(rate)
    while time < seconds:
        times.append(time)
        time += dice.expovariate(rate)
    return [Arrival(time, model) for time, model in zip(times, dice.choices(range(models), cum_weights=weights,
                                                                            k=len(times)))]


class Ring:
    """Consistent hashing: each server has places on a ring; a model belongs to the next place after its own."""

    PLACES = 400

    def __init__(self, servers: int) -> None:
        self.places = sorted((self.hash(f"server {server} {place}"), server)
                             for server in range(servers) for place in range(self.PLACES))

    @staticmethod
    def hash(text: str) -> int:
        return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=8).digest(), "big")

    def servers_of(self, model: int) -> tuple[int, int]:
        """The server of a model, and the next other one; the same if there is no other."""
        begin = bisect.bisect(self.places, (self.hash(f"model {model}"), 0))
        order = (self.places[(begin + step) % len(self.places)][1] for step in range(len(self.places)))
        home = next(order)
        return home, next((server for server in order if server != home), home)


class Clock:
    """The time, and what happens later."""

    def __init__(self) -> None:
        self.now = 0.0
        self._later: list[tuple[float, int, Action]] = []
        self._count = itertools.count()

    def at(self, time: float, action: Action) -> None:
        heapq.heappush(self._later, (time, next(self._count), action))

    def run(self) -> None:
        while self._later:
            self.now, _, action = heapq.heappop(self._later)
            action()


class Processor:
    """Cores that all tasks of a machine share evenly; a task uses one core at most."""

    def __init__(self, clock: Clock, cores: float) -> None:
        self.clock, self.cores = clock, cores
        self.used = 0.0  # core seconds
        self._tasks: list[tuple[float, int, Action]] = []  # by the progress at which they end
        self._progress = 0.0  # processor time that each task has had since the beginning, seconds
        self._last = 0.0
        self._version = 0
        self._count = itertools.count()

    def run(self, work: float, done: Action) -> None:
        """Calls `done` when `work` seconds of processor time are spent; at once if there is no work."""
        if work <= 0:
            done()
            return
        self._advance()
        heapq.heappush(self._tasks, (self._progress + work, next(self._count), done))
        self._plan()

    def _rate(self) -> float:
        return min(1, self.cores / len(self._tasks))

    def _advance(self) -> None:
        if self._tasks:
            progress = (self.clock.now - self._last) * self._rate()
            self._progress += progress
            self.used += progress * len(self._tasks)
        self._last = self.clock.now

    def _plan(self) -> None:
        self._version += 1
        if self._tasks:
            left = max(self._tasks[0][0] - self._progress, 0)
            self.clock.at(self.clock.now + left / self._rate(), functools.partial(self._end, self._version))

    def _end(self, version: int) -> None:
        if version != self._version:
            return
        self._advance()
        _, _, done = heapq.heappop(self._tasks)
        self._plan()
        done()


@dataclasses.dataclass
class Picture:
    """A picture on its way."""
    model: int
    stages: Stages
    asked: float
    done: Callable[[bool], None]
    attempts: int = 0
    queued: float = 0
    waited: float = 0
    loads: bool = False


class Server:
    """One drawing stage with a queue before it, and encoders behind it."""

    def __init__(self, setup: Setup, clock: Clock, processor: Processor) -> None:
        self.setup, self.clock, self.processor = setup, clock, processor
        self.drawing_time = 0.0
        self._waiting: collections.deque[tuple[Picture, Action]] = collections.deque()
        self._to_encode: collections.deque[tuple[Picture, Action]] = collections.deque()
        self._drawing = False
        self._frames = self._encoding = 0
        self._models: collections.OrderedDict[int, None] = collections.OrderedDict()  # the last one was used last

    def take(self, picture: Picture, answer: Callable[[bool], None]) -> None:
        """Calls `answer` with False if the queue is full, and else when the picture is encoded."""
        half = picture.stages.serve / 2

        def received() -> None:
            if len(self._waiting) >= self.setup.queue:
                answer(False)
                return
            picture.queued = self.clock.now
            self._waiting.append((picture, lambda: self.processor.run(half, functools.partial(answer, True))))
            self._draw_next()

        self.processor.run(half, received)

    def _draw_next(self) -> None:
        if self._drawing or not self._waiting or self._frames >= self.setup.frames:
            return
        picture, answer = self._waiting.popleft()
        begin = self.clock.now
        picture.waited, picture.loads = begin - picture.queued, self._must_load(picture.model)
        self._drawing = True
        self._frames += 1

        def drawn() -> None:
            self._drawing = False
            self.drawing_time += self.clock.now - begin
            self._to_encode.append((picture, answer))
            self._encode_next()
            self._draw_next()

        self.processor.run(picture.stages.draw + (picture.stages.load if picture.loads else 0), drawn)

    def _encode_next(self) -> None:
        if self._encoding >= self.setup.encoders or not self._to_encode:
            return
        picture, answer = self._to_encode.popleft()
        self._encoding += 1

        def encoded() -> None:
            self._encoding -= 1
            self._frames -= 1
            answer()
            self._encode_next()
            self._draw_next()

        self.processor.run(picture.stages.encode, encoded)

    def _must_load(self, model: int) -> bool:
        """Whether nothing of a model is in memory; the model that was not used for longest makes room for it."""
        if self.setup.resident == 0:
            return False
        missing = model not in self._models
        self._models[model] = None
        self._models.move_to_end(model)
        if len(self._models) > self.setup.resident:
            self._models.popitem(last=False)
        return missing


class Simulation:
    """One run; see simulate."""

    def __init__(self, setup: Setup) -> None:
        self.setup, self.clock, self.result = setup, Clock(), Result(begin=setup.warm_up)
        self.dice = random.Random(setup.seed)
        machines = setup.machines or range(setup.servers)
        self.processors = [Processor(self.clock, setup.cores) for _ in range(max(machines) + 1)]
        self.servers = [Server(setup, self.clock, self.processors[machine]) for machine in machines]
        self.network = (Processor(self.clock, float("inf")) if setup.network_machine is None
                        else self.processors[setup.network_machine])
        ring = Ring(setup.servers)
        self.servers_of = functools.cache(ring.servers_of)
        self.popularity = popularity(setup.models, setup.zipf)
        self.present = 0       # pictures in the system that count
        self.present_time = 0.0  # their number, integrated over time
        self.changed = 0.0     # when their number last changed

    def run(self) -> Result:
        for arrival in self.setup.arrivals:
            self.clock.at(arrival.time, functools.partial(self.ask, arrival.model, lambda: None, arrival.stages))
        for _ in range(self.setup.clients):
            self.clock.at(self.dice.expovariate(1 / self.setup.think) if self.setup.think else 0, self.client)
        self.clock.run()
        return self.summary()

    def client(self) -> None:
        """A client asks, and again after it has thought about the answer."""
        if self.clock.now >= self.setup.seconds:
            return

        def think() -> None:
            pause = self.dice.expovariate(1 / self.setup.think) if self.setup.think else 0
            self.clock.at(self.clock.now + pause, self.client)

        self.ask(self.dice.choices(range(self.setup.models), cum_weights=self.popularity)[0], think)

    def ask(self, model: int, then: Action, stages: Stages | None = None) -> None:
        counts = self.clock.now >= self.setup.warm_up
        self.result.asked += counts
        self.change_present(counts)

        def done(answered: bool) -> None:
            if counts:
                self.count(picture, answered)
            then()

        picture = Picture(model, stages or self.dice.choice(self.setup.stages), self.clock.now, done)
        self.network.run(picture.stages.network / 2, functools.partial(self.attempt, picture))

    def route(self, model: int) -> tuple[int, int]:
        if not self.setup.homes:
            return self.servers_of(model)
        home = self.setup.homes[model]
        return home, (home + 1) % self.setup.servers

    def attempt(self, picture: Picture) -> None:
        """Tries the two servers of a model in turns."""
        server = self.servers[self.route(picture.model)[picture.attempts % 2]]
        picture.attempts += 1
        server.take(picture, functools.partial(self.answer, picture))

    def answer(self, picture: Picture, answered: bool) -> None:
        if answered or picture.attempts == self.setup.attempts:
            self.network.run(picture.stages.network / 2, functools.partial(picture.done, answered))
        else:
            self.attempt(picture)

    def change_present(self, change: int) -> None:
        self.present_time += self.present * (self.clock.now - self.changed)
        self.present += change
        self.changed = self.clock.now

    def count(self, picture: Picture, answered: bool) -> None:
        self.result.retried += picture.attempts - 1
        self.result.refused += not answered
        self.change_present(-1)
        if answered:
            self.result.loads += picture.loads
            self.result.latencies.append(self.clock.now - picture.asked)
            self.result.waits.append(picture.waited)

    def summary(self) -> Result:
        """The run ends with the last answer; clients that still think do not count."""
        result, all_time = self.result, self.changed
        result.end = all_time
        result.latencies.sort()
        result.waits.sort()
        if all_time > 0:
            result.drawing = [server.drawing_time / all_time for server in self.servers]
            result.processors = [processor.used / all_time / self.setup.cores for processor in self.processors]
        if all_time > result.begin:
            result.in_system = self.present_time / (all_time - result.begin)
        return result


def simulate(setup: Setup) -> Result:
    return Simulation(setup).run()


def read_stages(path: str) -> list[Stages]:
    with open(path, encoding="utf-8") as file:
        return [Stages(**each) for each in json.load(file)["stages"]]


def report(result: Result) -> dict[str, float]:
    """Figures of a run; times in milliseconds."""
    seconds = result.end - result.begin
    return {
        "pictures": result.asked,
        "per_second": round(len(result.latencies) / seconds, 2) if seconds > 0 else 0,
        "refused_percent": round(100 * result.refused / max(result.asked, 1), 3),
        "retried_percent": round(100 * result.retried / max(result.asked, 1), 3),
        "loads_percent": round(100 * result.loads / max(len(result.latencies), 1), 3),
        "p50_ms": round(1000 * result.percentile(50), 1),
        "p95_ms": round(1000 * result.percentile(95), 1),
        "p99_ms": round(1000 * result.percentile(99), 1),
        "drawing_mean_percent": round(100 * sum(result.drawing) / max(len(result.drawing), 1), 1),
        "drawing_most_percent": round(100 * max(result.drawing, default=0), 1),
        "processors_mean_percent": round(100 * sum(result.processors) / max(len(result.processors), 1), 1),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description="Simulates servers behind one address.")
    parser.add_argument("stages", help="times of pictures, written by scale_check.py")
    load = parser.add_mutually_exclusive_group(required=True)
    load.add_argument("--rate", type=float, help="pictures a second, asked for independently of each other")
    load.add_argument("--clients", type=int, help="clients of which each waits for its picture, thinks and asks again")
    parser.add_argument("--think", type=float, default=1, help="mean seconds that a client thinks (1)")
    parser.add_argument("--servers", type=int, default=3)
    parser.add_argument("--cores", type=float, default=2, help="of each server (2)")
    parser.add_argument("--models", type=int, default=100)
    parser.add_argument("--zipf", type=float, default=0, help="exponent of the popularity of models (0: all alike)")
    parser.add_argument("--resident", type=int, default=0, help="models in the memory of a server (0: all)")
    parser.add_argument("--queue", type=int, default=256, help="pictures that may wait in a server (256)")
    parser.add_argument("--seconds", type=float, default=600, help="simulated time (600)")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    arrivals = [] if arguments.rate is None else poisson(arguments.rate, arguments.seconds, arguments.models,
                                                         arguments.zipf, arguments.seed)
    result = simulate(Setup(
        read_stages(arguments.stages), arguments.servers, arguments.cores, models=arguments.models,
        resident=arguments.resident, queue=arguments.queue, arrivals=arrivals, clients=arguments.clients or 0,
        think=arguments.think, zipf=arguments.zipf, seconds=arguments.seconds, warm_up=arguments.seconds / 10,
        seed=arguments.seed))
    print(json.dumps(report(result), indent=2))
    return 0


if __name__ == "__main__":
    sys.exit(main())
