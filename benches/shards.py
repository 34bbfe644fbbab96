"""What a shard costs, and what many of them would: measured in seconds of processor time, which other work on the machine does not change much.

    python3 benches/shards.py [--program target/release/palmistry] [--file proofs/moll2002/general.proof]

A shard of n states costs a + c n, a merge of m parts b + d m; all four are fitted by least squares. With P cores, S states and N shards, none of
which waits for another, it takes ceil(N / P) (a + c S / N) + b + (d + s) N, where s is what the scheduler does for a task, one after the other.
Before they are compared, shards are drawn in another order, so that what the machine does meanwhile is no trend.
"""

import argparse
import math
import random
import resource
import subprocess
import tempfile

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


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--program", default="target/release/palmistry")
    options.add_argument("--file", default="proofs/moll2002/general.proof")
    options.add_argument("--states", type=int, default=1_000_000, help="of the largest shard")
    options = options.parse_args()
    command = [options.program, "rank", options.file, "--samples"]
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
