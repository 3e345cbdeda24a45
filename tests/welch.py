"""Tests of stochastic pictures: Welch's in each pixel, with Sidak's correction, and Kolmogorov's of all p-values.

So do Mitsuba's own render tests compare. Welch, The generalization of "Student's" problem when several different
population variances are involved, Biometrika 34, 1947; Sidak, Rectangular confidence regions for the means of
multivariate normal distributions, Journal of the American Statistical Association 62, 1967; Stephens, EDF statistics
for goodness of fit, in the same 69, 1974.
"""

from math import exp, lgamma, sqrt

import numpy as np


def incomplete_beta(a, b, x):
    """The regularised incomplete beta function of arrays, by its continued fraction: DLMF 8.17.22."""
    # The fraction converges fast below this; above it, the function's mirror image is taken.
    if (x > (a + 1) / (a + b + 2)).any():
        high = x > (a + 1) / (a + b + 2)
        first, second, at = np.where(high, b, a), np.where(high, a, b), np.where(high, 1 - x, x)
        found = incomplete_beta(first, second, at)
        return np.where(high, 1 - found, found)
    fraction = np.ones_like(x)
    for m in range(60, -1, -1):
        even, odd = a + 2 * m, a + 2 * m + 1
        fraction = 1 - (a + m) * (a + b + m) / (even * odd) * x / fraction
        if m > 0:
            fraction = 1 + m * (b - m) / ((even - 1) * even) * x / fraction
    logarithm = np.vectorize(lgamma, otypes=[float])
    front = logarithm(a + b) - logarithm(a) - logarithm(b) - np.log(a)
    with np.errstate(divide="ignore"):
        return np.exp(front + a * np.log(x) + b * np.log1p(-x)) / fraction


def student_tails(t, freedom):
    """How probable a Student's t of so many degrees of freedom is that is as far from 0, on either side; arrays."""
    return incomplete_beta(freedom / 2, np.full_like(freedom, 0.5), freedom / (freedom + t * t))


def welch(first, second):
    """p-values of the hypothesis that two sets of pictures, (n, pixels) each, have the same mean in each pixel.

    Pixels in which a set does not vary are left out.
    """
    a, b = (pictures.var(axis=0, ddof=1) / len(pictures) for pictures in (first, second))
    varies = (a > 0) & (b > 0)
    a, b = a[varies], b[varies]
    t = (first.mean(axis=0) - second.mean(axis=0))[varies] / np.sqrt(a + b)
    return student_tails(t, (a + b) ** 2 / (a**2 / (len(first) - 1) + b**2 / (len(second) - 1)))


def sidak(level, count):
    """What the least of `count` independent p-values falls below with the probability `level`."""
    return 1 - (1 - level) ** (1 / count)


def uniform(p):
    """The p-value of numbers being independent and uniform in 0..1: Kolmogorov's test, as Stephens has it."""
    n, p = len(p), np.sort(p)
    farthest = max((np.arange(1, n + 1) / n - p).max(), (p - np.arange(n) / n).max())
    scaled = (sqrt(n) + 0.12 + 0.11 / sqrt(n)) * farthest
    return min(1.0, max(0.0, 2 * sum((-1) ** (k - 1) * exp(-2 * (k * scaled) ** 2) for k in range(1, 101))))
