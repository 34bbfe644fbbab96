"""JAX: forward derivatives along the fields, reverse for the gradients, mapped over all states by `vmap` and compiled by
`jit` for one CPU thread in doubles. States go in and entries come out one array each, the fastest of the forms that were
tried (stacked vectors, forward gradients, states in rows). Singular values by its own batched routine."""

import os

os.environ["JAX_PLATFORMS"] = "cpu"
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"

import jax
import jax.numpy as jnp
import numpy as np

jax.config.update("jax_enable_x64", True)


def prepare(job, states, _variant):
    names = job.model.states

    def lie(field, value):
        def derivative(x):
            rates = job.model.fields(x, jnp)[field]
            rates = [jnp.full_like(part, rates.get(name, 0.0)) for name, part in zip(names, x)]
            return jax.jvp(value, (x,), (rates,))[1]

        return derivative

    def row(output, word):
        value = lambda x: x[names.index(output)]
        for field in word:
            value = lie(field, value)
        return jax.grad(value)

    gradients = [row(output, word) for output, word in job.rows]

    def rows(x):
        found = [gradient(x) for gradient in gradients]
        return [[gradient[column] for column in job.columns] for gradient in found]

    def singular(x):
        matrix = jnp.stack([jnp.stack(row) for row in rows(x)])
        matrix /= jnp.linalg.norm(matrix, axis=1, keepdims=True)
        if job.singular == "whole":
            matrix = jnp.concatenate([jnp.eye(len(names))[jnp.array(job.outputs)], matrix])
        return jnp.linalg.svd(matrix, compute_uv=False)

    columns = [jnp.array(column) for column in np.ascontiguousarray(states.T)]
    call = jax.jit(jax.vmap(singular if job.singular else rows)).lower(columns).compile()
    evaluate = lambda: jax.block_until_ready(call(columns))
    return evaluate, (np.asarray if job.singular else lambda entries: np.moveaxis(np.array(entries), 2, 0))
