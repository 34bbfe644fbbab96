"""Sweeps over a cluster: a worker that is killed costs time and changes no bit. Oracle: the same program in a single run."""

import json
import os
import signal
import subprocess
import tempfile
import threading
import time
import unittest

from common import PROGRAM, ROOT, built

from palmistry.cluster import Failed, missing, sweep_command

try:
    from dask.distributed import Client, LocalCluster
except ImportError:
    Client = None

FILE = os.path.join(ROOT, "proofs", "moll2002", "general.proof")
SHARDS = 24
STUDIES = """title = "s"
model = "scene.proof"
duration = 1
samples = 21
[start]
x = 1.2
y = -0.5
[sensor]
noise = 0.01
[observer]
methods = ["trust-region"]
estimate = ["x", "y"]
window = 20
steps = 10
[study.noise]
levels = [1e-3, 1e-2]
seeds = 4
[study.basin]
x = [-2, 2]
y = [-2, 2]
points = 2
"""
SAMPLES = int(os.environ.get("PALMISTRY_CLUSTER_SAMPLES", "24000"))

clustered = unittest.skipUnless(Client, "Dask is not installed: pip install 'palmistry[dask]'")


def parts(folder):
    """How many parts are there, and no files that are being written."""
    return sum(name.startswith("rank-") for name in os.listdir(folder))


def output(*words):
    """What the program prints."""
    return subprocess.run([PROGRAM, *words], capture_output=True, check=True).stdout


@built
class OneMachine(unittest.TestCase):
    """Without Dask: the commands that the driver gives."""

    def test_what_is_missing(self):
        with tempfile.TemporaryDirectory() as folder:
            command = ["rank", FILE, "--samples", "50"]
            self.assertEqual(missing(command, 3, folder, PROGRAM), [1, 2, 3])
            output(*command, "--shard", "2/3", "--part", folder)
            self.assertEqual(missing(command, 3, folder, PROGRAM), [1, 3])
            # another question has no part there, and says whose these are
            with self.assertRaisesRegex(Failed, "rank-2-of-3.json belongs to another question"):
                missing(["rank", FILE, "--samples", "51"], 3, folder, PROGRAM)

    def test_what_the_program_says_is_said(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(Failed, "there is no file nowhere.proof"):
            missing(["rank", "nowhere.proof"], 3, folder, PROGRAM)


@built
@clustered
class Cluster(unittest.TestCase):
    def setUp(self):
        self.cluster = LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None)
        self.client = Client(self.cluster)
        self.addCleanup(self.cluster.close)
        self.addCleanup(self.client.close)

    def test_a_worker_is_killed_in_the_middle(self):
        command = ["rank", FILE, "--samples", str(SAMPLES), "--seed", "5"]
        with tempfile.TemporaryDirectory() as folder:
            found = []
            work = threading.Thread(target=lambda: found.append(sweep_command(command, SHARDS, folder, self.client, PROGRAM)))
            work.start()
            while parts(folder) < 3:
                self.assertTrue(work.is_alive(), "it is over before anything was killed")
                time.sleep(0.005)
            victim, pid = sorted(self.client.run(os.getpid).items())[0]
            os.kill(pid, signal.SIGKILL)
            self.assertLess(parts(folder), SHARDS - 3, "all but the last are done when one is killed")
            work.join(timeout=600)
            self.assertTrue(found, "the sweep has come to its end")
            self.assertNotIn(pid, self.client.run(os.getpid).values(), victim)
            # to the last byte, times left out
            merged = output(*command, "--merge", folder, "--json")
            self.assertEqual(merged, output(*command, "--no-times", "--json"))
            self.assertEqual(found[0], json.loads(merged))
            self.assertEqual(found[0]["samples"], SAMPLES)
            self.assertEqual(parts(folder), SHARDS)

    def test_the_studies_of_a_scene_are_swept(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = os.path.join(folder, "scene.toml")
            with open(os.path.join(folder, "scene.proof"), "w", encoding="utf-8") as file:
                file.write("system \"s\" state x, y drift f x' = y y' = 1.4*(1 - x^2)*y - x output x sample x in [-2, 2] y in [-2, 2]\n")
            with open(scene, "w", encoding="utf-8") as file:
                file.write(STUDIES)
            command, parts = ["observe", scene], os.path.join(folder, "parts")
            found = sweep_command(command, 3, parts, self.client, PROGRAM)
            self.assertEqual(found, json.loads(output(*command, "--studies", "--no-times", "--json")))
            self.assertEqual([level["seeds"] for level in found["noise"]], [4, 4])
            self.assertEqual([len(basin["arrives"]) for basin in found["basins"]], [4])
            self.assertEqual(sorted(os.listdir(parts)), [f"observe-{number}-of-3.json" for number in (1, 2, 3)])

    def test_a_damaged_part_is_done_again_and_a_whole_one_is_not(self):
        command = ["rank", FILE, "--samples", "300"]
        with tempfile.TemporaryDirectory() as folder:
            first = sweep_command(command, 4, folder, self.client, PROGRAM)
            times = {name: os.stat(os.path.join(folder, name)).st_mtime_ns for name in os.listdir(folder)}
            path = os.path.join(folder, "rank-3-of-4.json")
            with open(path, "r+", encoding="utf-8") as part:
                part.truncate(200)
            self.assertEqual(sweep_command(command, 4, folder, self.client, PROGRAM), first)
            changed = {name for name, before in times.items() if os.stat(os.path.join(folder, name)).st_mtime_ns != before}
            self.assertEqual(changed, {"rank-3-of-4.json"})

    def test_what_cannot_be_swept_is_said(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(Failed, "no state was found"):
            sweep_command(["rank", FILE, "--samples", "300", "--where", "r1 > 1000000"], 2, folder, self.client, PROGRAM, retries=0)


if __name__ == "__main__":
    unittest.main()
