"""A sweep over many machines: the shards of a command that are missing are submitted to a Dask cluster, and their parts merged.

    pip install 'palmistry[dask]'
    import palmistry
    system = palmistry.System.read("/shared/mysystem.proof")
    answer = palmistry.sweep(system, samples=1e9, client=client)

and of any command, `palmistry.cluster.sweep_command(["observe", "scene.toml"], shards=640, folder="/shared/parts", client=client)`.

`client` is any `dask.distributed.Client`: of a cluster on this machine, or of SLURM or PBS by dask-jobqueue. A task runs the program in
a process of its own, on a folder that all machines see, and returns the name of its file and nothing else: no result passes the
scheduler. A part appears under its name when it is whole, and a shard whose part is there returns at once, so that a task may be
started as often as one likes. What is lost with a machine is done again. The answer is that of a single run, to the last bit.
"""

import json
import os
import subprocess
import sys
import time


class Failed(Exception):
    """What the program said that could not be done again."""


def run(program, words, threads=None):
    """Runs the program; what it prints, and its exit status. Raises `Failed` with its own words where it has no result."""
    environment = dict(os.environ, **({"RAYON_NUM_THREADS": str(threads)} if threads else {}))
    done = subprocess.run([program, *words], capture_output=True, text=True, env=environment, check=False)
    if done.returncode < 0:
        raise RuntimeError(f"ended by signal {-done.returncode}: {' '.join(words)}")  # to be tried again
    if done.returncode not in (0, 1, 3) or not done.stdout and done.stderr:
        raise Failed(f"{' '.join([program, *words])}\n{done.stderr.strip()}")
    return done.stdout, done.returncode


def do_shard(program, command, number, shards, folder, threads):
    """Does one shard; the name of the file of its part."""
    words = [*command, "--shard", f"{number}/{shards}", "--part", folder, "--json"]
    text, status = run(program, words, threads)
    if status != 0:
        raise RuntimeError(f"shard {number}/{shards} was interrupted")  # to be tried again
    return json.loads(text)["part"]


def missing(command, shards, folder, program="palmistry"):
    """The numbers of the shards whose parts are not there."""
    os.makedirs(folder, exist_ok=True)
    text, _ = run(program, [*command, "--missing", folder, str(shards), "--json"])
    return json.loads(text)["missing"]


def sweep_command(command, shards, folder, client, program="palmistry", merge=(), threads=1, retries=5, rounds=3, progress=True):
    """Does what is missing of `command` in so many shards on a cluster, and merges: the JSON of the answer, as an object.

    command: the words of the command, as ["rank", "mysystem.proof", "--samples", "1000000"], or ["observe", "scene.toml"] for the studies
    of a scene; paths as the workers see them.
    merge: further words for the merge alone, as ["--digits", "40"]. threads: of each process; with one thread for each worker
    the processors are shared best. retries: how often a shard that fails is tried again by Dask; rounds: how often what is still missing
    is submitted, since a file may be lost after its task has ended. Raises `Failed` with the program's own words.
    """
    from dask.distributed import as_completed

    folder, begin = os.path.abspath(folder), time.monotonic()
    for _ in range(rounds):
        wanted = missing(command, shards, folder, program)
        if not wanted:
            break
        futures = [client.submit(do_shard, program, list(command), number, shards, folder, threads, pure=False, retries=retries)
                   for number in wanted]
        for count, future in enumerate(as_completed(futures), 1):
            failure = future.exception()
            if isinstance(failure, Failed):
                client.cancel(futures)
                raise failure
            if progress and sys.stderr.isatty():
                print(f"\r{count} of {len(wanted)} shards, {time.monotonic() - begin:.0f} s", end="", file=sys.stderr, flush=True)
        if progress and sys.stderr.isatty():
            print(file=sys.stderr)
    text, _ = run(program, [*command, *merge, "--merge", folder, "--json"])
    return json.loads(text)


class _Merged:
    """An answer of the program, as the compiled half would hand it over."""

    def __init__(self, found, text):
        self._found, self._text = json.dumps(found), text

    def json(self):
        return self._found

    def text(self):
        return self._text

    def html(self):
        from html import escape

        return f"<pre>{escape(self._text)}</pre>"

    def table(self):
        return None


def sweep(system, samples, *, client, shards=None, folder=None, seed=1, at=None, where=(), order=None, threads=1, progress=True):
    """The rank of the observability codistribution at very many sampled states, by the workers of a Dask cluster: the `Rank` of a single run, to the last bit.

    system: one that was read from a file, or the path of one, where all workers see it. samples: how many states are drawn. client: a `dask.distributed.Client`. shards: into how many parts the
    work is cut, eight for each worker's thread unless given. folder: where the parts are kept, which all workers see, the proof file's name with `.parts` unless given; what is there already is not done
    again, so that a sweep that was ended goes on where it was. seed, at, where, order: as in `System.rank`. threads: of each process. A worker that dies takes nothing with it: its shard is done again.

    >>> palmistry.sweep(rod, samples=1e9, client=None)
    Traceback (most recent call last):
    palmistry.cluster.Failed: ... is no file that the workers could read: write the source of the system into one, and read that
    """
    from .answers import Rank
    from .program import path
    from .system import _pairs, _several

    file = os.path.abspath(system if isinstance(system, (str, os.PathLike)) else system.name)
    if not os.path.isfile(file):
        raise Failed(f"{file} is no file that the workers could read: write the source of the system into one, and read that")
    if not isinstance(system, (str, os.PathLike)):
        from .system import System

        if System.read(file).source != system.source:
            raise Failed(f"{file} has changed since it was read: read it again")
    command = ["rank", file, "--samples", str(int(samples)), "--seed", str(seed)]
    command += [f"--at={pair}" for pair in _pairs(at)] + [f"--where={condition}" for condition in _several(where)]
    command += [] if order is None else ["--order", str(order)]
    folder = os.path.abspath(folder or f"{file}.parts")
    shards = shards or max(8 * sum(client.nthreads().values()), 8)
    program = path()
    found = sweep_command(command, shards, folder, client, program, threads=threads, progress=progress)
    # the command looks for it as well: here it is a method of its own, System.singular_set
    found.pop("singular_set", None)
    text, _ = run(program, [*command, "--merge", folder])
    return Rank(_Merged(found, text.rstrip("\n")))
