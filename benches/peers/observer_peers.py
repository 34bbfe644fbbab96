"""scipy, CasADi with IPOPT, and filterpy as observers of a system that is written by hand for them (observed_systems.py,
observed_palms.py): rates and outputs by numpy or CasADi, a recording, a guess; each returns what it recovered, in the order of the
system's states.

Each run is a process of its own, forked before any of these libraries is loaded, so that its memory is its own, and time is counted
once they are loaded. This file imports none of them at its top for that reason.
"""

import math
import os
import pickle
import resource
import time
import traceback
import warnings

SCIPY, CASADI, FILTERPY = "scipy, least squares by shooting", "CasADi, IPOPT, multiple shooting", "filterpy, unscented"


def rated(system, state, t):
    """Rates at a state by the functions of `math`, on single numbers some times as fast as numpy's; no numbers where there are none."""
    try:
        return system.rates(math, state.tolist(), system.inputs(t))
    except (ValueError, ArithmeticError):
        return [math.nan] * len(state)


def by_scipy(system, data, guess, limit):
    import numpy as np
    from scipy.integrate import solve_ivp
    from scipy.optimize import least_squares

    times, read = data["times"], data["read"]
    yield
    end = time.process_time() + limit

    def rates(t, state):
        if time.process_time() > end:
            raise TimeoutError
        found = rated(system, state, t)
        if not all(map(math.isfinite, found)):
            # scipy shortens a step that is no number for ever
            raise FloatingPointError
        return found

    def residual(state):
        try:
            path = solve_ivp(rates, (times[0], times[-1]), state, t_eval=times, rtol=1e-8, atol=1e-10, method="DOP853")
        except (ValueError, FloatingPointError):
            return np.full(read.size, 1e6)
        if path.y.shape[1] != len(times) or not np.isfinite(path.y).all():
            return np.full(read.size, 1e6)
        seen = np.array(system.outputs(np, path.y)).T
        return ((seen - read) / data["spread"]).ravel()

    scale = [(high - low) / 2 for low, high in system.box.values()]
    yield least_squares(residual, guess, x_scale=scale, xtol=1e-12, ftol=1e-12, gtol=1e-12, max_nfev=200).x


def by_casadi(system, data, guess, limit):
    """A node at every sample, some steps of Runge and Kutta between two, constants once; nodes begin at the guess, and at what is read."""
    import casadi
    import numpy as np

    times, read = data["times"], data["read"]
    yield
    names = list(system.box)
    constants = [i for i, name in enumerate(names) if name in system.constants]
    moving = [i for i in range(len(names)) if i not in constants]
    scale = np.array([max(abs(low), abs(high)) for low, high in system.box.values()])

    def whole(node, values):
        state = [None] * len(names)
        for k, i in enumerate(moving):
            state[i] = node[k] * scale[i]
        for k, i in enumerate(constants):
            state[i] = values[k] * scale[i]
        return state

    # from one node to the next, and what is seen at a node: compiled once each, as CasADi is meant to be used
    halves = range(2 * system.parts + 1)
    known = np.array([[system.inputs(t + (end - t) * half / (2 * system.parts)) for half in halves] for t, end in zip(times, times[1:])])
    node, shared = casadi.SX.sym("node", len(moving)), casadi.SX.sym("shared", max(len(constants), 1))
    given, h = casadi.SX.sym("given", known.shape[2], known.shape[1]), casadi.SX.sym("h")
    state = whole(node, shared)
    add = lambda a, b, k: [x + k * y for x, y in zip(a, b)]
    for part in range(system.parts):
        begin, half, end = ([given[k, 2 * part + at] for k in range(known.shape[2])] for at in range(3))
        k1 = system.rates(casadi, state, begin)
        k2 = system.rates(casadi, add(state, k1, h / 2), half)
        k3 = system.rates(casadi, add(state, k2, h / 2), half)
        k4 = system.rates(casadi, add(state, k3, h), end)
        state = [s + h / 6 * (a + 2 * b + 2 * c + d) for s, a, b, c, d in zip(state, k1, k2, k3, k4)]
    onward = casadi.Function("onward", [node, shared, given, h], [casadi.vertcat(*[state[i] / scale[i] for i in moving])])
    seen = casadi.Function("seen", [node, shared], [casadi.vertcat(*system.outputs(casadi, whole(node, shared)))])

    problem = casadi.Opti()
    nodes = problem.variable(len(moving), len(times))
    values = problem.variable(max(len(constants), 1))
    count = len(times) - 1
    signals = known.reshape(count * known.shape[1], known.shape[2]).T
    lengths = (np.diff(times) / system.parts).reshape(1, -1)
    after = onward.map(count)(nodes[:, :-1], casadi.repmat(values, 1, count), signals, lengths)
    problem.subject_to(nodes[:, 1:] == after)
    expected = seen.map(count + 1)(nodes, casadi.repmat(values, 1, count + 1))
    cost = casadi.sumsqr((expected - read.T) / np.repeat(data["spread"].reshape(-1, 1), count + 1, axis=1))
    # what has one sign in the sample box keeps it, so that roots exist
    for k, i in enumerate(moving):
        if system.box[names[i]][0] >= 0:
            problem.subject_to(nodes[k, :] >= 1e-6)
    for k, i in enumerate(constants):
        low, high = system.box[names[i]]
        problem.subject_to(problem.bounded(low / 100 / scale[i], values[k], (2 * high - low) / scale[i]))
    first = np.array([[guess[i] / scale[i]] * len(times) for i in moving])
    for output, place in enumerate(system.read):
        if place is not None:
            first[moving.index(place)] = read[:, output] / scale[place]
    problem.set_initial(nodes, first)
    problem.set_initial(values, [guess[i] / scale[i] for i in constants] or [0])
    if not constants:
        problem.subject_to(values == 0)
    problem.minimize(cost)
    quiet = {"print_level": 0, "max_cpu_time": limit, "max_iter": 500, "tol": 1e-10, "sb": "yes"}
    problem.solver("ipopt", {"print_time": False}, quiet)
    try:
        problem.solve()
    except RuntimeError:
        pass
    found = np.empty(len(names))
    found[moving] = problem.debug.value(nodes[:, 0]) * scale[moving]
    if constants:
        found[constants] = problem.debug.value(values) * scale[constants]
    yield found


def by_filterpy(system, data, guess, limit):
    import numpy as np
    from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter

    times, read = data["times"], data["read"]
    yield
    n = len(guess)
    size = np.array([max((high - low) / 2, abs(value)) for (low, high), value in zip(system.box.values(), guess)])

    def follow(state, dt, t):
        h = dt / 8
        for part in range(8):
            now = t + part * h
            rate = lambda s, at: np.array(rated(system, s, at))
            k1 = rate(state, now)
            k2 = rate(state + h / 2 * k1, now + h / 2)
            k3 = rate(state + h / 2 * k2, now + h / 2)
            k4 = rate(state + h * k3, now + h)
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return state

    points = MerweScaledSigmaPoints(n, alpha=0.1, beta=2.0, kappa=3.0 - n)
    estimate = UnscentedKalmanFilter(n, read.shape[1], times[1] - times[0], hx=lambda s: np.array(system.outputs(np, s)), fx=follow, points=points)
    estimate.x = np.array(guess, dtype=float)
    estimate.P = np.diag((0.5 * size) ** 2)
    estimate.R = np.eye(read.shape[1]) * max(data["sigma"], 1e-6) ** 2
    estimate.update(read[0])
    for k in range(1, len(times)):
        dt = times[k] - times[k - 1]
        estimate.Q = np.diag((0.01 * size) ** 2 * dt)
        try:
            estimate.predict(dt=dt, t=times[k - 1])
            estimate.update(read[k])
        except (np.linalg.LinAlgError, ValueError) as why:
            # a covariance that has no root any more, or no numbers in it
            raise ArithmeticError from why
    yield estimate.x


PEERS = {SCIPY: by_scipy, CASADI: by_casadi, FILTERPY: by_filterpy}


def alone(method, system, data, guess, limit):
    """What a peer recovered (nothing where it failed or took longer than the limit), its seconds of the processor, and the most
    memory of its process in bytes."""
    ours, theirs = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(ours)
        found, status = None, 1
        try:
            # what does not look at the clock itself
            resource.setrlimit(resource.RLIMIT_CPU, (int(limit) + 10, int(limit) + 10))
            warnings.simplefilter("ignore")
            search = PEERS[method](system, data, guess, limit)
            # up to here libraries are loaded
            next(search)
            begin = time.process_time()
            try:
                found = [float(value) for value in next(search)]
            except (TimeoutError, ArithmeticError):
                pass
            with os.fdopen(theirs, "wb") as pipe:
                pickle.dump((found, time.process_time() - begin), pipe)
            status = 0
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(status)
    os.close(theirs)
    with os.fdopen(ours, "rb") as pipe:
        told = pipe.read()
    _, status, spent = os.wait4(child, 0)
    if os.waitstatus_to_exitcode(status) > 0:
        raise RuntimeError(f"{method} failed on {system.name}")
    found, seconds = pickle.loads(told) if told else (None, limit)
    return found, seconds, 1024 * spent.ru_maxrss
