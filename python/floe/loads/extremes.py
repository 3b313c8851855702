"""Statistics of maxima: Gumbel's law (type I) by L-moments and by maximum likelihood, bands of its
quantiles, a test of its fit, plotting positions.

F(x) = exp(-exp(-(x - mu)/beta)). Both estimators are equivariant: maxima times b plus a give mu
times b plus a and beta times b. So the laws of (estimate - truth)/(estimate of beta) and of the
Anderson-Darling statistic depend on the number of maxima only, not on mu and beta (Thoman, Bain &
Antle, Technometrics 11, 1969, 445; Lawless, Statistical Models and Methods for Lifetime Data, 1982,
section 4.1). They are simulated once, from seeded draws of the standard law, and bands are exact
but for the number of draws, at any number of maxima.
"""
import functools

import numpy as np

EULER = 0.5772156649015329
METHODS = ("moments", "likelihood")
DRAWS, SEED = 10000, 20260101
LARGEST = 20_000_000  # numbers drawn at once: fewer draws of so many maxima, which scatter less


def l_moments(samples):
    """First four L-moments of the samples along the last axis: l1, l2, t3 = l3/l2, t4 = l4/l2.
    Unbiased, from probability-weighted moments (Hosking, J. R. Stat. Soc. B 52, 1990, 105,
    section 3); needs 4 numbers for all of them, 2 for l1 and l2 (the rest is then nan)."""
    x = np.sort(np.asarray(samples, float), axis=-1)
    n, i = x.shape[-1], np.arange(x.shape[-1])
    weight, b = np.ones(n), []
    for r in range(4):
        b.append((x * weight).mean(axis=-1) if n > r else np.full(x.shape[:-1], np.nan))
        if n > r + 1:
            weight = weight * (i - r) / (n - 1 - r)
    l2 = 2 * b[1] - b[0]
    with np.errstate(invalid="ignore", divide="ignore"):
        return (b[0], l2, (6 * b[2] - 6 * b[1] + b[0]) / l2,
                (20 * b[3] - 30 * b[2] + 12 * b[1] - b[0]) / l2)


def fit_moments(samples):
    """mu and beta by L-moments: beta = l2/ln 2, mu = l1 - 0.5772 beta (Hosking 1990, table 2)."""
    l1, l2, _, _ = l_moments(samples)
    beta = l2 / np.log(2)
    return l1 - EULER * beta, beta


def fit_likelihood(samples):
    """mu and beta of the largest likelihood, of all samples along the last axis at once.

    beta = mean(x) - sum(x w)/sum(w), w = exp(-x/beta), and mu = -beta ln mean(w) (Johnson, Kotz &
    Balakrishnan, Continuous Univariate Distributions 2, 1995, section 22.9.6). The difference of
    both sides rises with beta (slope 1 + var_w(x)/beta^2), so Newton's method finds the only root.
    """
    x = np.asarray(samples, float)
    low = x.min(axis=-1, keepdims=True)
    x = x - low  # exp(-x/beta) then neither overflows nor vanishes for all x
    mean = x.mean(axis=-1, keepdims=True)
    beta = fit_moments(x)[1][..., None]
    for _ in range(100):
        w = np.exp(-x / beta)
        w /= w.sum(axis=-1, keepdims=True)
        weighted = (x * w).sum(axis=-1, keepdims=True)
        variance = ((x - weighted)**2 * w).sum(axis=-1, keepdims=True)
        step = (beta - mean + weighted) / (1 + variance / beta**2)
        new = np.where(step < beta, beta - step, beta / 2)
        done = np.all(np.abs(new - beta) <= 1e-13 * beta)
        beta = new
        if done:
            break
    mu = low - beta * np.log(np.exp(-x / beta).mean(axis=-1, keepdims=True))
    return mu[..., 0], beta[..., 0]


def fit(samples, method):
    """mu and beta by one of METHODS. Samples: maxima along the last axis, at least 2, not all
    alike."""
    x = np.asarray(samples, float)
    if x.shape[-1] < 2:
        raise ValueError("Gumbel's law needs at least 2 maxima")
    if np.any(x.max(axis=-1) <= x.min(axis=-1)):
        raise ValueError("Gumbel's law needs maxima that are not all alike")
    return {"moments": fit_moments, "likelihood": fit_likelihood}[method](x)


def reduced(probability):
    """Gumbel's reduced variate y of the value that is exceeded with this probability: -ln(-ln(1 -
    probability))."""
    return -np.log(-np.log1p(-np.asarray(probability, float)))


def quantile(mu, beta, probability):
    """The value that one maximum exceeds with this probability."""
    return mu + beta * reduced(probability)


def _samples(number, draws, seed):
    """`draws` x `number` numbers of the standard law; of very many numbers fewer draws, but
    1,000."""
    draws = max(min(draws, LARGEST // number), min(draws, 1000))
    return np.random.default_rng([seed, number]).gumbel(size=(draws, number))


@functools.lru_cache(maxsize=64)
def _standard(number, method, draws, seed):
    """mu and beta of `draws` samples of this many maxima of the standard law (mu 0, beta 1)."""
    found = fit(_samples(number, draws, seed), method)
    for values in found:
        values.setflags(write=False)
    return found


def pivot(number, probability, method, level=0.95, draws=DRAWS, seed=SEED):
    """Ends, low and high, between which (estimate - truth)/(estimate of beta) lies with probability
    `level`, of the value exceeded with `probability`; by parametric bootstrap."""
    mu, beta = _standard(number, method, draws, seed)
    y = reduced(probability)
    tail = (1 - level) / 2
    return np.quantile((mu + beta * y - y) / beta, [tail, 1 - tail])


def band(mu, beta, number, probability, method, level=0.95, draws=DRAWS, seed=SEED):
    """Confidence band (low, high) of the value exceeded with `probability`, from a fit to `number`
    maxima. mu, beta: numbers or arrays."""
    low, high = pivot(number, probability, method, level, draws, seed)
    estimate = quantile(mu, beta, probability)
    return estimate - high * beta, estimate - low * beta


def anderson_darling(samples, mu, beta):
    """Anderson and Darling's A^2 of samples along the last axis against Gumbel's law: -n - sum
    (2i - 1)/n (ln F_i + ln(1 - F_{n+1-i})) (Stephens, Biometrika 64, 1977, 583)."""
    x = np.sort(np.asarray(samples, float), axis=-1)
    n = x.shape[-1]
    below = -np.exp(-(x - np.asarray(mu)[..., None]) / np.asarray(beta)[..., None])  # ln F
    above = np.log(-np.expm1(np.minimum(below, -1e-300)))
    return -n - (((2 * np.arange(n) + 1) / n) * (below + above[..., ::-1])).sum(axis=-1)


@functools.lru_cache(maxsize=16)
def _standard_distances(number, draws, seed):
    """A^2 of samples of Gumbel's law, each against the law fitted to it by likelihood; sorted."""
    return np.sort(anderson_darling(_samples(number, draws, seed),
                                    *_standard(number, "likelihood", draws, seed)))


def goodness(samples, draws=DRAWS, seed=SEED):
    """A^2 of the maxima against Gumbel's law of the largest likelihood, and its p value: the share
    of samples of that law, each fitted anew, that are as far from their fits."""
    samples = np.asarray(samples, float)
    distance = float(anderson_darling(samples, *fit(samples, "likelihood")))
    known = _standard_distances(len(samples), draws, seed)
    # two maxima have the same distance whatever they are: to rounding, they are as far
    farther = len(known) - np.searchsorted(known, distance * (1 - 1e-6))
    return distance, float((farther + 1) / (len(known) + 1))


def positions(number):
    """Probabilities of exceedance at which sorted maxima (smallest first) are drawn: 1 - (i -
    0.44)/(n + 0.12) (Gringorten, J. Geophys. Res. 68, 1963, 813)."""
    return 1 - (np.arange(1, number + 1) - 0.44) / (number + 0.12)
