"""The simulation against closed forms of queues: simulate_test.py BENCH

SURFCAST_SIMULATED_SECONDS: length of the long runs, in mean service times.
"""
import dataclasses
import math
import os
import pathlib
import subprocess
import sys
import unittest

sys.path.insert(0, sys.argv.pop(1))
import simulate  # noqa: E402
from simulate import Arrival, Setup, Stages, poisson, simulate as run  # noqa: E402

ENDLESS = 10 ** 9
SECONDS = int(os.environ.get("SURFCAST_SIMULATED_SECONDS", 40_000))
# Service times of mean 1 with an exponential distribution: the middles of classes that are equally likely.
EXPONENTIAL = [Stages(-math.log(1 - (index + 0.5) / 20000)) for index in range(20000)]
CONSTANT = [Stages(1)]


def mean(values):
    return sum(values) / len(values)


class OneServer(unittest.TestCase):
    """Poisson arrivals at a server that only draws."""

    @classmethod
    def setUpClass(cls):
        cls.load = 0.5
        arrivals = poisson(cls.load, SECONDS, seed=3)
        cls.exponential = run(Setup(EXPONENTIAL, queue=ENDLESS, arrivals=arrivals, cores=1, warm_up=1000))
        cls.constant = run(Setup(CONSTANT, queue=ENDLESS, arrivals=arrivals, cores=1, warm_up=1000))

    def test_mean_wait_of_exponential_times(self):
        expected = self.load / (1 - self.load)
        self.assertAlmostEqual(mean(self.exponential.waits), expected, delta=0.02 * expected)

    def test_mean_wait_of_constant_times(self):
        expected = self.load / (2 * (1 - self.load))
        self.assertAlmostEqual(mean(self.constant.waits), expected, delta=0.02 * expected)

    def test_percentile_of_exponential_times(self):
        expected = math.log(20) / (1 - self.load)
        self.assertAlmostEqual(self.exponential.percentile(95), expected, delta=0.02 * expected)

    def test_number_in_the_system_follows_from_rate_and_time(self):
        seconds = self.exponential.end - self.exponential.begin
        expected = self.exponential.asked / seconds * mean(self.exponential.latencies)
        self.assertAlmostEqual(self.exponential.in_system, expected, delta=0.001 * expected)
        self.assertAlmostEqual(self.exponential.in_system, self.load / (1 - self.load), delta=0.02)

    def test_share_of_time_spent_drawing_is_the_load(self):
        self.assertAlmostEqual(self.exponential.drawing[0], self.load, delta=0.01)
        self.assertAlmostEqual(self.exponential.processors[0], self.load, delta=0.01)


class FullQueue(unittest.TestCase):
    """Pictures are refused beyond a number in the system."""

    def test_share_of_refused_pictures(self):
        load, waiting = 0.8, 3
        most = waiting + 1
        result = run(Setup(EXPONENTIAL, queue=waiting, attempts=1, arrivals=poisson(load, 200_000, seed=5)))
        expected = (1 - load) * load ** most / (1 - load ** (most + 1))
        self.assertAlmostEqual(result.refused / result.asked, expected, delta=0.02 * expected)

    def test_each_picture_is_answered_or_refused(self):
        result = run(Setup(EXPONENTIAL, servers=3, models=7, queue=1, arrivals=poisson(4, 2000, models=7)))
        self.assertGreater(result.refused, 0)
        self.assertEqual(result.asked, len(result.latencies) + result.refused)

    def test_the_next_server_takes_what_one_refuses(self):
        # At the same time: one is drawn and one waits in each of two servers, and the fifth finds no place.
        setup = Setup(CONSTANT, servers=3, queue=1, arrivals=[Arrival(0, 0)] * 5)
        result = run(setup)
        self.assertEqual(result.latencies, [1, 1, 2, 2])
        self.assertEqual((result.refused, result.retried), (1, 5))
        self.assertEqual(sorted(result.drawing), [0, 1, 1])
        alone = run(dataclasses.replace(setup, attempts=1))
        self.assertEqual((alone.latencies, alone.refused), ([1, 2], 3))


class SharedCores(unittest.TestCase):
    """Servers of one machine."""

    def test_tasks_share_a_core_evenly(self):
        # 1 s and 3 s of work from the same time on: the second one has the core for itself after 2 s.
        order = [run(Setup([Stages(1), Stages(3)], servers=2, cores=1, machines=(0, 0), models=2, homes=(0, 1),
                           arrivals=[Arrival(0, 0), Arrival(0, 1)], seed=seed)).latencies for seed in range(20)]
        self.assertIn([2, 4], order)

    def test_mean_number_in_a_shared_core(self):
        # Processor sharing (M/G/1-PS) holds load / (1 - load) tasks for any distribution of times. With so many servers
        # nearly every task has one of its own.
        load, servers = 0.6, 100
        result = run(Setup([Stages(0.5), Stages(1.5)], servers=servers, cores=1, machines=(0,) * servers,
                           models=servers, homes=range(servers), queue=ENDLESS,
                           arrivals=poisson(load, SECONDS // 2, models=servers)))
        self.assertAlmostEqual(result.in_system, load / (1 - load), delta=0.05 * load / (1 - load))

    def test_a_task_uses_one_core_at_most(self):
        result = run(Setup(CONSTANT, cores=2, arrivals=[Arrival(0, 0)]))
        self.assertEqual((result.latencies, result.processors), ([1], [0.5]))

    def test_network_takes_time_of_its_machine(self):
        stages = [Stages(draw=1, network=1)]
        own = run(Setup(stages, cores=1, arrivals=[Arrival(0, 0), Arrival(0.75, 0)]))
        self.assertEqual(own.latencies, [2, 2.25])  # the second waits for half of the first picture's drawing
        shared = run(Setup(stages, cores=1, network_machine=0, arrivals=[Arrival(0, 0), Arrival(0.75, 0)]))
        self.assertGreater(shared.latencies[0], 2)


class Stage(unittest.TestCase):
    """What happens in a server beside drawing."""

    def test_pictures_are_encoded_while_others_are_drawn(self):
        result = run(Setup([Stages(1, encode=1)], arrivals=[Arrival(0, 0)] * 3))
        self.assertEqual(result.latencies, [2, 3, 4])

    def test_unencoded_pictures_stop_drawing(self):
        result = run(Setup([Stages(1, encode=10)], encoders=1, frames=2, arrivals=[Arrival(0, 0)] * 3))
        self.assertEqual(result.latencies, [11, 21, 31])
        self.assertEqual(result.waits, [0, 1, 11])

    def test_models_are_loaded_when_they_are_not_in_memory(self):
        asked = [Arrival(10 * index, model) for index, model in enumerate([0, 1, 0, 2, 0, 1])]
        result = run(Setup([Stages(1, load=2)], models=3, resident=2, arrivals=asked))
        self.assertEqual(result.loads, 4)  # 0, 1, 2, and 1 again, which was not used for longest
        self.assertEqual(result.latencies, [1, 1, 3, 3, 3, 3])

    def test_clients_wait_for_their_pictures(self):
        # Without pauses, five clients keep the only stage busy, and each waits for the pictures of all.
        result = run(Setup(CONSTANT, clients=5, think=0, seconds=100))
        self.assertEqual(result.latencies[50], 5)
        self.assertEqual(result.drawing, [1])

    def test_a_run_ends_with_the_last_answer(self):
        # About 20 of the clients ask; most of the others would after 100 s.
        self.assertLess(run(Setup(CONSTANT, clients=200, think=100, seconds=10)).end, 40)

    def test_protocols_take_time_of_the_server_beside_drawing(self):
        result = run(Setup([Stages(1, serve=0.5)], arrivals=[Arrival(0, 0)] * 2))
        self.assertEqual(result.latencies, [1.5, 2.5])

    def test_closed_clients_with_pauses(self):
        # The machine repair model: with N clients, load a = service / pause, P(0) = 1 / sum(N! / (N - n)! a^n).
        clients, pause = 4, 3.0
        empty = 1 / sum(math.perm(clients, busy) / pause ** busy for busy in range(clients + 1))
        result = run(Setup(EXPONENTIAL, clients=clients, think=pause, seconds=SECONDS // 2))
        self.assertAlmostEqual(result.drawing[0], 1 - empty, delta=0.01)


class Routing(unittest.TestCase):
    """The ring of servers."""

    def test_models_move_only_to_a_new_server(self):
        three, four = simulate.Ring(3), simulate.Ring(4)
        moved = [(three.servers_of(model)[0], four.servers_of(model)[0]) for model in range(3000)]
        self.assertTrue(all(after in (before, 3) for before, after in moved))
        self.assertAlmostEqual(mean([before != after for before, after in moved]), 1 / 4, delta=0.05)

    def test_the_next_server_is_another_one(self):
        ring = simulate.Ring(3)
        self.assertTrue(all(home != second for home, second in map(ring.servers_of, range(100))))
        self.assertEqual(simulate.Ring(1).servers_of(5), (0, 0))


class Inputs(unittest.TestCase):
    """A run is a function of its inputs."""

    def test_the_seed_decides(self):
        setup = Setup(EXPONENTIAL, servers=3, models=10, zipf=1, clients=20, think=2, seconds=500)
        self.assertEqual(run(setup), run(setup))
        self.assertNotEqual(run(setup), run(dataclasses.replace(setup, seed=2)))

    def test_popularity_falls_with_the_rank(self):
        counts = [0] * 3
        for arrival in poisson(100, 1000, models=3, zipf=1):
            counts[arrival.model] += 1
        shares = [count / sum(counts) for count in counts]
        for share, expected in zip(shares, (6 / 11, 3 / 11, 2 / 11)):
            self.assertAlmostEqual(share, expected, delta=0.01)

    def test_percentiles(self):
        self.assertEqual(simulate.percentile([1, 2, 4], 50), 2)
        self.assertEqual(simulate.percentile([1, 2, 4], 75), 3)
        self.assertEqual(simulate.percentile([], 95), 0)


class Program(unittest.TestCase):
    """The command line."""

    def test_figures_of_a_file_of_stages(self):
        stages = pathlib.Path(simulate.__file__).with_name("stages.json")
        program = [sys.executable, simulate.__file__, stages, "--servers", "2", "--rate", "1", "--seconds", "60"]
        printed = subprocess.run(program, capture_output=True, text=True, check=True).stdout
        self.assertIn('"refused_percent": 0.0', printed)


if __name__ == "__main__":
    unittest.main()
