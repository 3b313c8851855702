"""Records of a load in time: means over the intervals of its rows, filters, peaks and the times
between them, trend, spectrum.

A record is an array of values at a constant interval dt [s]; where arrays have several axes, time
is the last one.
"""
import dataclasses
import math

import numpy as np
import scipy


def interval_means(time, mean):
    """Interval dt [s] and means c x k [N] of forces over k intervals, from the rows of a history
    that say its mean since time 0.

    time: n [s]; mean: n x c, the mean forces from 0 to each time. The impulse time x mean is exact,
    so the means are those of every step of the run, not of the rows alone. Rows come at the first
    step at or after a multiple of dt: between rows the impulse is taken as linear.
    """
    # the step may not divide dt, and the last row, at the end of the run, may come early
    dt = float((time[-2] - time[0]) / (len(time) - 2))
    count = int(math.floor((time[-1] - time[0]) / dt + 1e-3))
    edges = np.minimum(time[0] + dt * np.arange(count + 1), time[-1])
    impulse = time[:, None] * mean
    at_edges = np.stack([np.interp(edges, time, column) for column in impulse.T])
    return dt, np.diff(at_edges) / dt


def running_mean(values, length):
    """Means over every window of `length` values."""
    total = np.cumsum(np.asarray(values, float), axis=-1)
    total = np.concatenate([np.zeros_like(total[..., :1]), total], axis=-1)
    return (total[..., length:] - total[..., :-length]) / length


@dataclasses.dataclass(frozen=True)
class Filter:
    """What a record passes before its peaks are taken.

    kind: "none"; "mean": running mean over `length` [s]; "low-pass": Butterworth's of `order`, run
    forth and back, without a shift in time, through whose `frequency` [Hz] 1/sqrt(2) of an
    amplitude passes in all; "structure": what a spring feels that holds a mass, at rest at first,
    of natural `frequency` [Hz] and damping `ratio`, on which the load acts.
    """
    kind: str = "none"
    length: float = 0
    frequency: float = 0
    order: int = 2
    ratio: float = 0

    def __str__(self):
        return {"none": "none (means over the rows' interval)",
                "mean": f"running mean over {self.length:g} s",
                "low-pass": f"low-pass at {self.frequency:g} Hz (Butterworth of order {self.order},"
                            " forth and back)",
                "structure": f"structure of {self.frequency:g} Hz, {self.ratio:.3g} of critical "
                             "damping"}[self.kind]

    @staticmethod
    def parse(text):
        """Of none, mean:SECONDS, low-pass:HERTZ[:ORDER], structure:HERTZ:RATIO."""
        kind, *words = text.split(":")
        try:
            values = [float(word) for word in words]
            if kind == "none" and not values:
                found = Filter()
            elif kind == "mean":
                found = Filter(kind, length=values.pop(0))
            elif kind == "low-pass":
                found = Filter(kind, frequency=values[0],
                               order=int(values[1]) if len(values) > 1 else 2)
                values = values[2:]
            else:
                found = Filter({"structure": kind}[kind], frequency=values[0], ratio=values[1])
                values = values[2:]
            sizes = (found.length, found.frequency, found.ratio)
            if values and kind != "none" or not all(0 <= v < 1e9 for v in sizes):
                raise ValueError
            if kind != "none" and max(found.length, found.frequency) == 0:
                raise ValueError
            if not 1 <= found.order <= 8 or not found.ratio < 1:
                raise ValueError
        except (ValueError, LookupError):
            raise ValueError(f"filter '{text}' is none of none, mean:SECONDS, low-pass:HERTZ, "
                             "low-pass:HERTZ:ORDER (1 to 8), structure:HERTZ:RATIO (0 to 1)"
                             ) from None
        return found

    def apply(self, values, dt):
        """The filtered record. ValueError where the rows cannot tell it."""
        values = np.asarray(values, float)
        if self.kind == "none":
            return values
        if self.kind == "mean":
            length = max(1, round(self.length / dt))
            if length > values.shape[-1]:
                raise ValueError(f"the running mean of {self.length:g} s is longer than the record")
            return running_mean(values, length)
        # the rows' own mean over dt lets 0.935 of an amplitude through at this limit
        if self.frequency > 0.2 / dt * (1 + 1e-3):
            raise ValueError(f"a filter of {self.frequency:g} Hz needs rows of history.csv every "
                             f"{0.2 / self.frequency:.2g} s or more often (output: history), "
                             f"not every {dt:.3g} s")
        if self.kind == "low-pass":
            # Twice through: each may take 2^(-1/4). Winter, Biomechanics and Motor Control of
            # Human Movement, section 3.4.4.2, on the bilinear transform's axis of frequencies.
            widened = math.tan(math.pi * self.frequency * dt) / (math.sqrt(2) - 1)**(
                1 / (2 * self.order))
            sections = scipy.signal.butter(self.order, 2 * math.atan(widened) / math.pi,
                                           output="sos")
            return scipy.signal.sosfiltfilt(sections, values, axis=-1,
                                      padlen=min(values.shape[-1] - 1, int(3 / self.frequency / dt)
                                                 ))
        return spring_force(values, dt, self.frequency, self.ratio)


def spring_force(values, dt, frequency, ratio):
    """k u of m u'' + 2 zeta sqrt(k m) u' + k u = F from rest, F linear between its values: exact by
    the matrix exponential (scipy's first-order hold)."""
    w = 2 * math.pi * frequency
    system = scipy.signal.StateSpace([[0, 1], [-w * w, -2 * ratio * w]], [[0], [w * w]], [[1, 0]],
                                     [[0]])
    numerator, denominator = scipy.signal.ss2tf(*scipy.signal.cont2discrete(
        (system.A, system.B, system.C, system.D), dt, "foh")[:4])
    return scipy.signal.lfilter(numerator[0], denominator, values, axis=-1)


def block_maxima(values, dt, length, lost=0):
    """Largest value of each whole block of `length` [s]; of the whole record if it is shorter. The
    last block is whole if it lacks no more than 1 % of its length and the `lost` values by which a
    running mean is shorter than its record."""
    values = np.asarray(values)
    size = max(1, round(length / dt))
    count = max(1, math.floor((len(values) + lost) / size + 0.01))
    return np.array([values[k * size:(k + 1) * size].max() for k in range(count)])


def peaks(values, threshold, drop=0.5):
    """Indices of separate peaks of at least `threshold`: between two of them the record falls to
    `drop` times the smaller one or lower (Rayleigh's criterion of separation, as it is used of ice
    loads: Suominen & Kujala, 2010, with 0.5). A record that stays above is one event, with one
    peak."""
    found, top, low = [], 0, values[0]
    for k, value in enumerate(values):
        low = min(low, value)
        parted = low <= drop * values[top]
        if value > values[top] and not parted or parted and low <= drop * value and value > low:
            if parted:
                found.append(top)
            top, low = k, value
    found.append(top)
    return np.array([k for k in found if values[k] >= threshold and values[k] > 0], int)


def correlation_time(values, dt):
    """Integral of the autocorrelation up to its first zero [s]."""
    x = np.asarray(values, float) - np.mean(values)
    size = 1 << (2 * len(x) - 1).bit_length()
    power = np.abs(np.fft.rfft(x, size))**2
    rho = np.fft.irfft(power, size)[:len(x)]
    if rho[0] <= 0:
        return dt
    rho /= rho[0]
    zero = np.flatnonzero(rho <= 0)
    rho = rho[:zero[0] if len(zero) else len(rho)]
    return float(max(dt, (2 * rho.sum() - rho[0]) * dt / 2))


def trend(records, dt, least=4):
    """Mann and Kendall's test for a trend of the means of blocks, over all records at once.

    records: list of arrays, each from its own start-up on. Blocks are at least 4 correlation times
    long, so that their means count as independent, at most 20 per record. S, the number of pairs
    that rise less those that fall, has the variance n(n - 1)(2n + 5)/18 without a trend (Mann,
    Econometrica 13, 1945, 245; Kendall 1975); of several records both are summed (Hirsch, Slack &
    Smith, Water Resources Research 18, 1982, 107). One record: exact p (scipy's kendalltau).

    Returns {"blocks", "block" [s], "slope" [1/s, Theil and Sen's of all block means, over their
    mean], "p"}; None if records have fewer than `least` blocks, or do not vary.
    """
    length = min(map(len, records))
    spread = np.concatenate(records)
    if np.ptp(spread) == 0:
        return None
    # of what is left without a straight line, since a trend would count as correlation
    scale = float(np.mean([correlation_time(scipy.signal.detrend(record), dt)
                           for record in records]))
    size = max(round(4 * scale / dt), math.ceil(length / 20), 1)
    count = length // size
    if count < least:
        return None
    means = np.array([record[:count * size].reshape(count, size).mean(axis=1)
                      for record in records])
    i, j = np.triu_indices(count, 1)
    rises = means[:, j] - means[:, i]
    slope = float(np.median(rises / ((j - i) * size * dt)))
    if len(records) == 1:
        p = float(scipy.stats.kendalltau(np.arange(count), means[0]).pvalue)
    else:
        s, variance = np.sign(rises).sum(), len(records) * count * (count - 1) * (2 * count + 5)
        p = float(2 * scipy.stats.norm.sf(max(abs(s) - 1, 0) / math.sqrt(variance / 18)))
    return {"blocks": count, "block": size * dt,
            "slope": slope / abs(means.mean()) if means.mean() else math.nan, "p": min(1.0, p)}


def spectrum(records, dt, segment=None):
    """Frequencies [Hz] and one-sided density [N^2/Hz], Welch's with Hann windows that overlap by
    half, mean over the records; segment: length of the windows [s] (default: a quarter of the
    shortest record). The integral is the variance about the windows' means."""
    length = min(map(len, records))
    size = min(length, max(8, round(segment / dt) if segment else length // 4))
    each = [scipy.signal.welch(record, 1 / dt, nperseg=size) for record in records]
    return each[0][0], np.mean([density for _, density in each], axis=0)
