#!/usr/bin/python3
"""Counterparts of the paper's figures, from the results of a campaign (tools/campaign_report)."""
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

from campaign_cases import FACTORS, LENGTHS, SHEETS, THICKNESSES
from floe_output import Lattice
from floe_plate import wyman

YOUNG, POISSON, DENSITY, GRAVITY = 4e9, 0.3, 1010, 9.81  # of the paper's scenes
COLOURS = {0.5: "#1f6f8b", 1: "#d1802f", 1.5: "#6b4e9b"}  # by thickness
MARKERS = {2: "o", 3: "s"}                                 # by l/h


def characteristic_length(thickness):
    """l_c = (D/k)^(1/4) (docs/model.md section 5) [m]."""
    return (YOUNG * thickness**3 / (12 * (1 - POISSON**2)) / (DENSITY * GRAVITY))**0.25


def axes_of(width=6.8, height=4.4, columns=1, rows=1, **more):
    figure, axes = plt.subplots(rows, columns, figsize=(width, height), layout="constrained", squeeze=False, **more)
    for ax in axes.flat:
        ax.spines[["top", "right"]].set_visible(False)
    return figure, axes


def cells(axes, campaign, sheet, window=None):
    """Draws a sheet's cells, those in the window if one is given (half its side) [m]. False if its lattice was not kept."""
    path = campaign.folder / "lattices" / f"tension_{sheet.name}_01.h5"
    if not path.exists():
        return False
    plans = Lattice(path).plans()
    if window:
        plans = [plan for plan in plans if np.all(np.abs(plan) <= window, axis=1).any()]
    tiles = PolyCollection(plans, facecolors="#e8f0f4", edgecolors="#4a6a7a", linewidths=0.6 if len(plans) < 3000 else 0.1)
    tiles.set_rasterized(len(plans) > 3000)
    axes.add_collection(tiles)
    half = window or 0.52 * sheet.length
    axes.set(aspect="equal", xlim=(-half, half), ylim=(-half, half), xticks=[], yticks=[])
    axes.spines[:].set_visible(False)
    return True


def figure_2(all_of):
    """The sheets of 10 m with l = 2h."""
    sheets = [s for s in SHEETS if s.length == 10 and s.factor == 2]
    figure, axes = axes_of(7.2, 2.7, columns=3)
    drawn = [cells(ax, all_of[0], sheet) for ax, sheet in zip(axes[0], sheets)]
    for ax, sheet in zip(axes[0], sheets):
        ax.set_title(f"h = {sheet.thickness:g} m, l = {sheet.element_size:g} m", fontsize="medium")
    return figure if all(drawn) else None


def figure_3(all_of):
    """Size range, to scale, and sections of the largest sheet's two meshes."""
    chosen = [next(s for s in SHEETS if (s.length, s.thickness, s.factor) == (length, 0.5, 2)) for length in LENGTHS]
    figure, axes = plt.subplots(1, 7, figsize=(9, 2.6), layout="constrained", width_ratios=[1, 1.2, 1.6, 2.4, 4.4, 2.4, 2.4])
    drawn = []
    for ax, sheet in zip(axes, chosen):
        drawn.append(cells(ax, all_of[0], sheet))
        ax.set_title(f"L = {sheet.length:g} m", fontsize="small")
    for ax, factor in zip(axes[5:], FACTORS):
        drawn.append(cells(ax, all_of[0], next(s for s in SHEETS if (s.length, s.thickness, s.factor) == (160, 0.5, factor)), 10))
        ax.set_title(f"20 m × 20 m, l = {factor}h", fontsize="small")
    return figure if all(drawn) else None


def figure_5(all_of):
    """E of every sheet, in the paper's order: by L, then h, then l."""
    figure, axes = axes_of(8.6, 4)
    ax = axes[0, 0]
    position, ticks = 0, []
    for length in LENGTHS:
        start = position
        for thickness in THICKNESSES:
            for factor in FACTORS:
                sheet = next(s for s in SHEETS if (s.length, s.thickness, s.factor) == (length, thickness, factor))
                values = all_of[0].values("tension", sheet, "E") / 1e9
                if len(values):
                    ax.bar(position, values.mean(), 0.85, yerr=values.std(ddof=1) if len(values) > 1 else None, capsize=2,
                           color=COLOURS[thickness], alpha=1 if factor == 2 else 0.55,
                           label=f"h = {thickness:g} m, l = {factor}h" if length == LENGTHS[0] else None)
                position += 1
        ticks.append((start + position - 1) / 2)
        position += 1
    ax.axhline(YOUNG / 1e9, color="black", linewidth=1, label="$E_b$ of the beams")
    ax.axhline(0.79536 * YOUNG / 1e9, color="#c0392b", linewidth=1, label="$E^*$ of the infinite lattice")
    ax.set_xticks(ticks, [f"{length}" for length in LENGTHS])
    ax.set(xlabel="sheet size L [m]", ylabel="effective Young's modulus E [GPa]")
    ax.legend(frameon=False, fontsize="small", ncols=2)
    return figure


def figure_6(all_of):
    """E/E* and E/Eb against L/l."""
    figure, axes = axes_of()
    ax = axes[0, 0]
    for column, marker, name in (("E_over_Estar", "s", "$E/E^*$"), ("E_over_Eb", "o", "$E/E_b$")):
        for number, campaign in enumerate(all_of):
            points = [(s.length / s.element_size, v) for s in SHEETS if len(v := campaign.values("tension", s, column))]
            if not points:
                continue
            ratio, values = zip(*sorted(points, key=lambda p: p[0]))
            colour = ["#1f6f8b", "#d1802f", "#6b4e9b", "#3a8a4d", "#b23a5f"][number % 5]
            ax.errorbar(ratio, [v.mean() for v in values], yerr=[v.std(ddof=1) if len(v) > 1 else 0 for v in values], fmt=marker,
                        markersize=4, capsize=2, linewidth=0.8, color=colour, markerfacecolor=colour if column == "E_over_Eb" else "none",
                        label=name + (f", {campaign.label}" if campaign.label else ""))
    for level in (1, 0.79536):
        ax.axhline(level, color="#8a949e", linewidth=0.8, zorder=-1)
    ax.axvline(25, color="#8a949e", linewidth=0.8, linestyle=":", zorder=-1)
    ax.set_xscale("log")
    ax.set_xticks([2, 5, 10, 25, 50, 100, 160], ["2", "5", "10", "25", "50", "100", "160"])
    ax.minorticks_off()
    ax.set(xlabel="relative sheet size $L/l$", ylabel="ratio")
    ax.legend(frameon=False, fontsize="small")
    return figure


def mean_profile(campaign, sheet, column, edges):
    """Mean and deviation over the meshes of w/w0, sorted by column 0 (r/l_c) or 2 (y over the half-width) into bins."""
    points = campaign.profiles_of(sheet)
    if not points:
        return None
    centre = (edges[:-1] + edges[1:]) / 2
    values = np.array([np.interp(centre, p[:, column], p[:, 1]) for p in points])
    return centre, values.mean(axis=0), values.std(axis=0, ddof=1) if len(points) > 1 else 0 * centre, [p[0, 1] for p in points]


def profiles_by_width(all_of, lengths, height):
    figure, axes = axes_of(8.6, height, columns=2, sharey=True)
    styles = dict(zip(LENGTHS, [":", (0, (4, 2, 1, 2)), "--", "-.", "-"]))
    for ax, factor in zip(axes[0], FACTORS):
        for sheet in SHEETS:
            if sheet.factor != factor or sheet.length not in lengths:
                continue
            found = mean_profile(all_of[0], sheet, 2, np.linspace(0, 1, 25))
            if found is None:
                continue
            y, mean, deviation, peak = found
            y, mean, deviation = np.r_[0, y], np.r_[np.mean(peak), mean], np.r_[np.std(peak), deviation]
            ax.plot(y, mean, color=COLOURS[sheet.thickness], linestyle=styles[sheet.length], linewidth=1.2,
                    label=f"L = {sheet.length:g} m, h = {sheet.thickness:g} m")
            ax.fill_between(y, mean - deviation, mean + deviation, color=COLOURS[sheet.thickness], alpha=0.15, linewidth=0)
        ax.set(xlabel="distance from the load over L/2", title=f"l = {factor}h")
    axes[0, 0].set_ylabel("downward deflection $w/w_0$")
    axes[0, 0].invert_yaxis()
    axes[0, 1].legend(frameon=False, fontsize="small")
    return figure


def figure_7(all_of):
    if "bending" not in all_of[0].tables:
        return None
    figure = profiles_by_width(all_of, [20, 40, 80, 160], 4.6)
    return figure


def figure_8(all_of):
    return profiles_by_width(all_of, [80, 160], 4.2) if "bending" in all_of[0].tables else None


def largest(campaign):
    return [s for s in SHEETS if s.length == 160 and campaign.profiles_of(s)]


def figure_9(all_of):
    """The largest sheets against distance over l_c, with the infinite plate."""
    if "bending" not in all_of[0].tables or not largest(all_of[0]):
        return None
    figure, axes = axes_of(8.6, 4.2, columns=2, sharey=True)
    ratio = np.linspace(0, 10, 400)
    for ax, factor in zip(axes[0], FACTORS):
        for sheet in [s for s in largest(all_of[0]) if s.factor == factor]:
            for campaign in all_of:
                found = mean_profile(campaign, sheet, 0, np.linspace(0, sheet.length / 2 / characteristic_length(sheet.thickness), 60))
                if found is None:
                    continue
                r, mean, _, peak = found
                first = campaign is all_of[0]
                ax.plot(np.r_[0, r], np.r_[np.mean(peak), mean], color=COLOURS[sheet.thickness], linewidth=1.3 if first else 0.9,
                        linestyle="-" if first else ":", label=f"h = {sheet.thickness:g} m" + (f", {campaign.label}" if campaign.label else ""))
        ax.plot(ratio, wyman(ratio), color="black", linestyle="--", linewidth=1.1, label="infinite plate (Wyman 1950)")
        ax.set(xlabel="distance from the load over $l_c$", title=f"l = {factor}h", xlim=(0, 6))
        ax.axhline(0, color="#8a949e", linewidth=0.8, zorder=-1)
    axes[0, 0].set_ylabel("downward deflection $w/w_0$")
    axes[0, 0].invert_yaxis()
    axes[0, 1].legend(frameon=False, fontsize="small")
    return figure


def largest_deviation(campaign):
    """Of the mean profiles of the largest sheets from Wyman's, beyond the load's own point: {(h, l/h): value}."""
    deviations = {}
    for sheet in largest(campaign):
        farthest = sheet.length / 2 / characteristic_length(sheet.thickness)
        r, mean, _, _ = mean_profile(campaign, sheet, 0, np.linspace(0.2, min(farthest, 6), 40))
        deviations[sheet.thickness, sheet.factor] = float(np.max(np.abs(mean - wyman(r))))
    return deviations


FIGURES = {
    2: (figure_2, "Three sheets with L = 10 m."),
    3: (figure_3, "Size range of the sheets (h = 0.5 m, l = 2h), each to the scale of its frame, and sections of the largest sheet's two meshes."),
    5: (figure_5, "Effective Young's modulus; bars are means over the meshes, whiskers standard deviations."),
    6: (figure_6, "E/E* and E/Eb against L/l; the dotted line is L/l = 25."),
    7: (figure_7, "Mean deflection profiles over the half-width, w0 of the infinite plate; bands are standard deviations."),
    8: (figure_8, "The same for L = 80 and 160 m."),
    9: (figure_9, "L = 160 m against distance over the characteristic length."),
}
