"""One peer on one job, in a process of its own: `worker.py PEER JOB STATES RESULTS`.

It prepares (from the mathematics of `model.py` to code that is ready to run), says `prepared SECONDS`, and then obeys lines on
standard input: `run` evaluates all states again and again for at least 20 ms and answers with the seconds of one
evaluation; `write` writes the results to the file RESULTS as doubles. STATES are doubles, one state after another.
Data are in memory before a clock starts, in whatever order the peer likes best.
"""

import importlib
import sys
import time

import numpy as np

from model import JOBS

ENOUGH = 0.02


def main():
    peer, job_name, states_file, results_file = sys.argv[1:]
    module, _, variant = peer.partition(":")
    job = JOBS[job_name]
    states = np.fromfile(states_file).reshape(-1, len(job.model.states))
    module = importlib.import_module(module)

    begin = time.perf_counter()
    evaluate, unpack = module.prepare(job, states, variant)
    print("prepared", time.perf_counter() - begin, flush=True)
    evaluate()

    for line in sys.stdin:
        if line.strip() == "run":
            count, begin = 0, time.perf_counter()
            while (elapsed := time.perf_counter() - begin) < ENOUGH:
                evaluate()
                count += 1
            print("took", elapsed / count, flush=True)
        elif line.strip() == "write":
            np.ascontiguousarray(unpack(evaluate()), dtype=float).tofile(results_file)
            print("written", flush=True)


if __name__ == "__main__":
    main()
