"""Figures of floe loads, from what statements.state and fields.state say."""
import matplotlib.pyplot as plt
import numpy as np

from floe.loads import extremes, statements

INK, WARM, PALE = "#22577a", "#c1440e", "#a9bcc8"


def unit_of(largest):
    """Size and name of a unit of force that suits numbers up to `largest` [N]."""
    return next(((size, name) for size, name in ((1e6, "MN"), (1e3, "kN")) if largest >= 2 * size),
                (1, "N"))


def panels(number, width):
    figure, axes = plt.subplots(1, number, figsize=(width, 3.6), layout="constrained")
    for each in axes:
        each.spines[["top", "right"]].set_visible(False)
    return figure, axes


def draw_record(axes, run, found, settings, size, unit):
    """One run's record, raw and filtered, with its largest value."""
    raw, filtered = (each[0] for each in statements.records([run], found["obstacle"], settings))
    dt = found["interval"]
    late = (len(raw) - len(filtered)) * dt / 2  # a running mean belongs to the middle of its window
    time = found["start"] + dt * (np.arange(len(raw)) + 0.5)
    axes.plot(time, raw / size, color=PALE, linewidth=0.7, label=f"over {dt:.2g} s")
    smooth = time[:len(filtered)] + late
    axes.plot(smooth, filtered / size, color=INK, linewidth=1.2, label="filtered")
    top = np.argmax(filtered)
    axes.plot(smooth[top], filtered[top] / size, "o", color=WARM, markersize=5)
    axes.set(xlabel="time [s]", ylabel=f"{found['component']} force [{unit}]",
             ylim=(min(0, filtered.min() / size), 1.3 * raw.max() / size))
    axes.set_title(f"{found['obstacle']}, {run.name}", loc="left", fontsize=10)
    axes.legend(frameon=False, fontsize=8, ncols=2, loc="upper left")


def draw_exceedance(axes, found, settings, size, unit):
    """Maxima at their plotting positions, Gumbel's law by both methods, the band of the first."""
    maxima, law = np.sort(found["maxima"]), found["gumbel"]
    axes.semilogy(maxima / size, found["positions"], "o", color=WARM, markersize=4,
                  label="maxima")
    axes.set(xlabel=f"force [{unit}]", ylabel=f"exceeded in {found['block']:.3g} s")
    if law is not None:
        smallest = min(0.5 / len(maxima), *(row["probability"] for row in law["levels"]))
        p = np.geomspace(0.99, smallest, 60)
        for method, line in zip(extremes.METHODS, ("-", "--")):
            mu, beta = law[method]["mu"], law[method]["beta"]
            axes.semilogy(extremes.quantile(mu, beta, p) / size, p, line, color=INK, linewidth=1.2,
                          label={"moments": "L-moments"}.get(method, method))
        low, high = np.array([extremes.band(
            law["moments"]["mu"], law["moments"]["beta"], len(maxima), q, "moments",
            settings.level, settings.draws, settings.seed) for q in p]).T
        axes.fill_betweenx(p, low / size, high / size, color=INK, alpha=0.12, linewidth=0,
                           label="95 % band")
        axes.set_title(f"Gumbel, p = {law['p']:.2f}" + (", weak" if law["weak"] else ""),
                       loc="left", fontsize=10)
    axes.legend(frameon=False, fontsize=8)


def load(found, runs, settings):
    """Record of the first run, exceedance, spectrum, spacing of peaks."""
    size, unit = unit_of(max(found["maxima"]))
    figure, (record, exceedance, spectrum, spacing) = panels(4, 15)
    draw_record(record, runs[0], found, settings, size, unit)
    draw_exceedance(exceedance, found, settings, size, unit)
    f, s = (np.array(found["spectrum"][key]) for key in ("frequency", "density"))
    spectrum.loglog(f[1:], s[1:] / size**2, color=INK, linewidth=1)
    spectrum.set(xlabel="frequency [Hz]", ylabel=f"density [{unit}²/Hz]")
    spectrum.set_title("Spectrum, unfiltered", loc="left", fontsize=10)
    gaps = found["peaks"]["spacings"]
    if gaps:
        spacing.hist(gaps, bins=min(20, max(5, len(gaps) // 4)), color=INK, alpha=0.8)
        spacing.axvline(found["peaks"]["mean_spacing"], color=WARM, linewidth=1.2)
    spacing.set(xlabel="time between peaks [s]", ylabel="number")
    spacing.set_title(f"{len(gaps)} spacings, mean in red", loc="left", fontsize=10)
    return figure


def draw_profile(axes, profile):
    distance = np.array(profile["distance"])
    top, bottom = np.array(profile["top"]), np.array(profile["bottom"])
    axes.axhline(0, color="#5aa0c8", linewidth=0.8)
    axes.fill_between(distance, bottom, top, color=PALE, alpha=0.6, linewidth=0, label="mean")
    axes.plot(distance, profile["highest"], ".", color=WARM, markersize=4, label="extreme")
    axes.plot(distance, profile["deepest"], ".", color=WARM, markersize=4)
    porosity = axes.twinx()
    porosity.plot(distance, profile["porosity"], color=INK, linewidth=1, linestyle="--")
    porosity.set(ylim=(0, 1), ylabel="porosity (dashed)")
    porosity.spines[["top"]].set_visible(False)
    axes.set(xlabel="distance from the waterline [m]", ylabel="z [m]")
    axes.legend(frameon=False, fontsize=8, loc="lower right")


def ice(found):
    """Pressure against area, the pile's profile, sizes of fragments."""
    figure, (pressure, profile, pieces) = panels(3, 13)
    pairs = found["pressure_area"]
    area, law = np.array(pairs["area"]), pairs["law"]
    pressure.loglog(area, np.array(pairs["pressure"]) / 1e6, ".", color=INK, markersize=3)
    if law:
        ends = np.array([area.min(), area.max()])
        pressure.loglog(ends, law["c"] * ends**-law["m"] / 1e6, color=WARM, linewidth=1.2)
        pressure.set_title(f"{law['c'] / 1e6:.3g} MPa (A/m²)$^{{{-law['m']:.2f}}}$", loc="left",
                           fontsize=10)
    pressure.set(xlabel="area of contact [m²]", ylabel="mean pressure [MPa]")
    if found["profile"]:
        draw_profile(profile, found["profile"])
    profile.set_title("Ice where it comes from, at the end", loc="left", fontsize=10)
    if found["fragments"]:
        size = np.array(found["fragments"]["sizes"])
        pieces.plot(size, np.arange(1, len(size) + 1) / len(size), color=INK, label="by number")
        pieces.plot(size, np.cumsum(size**2) / np.sum(size**2), "--", color=WARM, label="by mass")
        pieces.set(xscale="log", xlabel="diameter [m]", ylabel="share below", ylim=(0, 1))
        pieces.set_title(f"{len(size)} fragments without the sheet", loc="left", fontsize=10)
        pieces.legend(frameon=False, fontsize=8)
    return figure
