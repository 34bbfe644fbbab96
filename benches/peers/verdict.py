"""What decides the rank: singular values of rows scaled to length one, by LAPACK through numpy, in one batch."""

import numpy as np


class Assembly:
    """Puts computed entries, as they come out of a peer, into matrices whose other entries are constant.

    `nonzero` are the places (row, column) of the entries that the peer computes, in its order."""

    def __init__(self, job, states, nonzero):
        rows, columns = len(job.rows), len(job.columns)
        if job.singular == "whole":
            self.matrices = np.zeros((len(states), len(job.outputs) + rows, columns))
            for row, column in enumerate(job.outputs):
                self.matrices[:, row, column] = 1
            self.computed = self.matrices[:, len(job.outputs):, :]
        else:
            self.computed = self.matrices = np.zeros((len(states), rows, columns))
        self.rows, self.columns = (np.array(index) for index in zip(*nonzero))

    def fill(self, entries):
        """`entries` are by state and place."""
        self.computed[:, self.rows, self.columns] = entries
        return self.matrices

    def singular_values(self, entries):
        """Largest first."""
        self.fill(entries)
        self.computed /= np.linalg.norm(self.computed, axis=2, keepdims=True)
        return np.linalg.svd(self.matrices, compute_uv=False)


def finish(job, states, nonzero, evaluate, by_state=lambda entries: entries):
    """`evaluate` and `unpack` as a worker wants them. `by_state` brings what `evaluate` returns into the order of
    states; for a matrix it belongs to unpacking and is not timed, for a verdict it is."""
    assembly = Assembly(job, states, nonzero)
    if job.singular:
        return (lambda: assembly.singular_values(by_state(evaluate()))), (lambda values: values)
    return evaluate, (lambda entries: assembly.fill(by_state(entries)))
