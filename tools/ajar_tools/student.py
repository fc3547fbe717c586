"""Tail probabilities of Student's t and Fisher's F through the incomplete beta function, vectorised.

Abramowitz & Stegun 26.7.1 and 26.6.2 name the relations; the continued fraction is DLMF 8.17.22, evaluated by the
method of Lentz (Press et al., Numerical Recipes, §6.4).
"""

from __future__ import annotations

import math

import numpy as np

TINY = 1e-300
STEPS = 300


def two_sided_t(t: np.ndarray, freedom: np.ndarray) -> np.ndarray:
    """Probability that |T| exceeds |t| for T with `freedom` degrees of freedom."""
    t, freedom = np.broadcast_arrays(np.abs(np.asarray(t, np.float64)), np.asarray(freedom, np.float64))
    # Far tails lose the digits of 1 - x, so x is made from the small side.
    return incomplete_beta(freedom / 2, np.full_like(freedom, 0.5), freedom / (freedom + t * t))


def critical_t(probability: float, freedom: np.ndarray) -> np.ndarray:
    """The |t| that |T| exceeds with this probability: `two_sided_t` inverted, by halving the interval of logarithms."""
    low, high = np.full(freedom.shape, -7.0), np.full(freedom.shape, 120.0)
    for _ in range(60):
        middle = (low + high) / 2
        beyond = two_sided_t(np.exp(middle), freedom) > probability
        low, high = np.where(beyond, middle, low), np.where(beyond, high, middle)
    return np.asarray(np.exp(high))


def upper_f(ratio: float, above: float, below: float) -> float:
    """Probability that F with (`above`, `below`) degrees of freedom exceeds `ratio`."""
    if ratio <= 0:
        return 1.0
    if math.isinf(ratio):
        return 0.0
    x = below / (below + above * ratio)
    return float(incomplete_beta(np.array([below / 2]), np.array([above / 2]), np.array([x]))[0])


def incomplete_beta(a: np.ndarray, b: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The regularised incomplete beta function I_x(a, b)."""
    # The fraction converges quickly below the mean of the distribution; beyond it, I_x(a, b) = 1 - I_{1-x}(b, a).
    swap = x > (a + 1) / (a + b + 2)
    a1, b1, x1 = np.where(swap, b, a), np.where(swap, a, b), np.where(swap, 1 - x, x)
    inside = np.clip(x1, TINY, 1.0)
    front = a1 * np.log(inside) + b1 * np.log1p(-np.minimum(inside, 1 - 1e-16)) - log_beta(a1, b1)
    value = np.where(x1 <= 0, 0.0, np.exp(front) * continued_fraction(a1, b1, x1) / a1)
    return np.where(swap, 1 - value, value)


def log_beta(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The logarithm of the beta function."""

    def gamma(x: np.ndarray) -> np.ndarray:
        return np.array([math.lgamma(value) for value in x])

    return gamma(a) + gamma(b) - gamma(a + b)


def continued_fraction(a: np.ndarray, b: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The fraction of DLMF 8.17.22, by Lentz's method."""

    def away_from_zero(value: np.ndarray) -> np.ndarray:
        return np.where(np.abs(value) < TINY, TINY, value)

    c = np.ones_like(x)
    d = 1 / away_from_zero(1 - (a + b) * x / (a + 1))
    value = d
    for m in range(1, STEPS):
        even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        for numerator in (even, odd):
            d = 1 / away_from_zero(1 + numerator * d)
            c = away_from_zero(1 + numerator / c)
            value = value * c * d
        if np.all(np.abs(c * d - 1) < 1e-13):
            break
    return value
