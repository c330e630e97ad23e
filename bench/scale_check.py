#!/usr/bin/env python3
"""Compares bench/simulate.py with real servers: scale_check.py BIN MODEL [--loads L ...] [--stages FILE]

BIN is the folder of surfcastd; MODEL is served under many names by three servers behind HAProxy (see cluster.py), which
share the cores of this machine. First the stages of single pictures are measured, one picture at a time. Then pictures
are asked for at given times, independently of each other, for each load: a share of the rate at which the measured
processor time of pictures fills all cores. The simulation gets the same arrivals, the measured stages, and the measured
places of models. Each server is bound to a core, because the simulation shares cores evenly and the system's scheduler
does not always. The speed of a shared machine drifts: the simulation of a run scales the measured stages by the
processor time of a picture in that run. If the difference is large, the run is printed and repeated. The exit code is 1
if a p95 of the last runs differs by more than 15 %.
"""
import argparse
import asyncio
import dataclasses
import json
import os
import random
import re
import sys
import time

import cluster
import simulate

TICK = os.sysconf("SC_CLK_TCK")
CORES = (0, 1, 1)  # of the three servers
NETWORK_CORE = 0   # of clients and proxy
SIZES = ("160,128", "256,192", "320,240", "384,288")


def busy_time() -> float:
    """Seconds that all cores together have worked since the system's start, time taken by other guests included."""
    with open("/proc/stat", encoding="ascii") as file:
        user, nice, system, _, _, irq, softirq, steal = map(int, file.readline().split()[1:9])
    return (user + nice + system + irq + softirq + steal) / TICK


def family(roots: list[int]) -> dict[int, float]:
    """Processes and their descendants, and the processor seconds of each."""
    parents, times = {}, {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat", encoding="utf-8") as file:
                fields = file.read().rpartition(")")[2].split()
        except OSError:
            continue
        parents[int(name)], times[int(name)] = int(fields[1]), (int(fields[11]) + int(fields[12])) / TICK

    def belongs(process: int) -> bool:
        while process not in roots:
            if process not in parents:
                return False
            process = parents[process]
        return True

    return {process: taken for process, taken in times.items() if belongs(process)}


def family_time(roots: list[int]) -> float:
    return sum(family(roots).values())


@dataclasses.dataclass(frozen=True)
class Costs:
    """Processor time of a picture, seconds."""
    servers: float
    network: float  # clients and proxy


class Usage:
    """Processor time that the cluster and others take."""

    def __init__(self, tested: cluster.Cluster) -> None:
        self.roots = [os.getpid(), tested.proxy.pid, *(server.pid for server in tested.servers.values())]
        self.begin, self.own, self.all = time.monotonic(), family_time(self.roots), busy_time()
        self.servers = family_time(self.roots[2:])

    def seconds(self) -> float:
        """Processor time of the cluster and its clients since the beginning."""
        return family_time(self.roots) - self.own

    def costs(self, pictures: int) -> "Costs":
        servers = family_time(self.roots[2:]) - self.servers
        return Costs(servers / pictures, (self.seconds() - servers) / pictures)

    def others(self) -> float:
        """Share of all cores that other programs have taken since the beginning."""
        seconds = (time.monotonic() - self.begin) * (os.cpu_count() or 1)
        return max(busy_time() - self.all - self.seconds(), 0) / seconds


@dataclasses.dataclass
class Answer:
    status: int
    seconds: float
    stages: dict[str, float]  # seconds


async def fetch(port: int, model: int, size: str, asked: float) -> Answer:
    """A picture; its time counts from the moment at which it was to be asked for."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    path = f"/api/models/model{model}/image?resolution={size}&spacing=3"
    writer.write(f"GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n".encode())
    head = (await reader.read()).partition(b"\r\n\r\n")[0].decode("latin-1")
    seconds = time.monotonic() - asked
    writer.close()
    stages = {name: float(duration) / 1000 for name, duration in re.findall(r"(\w+);dur=([\d.e+-]+)", head)}
    return Answer(int(head.split()[1]), seconds, stages)


def stages_of(answer: Answer) -> simulate.Stages:
    encode = answer.stages["encode"]
    return simulate.Stages(sum(answer.stages.values()) - encode - answer.stages["queue"], encode)


@dataclasses.dataclass
class Measured:
    """Stages of pictures by their size."""
    stages: dict[str, list[simulate.Stages]]

    def all(self) -> list[simulate.Stages]:
        return [each for of_size in self.stages.values() for each in of_size]

    def mean(self, name: str) -> float:
        return sum(getattr(each, name) for each in self.all()) / len(self.all())

    def load(self, first: list[tuple[str, simulate.Stages]]) -> float:
        """What first pictures take beyond others of their size."""
        draws = {size: sum(each.draw for each in of_size) / len(of_size) for size, of_size in self.stages.items()}
        return max(sum(stages.draw - draws[size] for size, stages in first) / len(first), 0)

    def scaled(self, factor: float) -> "Measured":
        """The stages on a machine that needs `factor` times the processor time."""
        return Measured({size: [simulate.Stages(*(factor * value for value in dataclasses.astuple(each)))
                                for each in of_size] for size, of_size in self.stages.items()})

    def at_costs(self, alone: Costs, loaded: Costs, load: float) -> "Measured":
        """The stages of servers under load. Protocols take what is left of the processor time of pictures alone."""
        factor = loaded.servers / alone.servers
        serve = max(loaded.servers - factor * (self.mean("draw") + self.mean("encode")), 0)
        return Measured({size: [simulate.Stages(factor * each.draw, factor * each.encode, serve, loaded.network,
                                                load)
                                for each in of_size] for size, of_size in self.stages.items()})


async def load_models(port: int, models: int) -> list[tuple[str, simulate.Stages]]:
    """Draws each model in each size; the sizes and stages of the first pictures, which load the models."""
    first = []
    for model in range(models):
        sizes = SIZES[model % len(SIZES):] + SIZES[:model % len(SIZES)]
        answers = [await fetch(port, model, size, time.monotonic()) for size in sizes]
        first.append((sizes[0], stages_of(answers[0])))
    return first


async def measure_stages(port: int, models: int, pictures: int) -> Measured:
    """One picture at a time, of models that are loaded."""
    dice, measured = random.Random(1), Measured({size: [] for size in SIZES})
    for _ in range(pictures):
        size = dice.choice(SIZES)
        answer = await fetch(port, dice.randrange(models), size, time.monotonic())
        measured.stages[size].append(stages_of(answer))
    return measured


@dataclasses.dataclass(frozen=True)
class Asked:
    """A picture of a run."""
    time: float  # seconds
    model: int
    size: str


def schedule(rate: float, seconds: float, models: int, seed: int) -> list[Asked]:
    dice = random.Random(seed)
    return [Asked(each.time, each.model, dice.choice(SIZES))
            for each in simulate.poisson(rate, seconds, models, seed=seed)]


async def ask_for(port: int, pictures: list[Asked]) -> list[Answer]:
    begin, pending = time.monotonic(), []
    for each in pictures:
        await asyncio.sleep(max(begin + each.time - time.monotonic(), 0))
        pending.append(asyncio.create_task(fetch(port, each.model, each.size, begin + each.time)))
    return await asyncio.gather(*pending)


def real_run(tested: cluster.Cluster, pictures: list[Asked]) -> dict[str, float]:
    usage = Usage(tested)
    answers = asyncio.run(ask_for(tested.port, pictures))
    servers, others = usage.costs(len(pictures)).servers, usage.others()
    times = sorted(answer.seconds for answer in answers if answer.status == 200)
    return {"p50": simulate.percentile(times, 50), "p95": simulate.percentile(times, 95),
            "refused": len(answers) - len(times), "servers": servers, "others": others}


def simulated(measured: Measured, homes: list[int], pictures: list[Asked]) -> dict[str, float]:
    """Means over several choices among the measured times of each size."""
    results = []
    for seed in range(1, 11):
        dice = random.Random(seed)
        arrivals = [simulate.Arrival(each.time, each.model, dice.choice(measured.stages[each.size]))
                    for each in pictures]
        results.append(simulate.simulate(simulate.Setup(
            [], servers=3, cores=1, machines=CORES, network_machine=NETWORK_CORE, models=len(homes), homes=homes,
            arrivals=arrivals)))
    return {f"p{percent}": sum(result.percentile(percent) for result in results) / len(results)
            for percent in (50, 95)}


def pin(tested: cluster.Cluster) -> None:
    """Binds each server with all its processes and threads to its core, and proxy and clients to theirs."""
    for server, core in zip(tested.servers.values(), CORES):
        for process in family([server.pid]):
            for thread in os.listdir(f"/proc/{process}/task"):
                os.sched_setaffinity(int(thread), {core})
    for process in (os.getpid(), tested.proxy.pid):
        os.sched_setaffinity(process, {NETWORK_CORE})


def line(load: float, rate: float, real: dict[str, float], model: dict[str, float]) -> str:
    columns = [f"{load:.2f}", f"{rate:.1f}"]
    columns += [f"{1000 * figures[name]:.0f}" for name in ("p50", "p95") for figures in (real, model)]
    columns += [f"{round(100 * (model['p95'] / real['p95'] - 1)):+d} %", f"{real['refused']}"]
    columns += [f"{1000 * real['servers']:.1f}", f"{100 * real['others']:.0f} %"]
    return "| " + " | ".join(columns) + " |"


def measure(tested: cluster.Cluster, homes: list[int], samples: int) -> tuple[Measured, Costs]:
    """The stages of single pictures, and what they cost under a load, which is none of those that are compared."""
    first = asyncio.run(load_models(tested.port, len(homes)))
    usage = Usage(tested)
    measured = asyncio.run(measure_stages(tested.port, len(homes), samples))
    alone = usage.costs(samples)
    load = measured.load(first)
    pictures = schedule(0.7 * capacity(measured.at_costs(alone, alone, load), homes), 20, len(homes), seed=11)
    usage = Usage(tested)
    asyncio.run(ask_for(tested.port, pictures))
    loaded = usage.costs(len(pictures))
    draw, encode = 1000 * measured.mean("draw"), 1000 * measured.mean("encode")
    print(f"one picture at a time: draw {draw:.1f}, encode {encode:.1f} ms; a first one {1000 * load:.1f} ms more")
    for name, costs in (("at a time", alone), ("under load", loaded)):
        print(f"processor time of a picture {name}: server {1000 * costs.servers:.1f}, "
              f"clients and proxy {1000 * costs.network:.1f} ms")
    return measured.at_costs(alone, loaded, load), loaded


def capacity(measured: Measured, homes: list[int]) -> float:
    """Pictures a second at which the busier core has no idle time."""
    work = [0.0, 0.0]
    for home in homes:
        work[CORES[home]] += sum(map(measured.mean, ("draw", "encode", "serve"))) / len(homes)
    work[NETWORK_CORE] += measured.mean("network")
    return 1 / max(work)


def main() -> int:
    parser = argparse.ArgumentParser(description="Compares the simulation of servers with three real ones.")
    parser.add_argument("programs")
    parser.add_argument("model")
    parser.add_argument("--loads", nargs="*", type=float, default=[0.3, 0.6, 0.85])
    parser.add_argument("--samples", type=int, default=400, help="pictures whose stages are measured (400)")
    parser.add_argument("--seconds", type=float, default=40, help="of each run (40)")
    parser.add_argument("--disturbed", type=float, default=0.1,
                        help="a run is repeated if a picture took so much more or less processor time (0.1)")
    parser.add_argument("--tries", type=int, default=3, help="runs of a load at most (3)")
    parser.add_argument("--stages", help="file for the measured stages")
    arguments = parser.parse_args()
    names = [f"model{model}" for model in range(60)]
    os.environ["LP_NUM_THREADS"] = "0"
    with cluster.Cluster(arguments.programs, arguments.model, names) as tested:
        pin(tested)
        homes = [cluster.NAMES.index(cluster.server_of(tested, name)) for name in names]
        measured, costs = measure(tested, homes, arguments.samples)
        if arguments.stages:
            with open(arguments.stages, "w", encoding="utf-8") as file:
                json.dump({"stages": [{name: round(value, 6) for name, value in dataclasses.asdict(each).items()}
                                      for each in measured.all()]}, file)
        print("| load | pictures/s | p50 real | p50 simulated | p95 real | p95 simulated | difference | refused | "
              "processor time | other programs |")
        missed = 0
        for load in arguments.loads:
            rate = load * capacity(measured, homes)
            pictures = schedule(rate, arguments.seconds, len(homes), seed=7)
            for _ in range(arguments.tries):
                real = real_run(tested, pictures)
                slower = real["servers"] / costs.servers
                model = simulated(measured.scaled(slower), homes, pictures)
                print(line(load, rate, real, model), flush=True)
                if abs(slower - 1) <= arguments.disturbed:
                    break
            missed += abs(model["p95"] / real["p95"] - 1) > 0.15
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
