"""Laws of floe sizes and thicknesses: drawn from a generator, and fitted to what was drawn.

A floe's size is its mean calliper diameter d [m], its width averaged over all directions: the
perimeter of its convex hull over pi (Cauchy's formula); as of Rothrock & Thorndike (1984), J.
Geophys. Res. 89(C4), 6477-6486. Denton & Timmermans (2022), The Cryosphere 16, 1563-1578, found
densities of floe areas that fall with exponents of 1.65 to 2.03: the number of floes with a
diameter above d falls as d^-a, a = 1.3 to 2.1.
"""
import argparse
from dataclasses import dataclass

import numpy as np
import scipy


def power_exponent(sizes, least, largest):
    """Exponent a of the number above d, ~ d^-a between least and largest, by maximum likelihood,
    and its standard error: Clauset, Shalizi & Newman (2009), SIAM Review 51, 661-703, appendix B,
    with a law that ends at `largest` as well. None without 10 sizes between the bounds.

    The likelihood's derivative is zero where 1/a - L / (exp(a L) - 1) = mean ln(d / least),
    L = ln(largest / least); without an end 1/a = mean ln(d / least), their (3.1).
    """
    sizes = sizes[(sizes >= least) & (sizes <= largest)]
    if len(sizes) < 10:
        return None
    span, mean = np.log(largest / least), np.mean(np.log(sizes / least))

    def slope(a):
        return 1 / a - span / np.expm1(a * span) - mean
    low, high = 1e-3, 50.0
    with np.errstate(over="ignore"):  # of wide laws: over infinity is the 0 that it should be
        if slope(low) <= 0 or slope(high) >= 0:
            return None
        a = scipy.optimize.brentq(slope, low, high)
        information = 1 / a**2 - (span / (2 * np.sinh(a * span / 2)))**2
    return a, 1 / np.sqrt(len(sizes) * information)


@dataclass
class Power:
    """Number of floes above d ~ d^-exponent, between least and largest [m]."""
    least: float
    largest: float
    exponent: float

    def draw(self, random, count):
        a = self.exponent
        ends = self.least**-a, self.largest**-a
        return (ends[0] - random.random(count) * (ends[0] - ends[1]))**(-1 / a)

    def mean_square(self):
        a, span = self.exponent, np.log(self.largest / self.least)
        ratio = span if abs(a - 2) < 1e-9 else np.expm1((2 - a) * span) / (2 - a)
        return self.least**2 * a * ratio / -np.expm1(-a * span)

    def found(self, sizes, factor):
        """What the sizes say of this law, its bounds `factor` times as large; one line."""
        fit = power_exponent(sizes, self.least * factor, self.largest * factor)
        asked = f"asked: {self.exponent:g}"
        if fit is None:
            return f"exponent of the number above d: too few floes ({asked})"
        return (f"exponent of the number above d: {fit[0]:.3f} +- {fit[1]:.3f} by maximum "
                f"likelihood ({asked})")


@dataclass
class Lognormal:
    """ln d is normal about ln median, with this deviation; cut 3 deviations from the median."""
    median: float
    deviation: float

    def draw(self, random, count):
        normal = random.standard_normal(count)
        while np.any(far := np.abs(normal) > 3):
            normal[far] = random.standard_normal(np.count_nonzero(far))
        return self.median * np.exp(self.deviation * normal)

    def mean_square(self):
        return self.median**2 * np.exp(2 * self.deviation**2)

    @property
    def largest(self):
        return self.median * np.exp(3 * self.deviation)

    def found(self, sizes, factor):
        logarithms = np.log(sizes)
        return (f"median {np.exp(logarithms.mean()):.4g} m, deviation of ln d "
                f"{logarithms.std():.3f} by maximum likelihood "
                f"(asked: {self.median:g} m, {self.deviation:g})")


@dataclass
class One:
    """All of one size."""
    value: float

    def draw(self, random, count):
        return np.full(count, self.value)

    def mean_square(self):
        return self.value**2

    @property
    def largest(self):
        return self.value

    def found(self, sizes, factor):
        return (f"deviation of the diameters {sizes.std() / sizes.mean():.4f} of their mean "
                f"(asked: all {self.value:g} m)")


@dataclass
class Uniform:
    """Evenly between two values."""
    low: float
    high: float

    def draw(self, random, count):
        return self.low + (self.high - self.low) * random.random(count)


def parameters(text, name, least, most):
    """The numbers of NAME:NUMBER:..., each above 0; argparse's error if they are others."""
    words = text.split(":")[1:]
    try:
        values = [float(word) for word in words]
    except ValueError:
        values = None
    if values is None or not least <= len(values) <= most or not all(0 < v < 1e9 for v in values):
        raise argparse.ArgumentTypeError(
            f"'{text}': {name} takes {least}{'' if least == most else f' to {most}'} "
            "numbers above 0, separated by colons")
    return values


def one(text):
    return One(*parameters(f"one:{text}", "a constant", 1, 1))


def ordered(text, low, high):
    if not low < high:
        raise argparse.ArgumentTypeError(f"'{text}': {low:g} is not below {high:g}")


def size_law(text):
    """argparse's type of --sizes."""
    kind = text.split(":")[0]
    if kind == "power":
        law = Power(*parameters(text, "power:LEAST:LARGEST:EXPONENT", 3, 3))
        ordered(text, law.least, law.largest)
        if not 0.1 <= law.exponent <= 10:
            raise argparse.ArgumentTypeError(f"'{text}': the exponent is not within 0.1 to 10")
        return law
    if kind == "lognormal":
        return lognormal(text)
    if kind == "one":
        return One(*parameters(text, "one:DIAMETER", 1, 1))
    raise argparse.ArgumentTypeError(f"'{text}' is none of power:LEAST:LARGEST:EXPONENT, "
                                     "lognormal:MEDIAN:DEVIATION, one:DIAMETER")


def lognormal(text):
    law = Lognormal(*parameters(text, "lognormal:MEDIAN:DEVIATION", 2, 2))
    if law.deviation > 2:
        raise argparse.ArgumentTypeError(f"'{text}': the deviation of the logarithm is above 2")
    return law


def thickness_law(text):
    """argparse's type of --thickness."""
    kind = text.split(":")[0]
    if kind == "uniform":
        law = Uniform(*parameters(text, "uniform:LOW:HIGH", 2, 2))
        ordered(text, law.low, law.high)
        return law
    if kind == "lognormal":
        return lognormal(text)
    try:
        return one(text)
    except argparse.ArgumentTypeError:
        raise argparse.ArgumentTypeError(f"'{text}' is none of METRES, uniform:LOW:HIGH, "
                                         "lognormal:MEDIAN:DEVIATION") from None
