"""What a shard costs, and what many of them would: measured in seconds of processor time, which other work on the machine does not change much.

    python3 benches/shards.py [--program target/release/palmistry] [--file proofs/moll2002/general.proof] [--workers 10000000]

A shard of n states costs a + c n, a merge of m parts b + d m; all four are fitted by least squares. With P cores, S states and N shards, none of
which waits for another, it takes ceil(N / P) (a + c S / N) + b + (d + s) N, where s is what the scheduler does for a task, one after the other.
With `--workers S` it runs S states once by one thread and once in 16 shards by two processes side by side, and compares: in processor
time, which is what a worker of its own machine takes, and by the clock, which means something where nothing else runs.

Before they are compared, shards are drawn in another order, so that what the machine does meanwhile is no trend.
"""

import argparse
import math
import os
import random
import resource
import subprocess
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

# of client and scheduler, measured with 2000 tasks that return the name of a file, on two workers
SCHEDULER = 1.4e-3


def cost(words):
    """Seconds of processor time of a process, of the system included."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def line(points):
    """The line through points by least squares, weighted so that each counts by its own size."""
    weights = [1 / max(y, 1e-3) ** 2 for _, y in points]
    total = sum(weights)
    x0 = sum(w * x for w, (x, _) in zip(weights, points)) / total
    y0 = sum(w * y for w, (_, y) in zip(weights, points)) / total
    slope = sum(w * (x - x0) * (y - y0) for w, (x, y) in zip(weights, points)) / sum(w * (x - x0) ** 2 for w, (x, _) in zip(weights, points))
    return y0 - slope * x0, slope


def on_two_workers(command, states):
    """What 16 shards on two processes and their merge cost, beside one run by one thread."""
    one = {"RAYON_NUM_THREADS": "1", **{name: value for name, value in os.environ.items() if name != "RAYON_NUM_THREADS"}}

    def timed(work):
        begin, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
        work()
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, time.monotonic() - begin

    def run(*words):
        return subprocess.run([*command, str(states), *words], check=True, capture_output=True, env=one).stdout

    with tempfile.TemporaryDirectory() as folder:
        answers = []
        alone = timed(lambda: answers.append(run("--no-times", "--json")))
        with ThreadPoolExecutor(2) as pool:
            shards = timed(lambda: list(pool.map(lambda number: run("--shard", f"{number}/16", "--part", folder), range(1, 17))))
        merge = timed(lambda: answers.append(run("--merge", folder, "--json")))
    same = "the same to the last byte" if answers[0] == answers[1] else "NOT THE SAME"
    spent = shards[0] + merge[0]
    print(f"{states:.0e} states: alone {alone[0]:.2f} s, 16 shards {shards[0]:.2f} s and their merge {merge[0]:.3f} s of processor: "
          f"efficiency {100 * alone[0] / spent:.1f} %; {same}")
    print(f"by the clock {alone[1]:.2f} s alone, {shards[1] + merge[1]:.2f} s by two: {100 * alone[1] / (shards[1] + merge[1]) / 2:.0f} % of two")


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--program", default="target/release/palmistry")
    options.add_argument("--file", default="proofs/moll2002/general.proof")
    options.add_argument("--states", type=int, default=1_000_000, help="of the largest shard")
    options.add_argument("--workers", type=int, default=0, metavar="STATES", help="measure two workers with so many states, and nothing else")
    options = options.parse_args()
    command = [options.program, "rank", options.file, "--samples"]
    if options.workers:
        return on_two_workers(command, options.workers)
    sizes = [0, 0, 0, options.states // 16, options.states // 4, options.states // 2, options.states] * 2
    random.shuffle(sizes)
    points = []
    for size in sizes:
        with tempfile.TemporaryDirectory() as folder:
            # one of a thousand shards of which the others are never done
            points.append((size, cost([*command, str(1000 * size), "--shard", "500/1000", "--part", folder])))
    shard, state = line(points)
    merges = []
    for parts in [1, 10, 100, 300]:
        with tempfile.TemporaryDirectory() as folder:
            for number in range(1, parts + 1):
                subprocess.run([*command, str(parts), "--shard", f"{number}/{parts}", "--part", folder], check=True, stdout=subprocess.DEVNULL)
            merges.append((parts, cost([*command, str(parts), "--merge", folder])))
    merge, part = line(merges)
    print(f"a shard {1e3 * shard:.1f} ms, a state {1e6 * state:.3f} us, a merge {1e3 * merge:.1f} ms and {1e3 * part:.3f} ms a part")
    for cores, states in [(2, 10**9), (100, 10**11), (10_000, 10**12), (10_000, 10**13)]:
        best = None
        for each in [1, 2, 4, 8, 16, 32, 64]:
            shards = min(each * cores, 10**6)
            wall = math.ceil(shards / cores) * (shard + state * states / shards) + merge + (part + SCHEDULER) * shards
            best = min(best or (wall, shards), (wall, shards))
        wall, shards = best
        print(f"{cores} cores, {states:.0e} states: {shards} shards, {wall:.0f} s, efficiency {100 * state * states / cores / wall:.1f} %")


if __name__ == "__main__":
    main()
