"""The joint fit of mixing and feedback (M16.2) by NumPy, in batches: a baseline for `cargo bench --bench couplings`.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python3 benches/couplings_numpy.py

A made-up problem of the example's size: 6 outputs, 4 inputs, 200 frequencies, 11 conditions, 48 unknowns, 5 solves. Flight is made of a
known mixing and feedback, which have to come back. Needs NumPy alone.
"""

import platform
import timeit

import numpy as np

OUTPUTS, INPUTS, POINTS, CONDITIONS, SOLVES, DEGREE, RIDGE = 6, 4, 200, 11, 5, 2, 1e-3
MIXED = [(j, i, k) for i in range(INPUTS) for j in range(INPUTS) for k in range(DEGREE + 1 if i == j else 1)]
FED = [(j, o) for j in range(INPUTS) for o in range(OUTPUTS)]


def matrices(theta, v):
    """`M` at the scaled airspeed v, and `K`."""
    mixing, feedback = np.zeros((INPUTS, INPUTS)), np.zeros((INPUTS, OUTPUTS))
    for value, (j, i, k) in zip(theta, MIXED):
        mixing[j, i] += value * v**k
    for value, (j, o) in zip(theta[len(MIXED):], FED):
        feedback[j, o] = value
    return mixing, feedback


def closed(physics, feedback):
    """`S = (I - H K)^-1` and `F = S H` at every frequency."""
    s = np.linalg.inv(np.eye(OUTPUTS) - physics @ feedback)
    return s, s @ physics


def weights(flight, coupled):
    """`q` of every frequency and response."""
    ratio = coupled / flight
    e2 = 20 * (20 * np.log10(np.abs(ratio))) ** 2 + 20 * 0.0175 * np.degrees(np.angle(ratio)) ** 2
    return 1 / np.maximum(np.abs(flight), 0.5 * np.abs(coupled)) / (1 + e2 / 100) ** 0.25


def solve(problem, theta):
    """One pass: rows of every condition and input, their normal equations, one solve."""
    count = len(MIXED) + len(FED)
    gram, right = np.zeros((count, count)), np.zeros(count)
    for physics, flight, v in problem:
        mixing, feedback = matrices(theta, v)
        s, f = closed(physics, feedback)
        q, wanted = weights(flight, f @ mixing), s @ flight
        for i in range(INPUTS):
            places = [n for n, (_, of, _) in enumerate(MIXED) if of == i]
            mixed = np.stack([f[:, :, MIXED[n][0]] * v ** MIXED[n][2] for n in places], axis=-1)
            fed = (f[:, :, :, None] * flight[:, None, None, :, i]).reshape(POINTS, OUTPUTS, -1)
            rows = np.concatenate([mixed, fed], axis=-1) * q[:, :, i, None]
            rows, target = rows.reshape(-1, rows.shape[-1]), (wanted[:, :, i] * q[:, :, i]).ravel()
            rows, target = np.concatenate([rows.real, rows.imag]), np.concatenate([target.real, target.imag])
            columns = places + list(range(len(MIXED), count))
            gram[np.ix_(columns, columns)] += rows.T @ rows
            right[columns] += rows.T @ target
    uncoupled = start()
    drawn = RIDGE * np.diag(gram)
    return np.linalg.solve(gram + np.diag(drawn), right + drawn * uncoupled)


def start():
    return np.array([float(j == i and k == 0) for j, i, k in MIXED] + [0.0] * len(FED))


def fit(problem):
    theta = start()
    for _ in range(SOLVES):
        theta = solve(problem, theta)
    return theta


def made_up():
    random = np.random.default_rng(7)
    omega = np.geomspace(0.5, 12, POINTS)
    known = start() + 0.03 * random.standard_normal(len(start()))
    problem = []
    for v in np.linspace(-1, 1, CONDITIONS):
        poles = random.uniform(0.5, 6, (OUTPUTS, INPUTS))
        gains = random.standard_normal((OUTPUTS, INPUTS))
        physics = gains / (1j * omega[:, None, None] + poles)
        mixing, feedback = matrices(known, v)
        problem.append((physics, closed(physics, feedback)[1] @ mixing, v))
    return problem, known


def main():
    problem, known = made_up()
    found = fit(problem)
    # A ridge of 1e-3 draws entries that hardly affect the responses to zero.
    error = np.abs(found - known).max()
    assert error < 0.02, error
    seconds = min(timeit.repeat(lambda: fit(problem), number=1, repeat=10))
    print(f"NumPy {np.__version__} on {platform.machine()}: {SOLVES} solves of {len(known)} unknowns in {1e3 * seconds:.0f} ms")


main()
