"""The fit and its covariance, by SciPy's least squares on the package's residual function."""

from __future__ import annotations

import ballbar
import numpy as np
import pytest
from conftest import a_test
from numpy.typing import NDArray
from scipy.linalg import lstsq, solve, solve_triangular, toeplitz
from scipy.optimize import least_squares

Array = NDArray[np.float64]

#: So far both may be apart, in standard deviations.
CLOSE = 1e-6
#: Where the fit itself ends: what it would still gain is this part of a standard deviation of all parameters together.
NEGLIGIBLE = 0.3


def drawn(number: int) -> ballbar.Campaign:
    """A random test, simulated and identified."""
    return drawn_at(number)[0]


def drawn_at(number: int) -> tuple[ballbar.Campaign, float]:
    """The same, and the time from one reading to the next, s."""
    random = np.random.default_rng(number)
    machine, place = [("vertical", (11.0, 0.0, -250.0)), ("hu40t", (0.0, 0.0, 100.0))][number % 2]
    bar_mm, feed_mm_min = float(random.choice([100.0, 150.0])), float(random.uniform(1500.0, 3000.0))
    rate_hz = float(random.choice([8.0, 12.0, 20.0]))
    test = a_test(
        machine,
        ["2d", "3d5", "3d6", "iso230-4"][number // 2 % 4],
        coincidence_mm=place,
        bar_mm=bar_mm,
        feed_mm_min=feed_mm_min,
        rate_hz=rate_hz,
        loss=str(random.choice(["off", "huber"])),
    )
    noise = {"white_um": float(random.uniform(0.05, 0.4))}
    if random.random() < 0.5:
        noise |= {"correlated_um": 0.1, "correlation_s": 0.3}
    simulated = ballbar.simulate(test, scenario={"noise": noise}, seed=number)
    # Times of a log have four decimals.
    return ballbar.identify(test, simulated.runs), round(1.0 / rate_hz, 4)


def noise_covariance(fit: ballbar.Identification, count: int) -> Array:
    """Covariance of neighbouring readings, um^2: the stationary autoregression, by the Yule-Walker equations."""
    phi, variance = fit.noise_phi, fit.noise_innovation_um**2
    order = phi.size
    equations = np.eye(order + 1)
    for lag in range(order + 1):
        for k in range(order):
            equations[lag, abs(lag - k - 1)] -= phi[k]
    right = np.zeros(order + 1)
    right[0] = variance
    covariances = list(solve(equations, right))
    while len(covariances) < count:
        covariances.append(float(phi @ covariances[: -order - 1 : -1]) if order else 0.0)
    return np.asarray(toeplitz(covariances[:count]))


def inverse_of_normal(jacobian: Array) -> Array:
    """``(J'J)^-1`` by scaled columns and without forming J'J, which loses half of the digits."""
    scale = np.linalg.norm(jacobian, axis=0)
    inverse = solve_triangular(np.linalg.qr(jacobian / scale, mode="r"), np.eye(scale.size)) / scale[:, None]
    return np.asarray(inverse @ inverse.T)


def likely_beside(fit: ballbar.Identification, problem: ballbar.Problem, jacobian: Array, period_s: float) -> Array:
    """Covariance of the cells' sums that likely noises add to the autoregression, um^2, by the lag in cells.

    White noise with noise that hangs together for a time, a Gaussian of means over cells each, by restricted likelihood: what the fit
    has taken out is an unknown without a prior.
    """
    readings = problem.stretch.size
    size = max(1, round(max(0.1, readings * period_s / 2048.0) / period_s))
    weighed = 1.0 / problem.reading_sigma_um[:, None]
    counts_um = problem.reading_sigma_um.min()
    residuals = problem.residuals(problem.values_at_rest)[:readings, None]
    # Orthonormal over all rows, and of that what the readings of whole cells have.
    q = np.linalg.qr(jacobian / np.linalg.norm(jacobian, axis=0))[0][:readings]
    both = np.hstack([q * weighed * counts_um, residuals * weighed * counts_um**2])
    arcs = []
    for stretch in np.unique(problem.stretch):
        of = both[problem.stretch == stretch]
        whole = len(of) // size
        arcs.append(of[: whole * size].reshape(whole, size, -1).sum(axis=1) / np.sqrt(size))
    share, directions = np.linalg.eigh(sum(arc[:, :-1].T @ arc[:, :-1] for arc in arcs))
    directions = directions[:, share > 0.5]
    every_s, lags = size * period_s, np.arange(max(len(arc) for arc in arcs) + 1)
    noises = [(0.05, 0.0)]
    noises += [(t, s) for t in (0.05, 0.1, 0.2, 0.35, 0.6, 1.0, 1.4, 2.0) for s in (0.2, 0.4, 0.6, 0.8, 0.95, 1.0)]
    told = []
    for time_s, part in noises:
        row = part * np.exp(-lags * every_s / time_s)
        row[0] = 1.0
        own = directions.shape[1]
        normal, along = np.zeros((own, own)), np.zeros((own, 1))
        square, log, count = 0.0, 0.0, -own
        for arc in arcs:
            root = np.linalg.cholesky(toeplitz(row[: len(arc)]))
            x, e = np.split(solve_triangular(root, arc, lower=True), [-1], axis=1)
            x = x @ directions
            normal, along, square = normal + x.T @ x, along + x.T @ e, square + (e.T @ e).item()
            log, count = log + 2.0 * np.log(np.diag(root)).sum(), count + len(arc)
        left = square - (along.T @ np.linalg.solve(normal, along)).item()
        told.append((count * np.log(left) + log + np.linalg.slogdet(normal)[1], left / count))
    evidence, variance = np.array(told).T
    weight = np.exp(0.5 * (evidence.min() - evidence))
    variance = variance * weight / weight.sum()
    times, parts = np.array(noises).T
    correlation = np.exp(-every_s / times)
    lasting = variance * parts * (1.0 + correlation) / (1.0 - correlation)
    long_run = (fit.noise_innovation_um / (1.0 - fit.noise_phi.sum())) ** 2
    beyond = (variance * (1.0 - parts) + lasting).sum() - long_run
    if beyond <= 0.0:
        return np.zeros(lags.size)
    pieces = sum(len(arc) for arc in arcs) * (variance * parts).sum() / lasting.sum()
    beyond *= min(1.0, directions.shape[1] / pieces)
    by_lag = (variance * parts) @ np.exp(-np.outer(1.0 / times, lags * every_s))
    return np.asarray(beyond / lasting.sum() * by_lag / size)


def sandwich(
    fit: ballbar.Identification, problem: ballbar.Problem, jacobian: Array, period_s: float
) -> Array:
    """``(J'J)^-1 (J'SJ + Z'KZ + T'T) (J'J)^-1`` in standard deviations: S the noise of readings, Z sums over cells with what likely
    noises have beyond it, T the rows about time."""
    readings = problem.stretch.size
    inverse = inverse_of_normal(jacobian)
    about = np.asarray(problem.about)
    times = jacobian[about == "time"]
    middle = times.T @ times
    rows = jacobian[:readings] / problem.reading_sigma_um[:, None]
    beside = likely_beside(fit, problem, jacobian, period_s)
    size = max(1, round(max(0.1, readings * period_s / 2048.0) / period_s))
    for stretch in np.unique(problem.stretch):
        of = rows[problem.stretch == stretch]
        middle += of.T @ noise_covariance(fit, len(of)) @ of
        cells = np.add.reduceat(of, np.arange(0, len(of), size))
        middle += cells.T @ toeplitz(np.append(beside, np.zeros(2))[: len(cells)]) @ cells
    return np.asarray(inverse @ middle @ inverse)


def by_scipy(problem: ballbar.Problem, start: Array, scale: Array) -> Array:
    """SciPy's solution.

    Lengths of 150 mm have rounding of 3e-14 mm, and sums of squares of the residuals change with it by as much as for
    1e-5 to 1e-4 standard deviations: there MINPACK ends. Its own last derivatives tell the rest.
    """
    found = least_squares(
        problem.residuals, start, jac=problem.jacobian, method="lm", x_scale=scale, xtol=1e-15, ftol=1e-15, gtol=1e-15
    )
    values = np.asarray(found.x)
    for _ in range(2):
        step = lstsq(problem.jacobian(values) * scale, problem.residuals(values))[0]
        assert np.max(np.abs(step)) < 1e-3
        values = values - step * scale
    return values


@pytest.mark.parametrize("number", range(20))
def test_fit_and_covariance_are_those_of_scipy(number: int) -> None:
    campaign, period_s = drawn_at(number)
    fit = campaign[0]
    problem, count = fit.problem(), len(fit.names)
    rest = problem.values_at_rest
    jacobian = problem.jacobian(rest)
    sigma = np.sqrt(np.diag(inverse_of_normal(jacobian)))
    start = rest + sigma * np.random.default_rng(number + 100).standard_normal(rest.size)
    theirs = by_scipy(problem, start, sigma)
    assert np.max(np.abs(problem.solve(start) - theirs) / sigma) < CLOSE
    assert np.max(np.abs(fit.value - theirs[:count]) / sigma[:count]) < NEGLIGIBLE

    expected = sandwich(fit, problem, jacobian, period_s)[:count, :count]
    scale = np.outer(sigma[:count], sigma[:count])
    assert np.max(np.abs(fit.covariance - expected) / scale) < CLOSE
    # What the readings do not tell from other plausible faults makes up the whole.
    assert fit.left_open is not None
    whole = expected + fit.left_open @ fit.left_open.T
    assert np.allclose(np.sqrt(np.diag(whole)), fit.sigma_all, rtol=CLOSE)


def test_derivatives_are_those_of_the_residuals() -> None:
    problem = drawn(1)[0].problem()
    rest = problem.values_at_rest
    jacobian = problem.jacobian(rest)
    sigma = 1.0 / np.linalg.norm(jacobian, axis=0)
    for k, name in enumerate(problem.names):
        step = np.zeros_like(rest)
        step[k] = 10.0 * sigma[k]
        # From both sides: what is left is the third derivative and rounding.
        ahead, back = problem.residuals(rest + step), problem.residuals(rest - step)
        error = np.linalg.norm((ahead - back) / 20.0 - jacobian[:, k] * sigma[k])
        # Directions of the tool ball are those of a machine that does not turn it by some 10 urad.
        assert error < (1e-4 if name[:1] == "E" else 1e-5), name
