"""The joint fit of mixing and feedback by NumPy, in batches: a baseline for the bench `couplings`.

    OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python3 benches/couplings_numpy.py

The fit is that of docs/couplings.md (M16.2). The synthetic problem has the size of the example:
6 outputs, 4 inputs, 200 frequencies, 11 conditions, 48 unknowns, 5 solves. The flight responses are
computed from a known mixing and feedback, which the fit must recover. Needs only NumPy.
"""

import platform
import timeit

import numpy as np

OUTPUTS = 6
INPUTS = 4
POINTS = 200
CONDITIONS = 11
SOLVES = 5
# Degree in airspeed of the diagonal entries of the mixing; the others are constant.
DEGREE = 2
# Weight of the start values, relative to the diagonal of the normal matrix.
RIDGE = 1e-3

# Unknowns of the mixing: row, column, power of the scaled airspeed.
MIXING = [
    (row, column, power)
    for column in range(INPUTS)
    for row in range(INPUTS)
    for power in range(DEGREE + 1 if row == column else 1)
]
# Unknowns of the feedback: input, output.
FEEDBACK = [(row, output) for row in range(INPUTS) for output in range(OUTPUTS)]
UNKNOWNS = len(MIXING) + len(FEEDBACK)


def matrices(theta, airspeed):
    """Return the mixing `M` at a scaled airspeed, and the feedback `K`."""
    mixing = np.zeros((INPUTS, INPUTS))
    for value, (row, column, power) in zip(theta, MIXING):
        mixing[row, column] += value * airspeed**power
    feedback = np.zeros((INPUTS, OUTPUTS))
    for value, (row, output) in zip(theta[len(MIXING) :], FEEDBACK):
        feedback[row, output] = value
    return mixing, feedback


def closed_loop(physics, feedback):
    """Return `S = (I - H K)^-1` and `F = S H` at every frequency."""
    sensitivity = np.linalg.inv(np.eye(OUTPUTS) - physics @ feedback)
    return sensitivity, sensitivity @ physics


def weights(flight, coupled):
    """Return the weight `q` of every frequency and response, without coherence and axes (s = 1).

    The squared error is that of the cost J.
    """
    ratio = coupled / flight
    magnitude_db = 20 * np.log10(np.abs(ratio))
    phase_deg = np.degrees(np.angle(ratio))
    squared_error = 20 * magnitude_db**2 + 20 * 0.0175 * phase_deg**2
    scale = np.maximum(np.abs(flight), 0.5 * np.abs(coupled))
    return 1 / scale / (1 + squared_error / 100) ** 0.25


def solve(problem, theta):
    """One pass: the rows of every condition and input, their normal equations, one solve."""
    normal = np.zeros((UNKNOWNS, UNKNOWNS))
    right = np.zeros(UNKNOWNS)
    for physics, flight, airspeed in problem:
        mixing, feedback = matrices(theta, airspeed)
        sensitivity, loop = closed_loop(physics, feedback)
        weight = weights(flight, loop @ mixing)
        wanted = sensitivity @ flight
        for column in range(INPUTS):
            places = [place for place, unknown in enumerate(MIXING) if unknown[1] == column]
            mixing_rows = np.stack(
                [loop[:, :, MIXING[place][0]] * airspeed ** MIXING[place][2] for place in places],
                axis=-1,
            )
            feedback_rows = loop[:, :, :, None] * flight[:, None, None, :, column]
            feedback_rows = feedback_rows.reshape(POINTS, OUTPUTS, -1)
            rows = np.concatenate([mixing_rows, feedback_rows], axis=-1)
            rows = (rows * weight[:, :, column, None]).reshape(-1, rows.shape[-1])
            target = (wanted[:, :, column] * weight[:, :, column]).ravel()
            rows = np.concatenate([rows.real, rows.imag])
            target = np.concatenate([target.real, target.imag])
            unknowns = places + list(range(len(MIXING), UNKNOWNS))
            normal[np.ix_(unknowns, unknowns)] += rows.T @ rows
            right[unknowns] += rows.T @ target
    ridge = RIDGE * np.diag(normal)
    return np.linalg.solve(normal + np.diag(ridge), right + ridge * start())


def start():
    """Return the unknowns without couplings: mixing `I`, feedback 0."""
    mixing = [float(row == column and power == 0) for row, column, power in MIXING]
    return np.array(mixing + [0.0] * len(FEEDBACK))


def fit(problem):
    """Return the unknowns after all passes."""
    theta = start()
    for _ in range(SOLVES):
        theta = solve(problem, theta)
    return theta


def synthetic_problem():
    """Return physics responses, flight responses and airspeed of each condition, and the truth."""
    random = np.random.default_rng(7)
    omega = np.geomspace(0.5, 12, POINTS)
    known = start() + 0.03 * random.standard_normal(UNKNOWNS)
    problem = []
    for airspeed in np.linspace(-1, 1, CONDITIONS):
        poles = random.uniform(0.5, 6, (OUTPUTS, INPUTS))
        gains = random.standard_normal((OUTPUTS, INPUTS))
        physics = gains / (1j * omega[:, None, None] + poles)
        mixing, feedback = matrices(known, airspeed)
        _, loop = closed_loop(physics, feedback)
        problem.append((physics, loop @ mixing, airspeed))
    return problem, known


def main():
    """Print the time of the fit, after a check that it recovers the truth."""
    problem, known = synthetic_problem()
    # The ridge draws entries that hardly affect the responses to their start values.
    error = np.abs(fit(problem) - known).max()
    assert error < 0.02, f"an unknown is wrong by {error}"
    milliseconds = 1e3 * min(timeit.repeat(lambda: fit(problem), number=1, repeat=10))
    machine = f"NumPy {np.__version__} on {platform.machine()}"
    print(f"{machine}: {SOLVES} solves of {UNKNOWNS} unknowns in {milliseconds:.0f} ms")


main()
