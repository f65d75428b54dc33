"""The fit and its covariance, by SciPy's least squares on the package's residual function."""

from __future__ import annotations

import ballbar
import numpy as np
import pytest
from conftest import a_test
from numpy.typing import NDArray
from scipy.linalg import solve, toeplitz
from scipy.optimize import least_squares

Array = NDArray[np.float64]

#: So far both may be apart, in standard deviations.
CLOSE = 1e-6


def drawn(number: int) -> tuple[ballbar.Test, ballbar.Campaign]:
    """A random test, simulated and identified."""
    random = np.random.default_rng(number)
    strategy = str(random.choice(["xy", "yz", "zx"]))
    machine = str(random.choice(["vertical", "hu40t"]))
    place = {"vertical": (11.0, 0.0, -198.0), "hu40t": (0.0, 0.0, 100.0)}[machine]
    test = a_test(
        machine,
        strategy,
        coincidence_mm=place,
        bar_mm=float(random.choice([100.0, 150.0])),
        feed_mm_min=float(random.uniform(800.0, 2500.0)),
        rate_hz=float(random.choice([15.0, 30.0])),
        loss=str(random.choice(["off", "huber"])),
    )
    noise = {"white_um": float(random.uniform(0.05, 0.4))}
    if random.random() < 0.5:
        noise |= {"correlated_um": 0.1, "correlation_s": 0.3}
    scenario = {"noise": noise}
    campaign = ballbar.identify(test, ballbar.simulate(test, scenario=scenario, seed=number).runs)
    return test, campaign


def far_from(rest: Array, sigma: Array, number: int) -> Array:
    """Values that are some standard deviations from where the fit came to rest."""
    return rest + 3.0 * sigma * np.random.default_rng(number + 100).standard_normal(rest.size)


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


def sandwich(fit: ballbar.Identification, problem: ballbar.Problem, jacobian: Array) -> Array:
    """``(J'J)^-1 (J'SJ + T'T) (J'J)^-1`` in standard deviations: S the noise of readings, T the rows about time."""
    readings = problem.stretch.size
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    about = np.asarray(problem.about)
    times = jacobian[about == "time"]
    middle = times.T @ times
    rows = jacobian[:readings] / problem.reading_sigma_um[:, None]
    for stretch in np.unique(problem.stretch):
        of = rows[problem.stretch == stretch]
        middle += of.T @ noise_covariance(fit, len(of)) @ of
    return np.asarray(inverse @ middle @ inverse)


@pytest.mark.parametrize("number", range(20))
def test_fit_and_covariance_are_those_of_scipy(number: int) -> None:
    _, campaign = drawn(number)
    fit = campaign[0]
    problem, count = fit.problem(), len(fit.names)
    rest = problem.values_at_rest
    jacobian = problem.jacobian(rest)
    sigma = np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))
    start = far_from(rest, sigma, number)
    theirs = least_squares(
        problem.residuals, start, jac=problem.jacobian, x_scale=sigma, xtol=1e-15, ftol=1e-15, gtol=1e-15
    )
    ours = problem.solve(start)
    assert np.max(np.abs(ours - theirs.x) / sigma) < CLOSE
    # The fit itself ends where a step would gain nothing that noise lets see.
    assert np.max(np.abs(fit.value - theirs.x[:count]) / sigma[:count]) < 0.05

    expected = sandwich(fit, problem, jacobian)[:count, :count]
    scale = np.outer(sigma[:count], sigma[:count])
    assert np.max(np.abs(fit.covariance - expected) / scale) < CLOSE
    # What these readings leave open makes up the whole of what is known without them.
    assert fit.left_open is not None
    whole = expected + fit.left_open @ fit.left_open.T
    assert np.allclose(np.sqrt(np.diag(whole)), fit.sigma_all, rtol=CLOSE)


def test_derivatives_are_those_of_the_residuals() -> None:
    _, campaign = drawn(1)
    problem = campaign[0].problem()
    rest = problem.values_at_rest
    jacobian = problem.jacobian(rest)
    sigma = 1.0 / np.linalg.norm(jacobian, axis=0)
    for k in np.random.default_rng(0).choice(rest.size, 12, replace=False):
        # From both sides: what is left is the third derivative.
        def along(share: Array, k: int = int(k)) -> Array:
            values = rest.copy()
            values[k] += float(share[0]) * 1e3 * sigma[k]
            return problem.residuals(values)

        ahead, back = along(np.array([1.0])), along(np.array([-1.0]))
        numeric = 0.5 * (ahead - back) / 1e3
        error = np.linalg.norm(numeric - jacobian[:, k] * sigma[k])
        assert error < 1e-5, problem.names[k]
