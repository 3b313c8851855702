#!/usr/bin/python3
"""Counterparts of the paper's figures, from the results of a campaign (floe campaign_report)."""
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from campaign_cases import FACTORS, GRAVITY, LENGTHS, SHEETS, THICKNESSES, WATER, YOUNG
from floe.results.output import Lattice
from floe.sheets.plate import wyman

POISSON = 0.3
# r = k_s/k_n of one_point beams, and moduli of their infinite lattice (docs/model.md section 3)
SHEAR = 5 / 6 / (2 * (1 + POISSON))
LATTICE = {"E": 2 * (1 + SHEAR) / (3 + SHEAR), "nu": (1 - SHEAR) / (3 + SHEAR),
           "G": (1 + SHEAR) / 4, "K": 0.5}
SHEET = {(s.length, s.thickness, s.factor): s for s in SHEETS}
COLOURS = {0.5: "#1f6f8b", 1: "#d1802f", 1.5: "#6b4e9b"}  # by thickness
CURVES = ["#c0392b", "#3a8a4d", "#d1802f", "#b23a5f"]      # of further campaigns


def characteristic_length(thickness):
    """l_c = (D/k)^(1/4) (docs/model.md section 5) [m]."""
    return (YOUNG * thickness**3 / (12 * (1 - POISSON**2)) / (WATER * GRAVITY))**0.25


def axes_of(width=6.8, height=4.4, columns=1, rows=1, **more):
    figure, axes = plt.subplots(rows, columns, figsize=(width, height), layout="constrained",
                                squeeze=False, **more)
    for ax in axes.flat:
        ax.spines[["top", "right"]].set_visible(False)
    return figure, axes


def kept_lattice(campaign, sheet):
    return campaign.folder / "lattices" / f"tension_{sheet.name}_01.h5"


def cells(axes, campaign, sheet):
    """Draws a sheet's cells. False if its lattice was not kept."""
    path = kept_lattice(campaign, sheet)
    if not path.exists():
        return False
    axes.add_collection(PolyCollection(Lattice(path).plans(), facecolors="#e8f0f4",
                                       edgecolors="#4a6a7a", linewidths=0.6))
    half = 0.52 * sheet.length
    axes.set(aspect="equal", xlim=(-half, half), ylim=(-half, half), xticks=[], yticks=[])
    axes.spines[:].set_visible(False)
    return True


def beams(axes, campaign, sheet):
    """Draws a sheet's beams, from centroid to centroid."""
    lattice = Lattice(kept_lattice(campaign, sheet))
    axes.add_collection(LineCollection(lattice.position[lattice.beams["bodies"], :2],
                                       colors="#c0392b", linewidths=0.8))


def figure_2(all_of):
    """The sheets of 10 m with l = 3h, as in the paper, with their beams."""
    sheets = [s for s in SHEETS if s.length == 10 and s.factor == 3]
    figure, axes = axes_of(7.2, 2.7, columns=3)
    for ax, sheet in zip(axes[0], sheets):
        if not cells(ax, all_of[0], sheet):
            return None
        beams(ax, all_of[0], sheet)
        ax.set_title(f"h = {sheet.thickness:g} m, l = {sheet.element_size:g} m", fontsize="medium")
    return figure


def figure_3(all_of):
    """Size range, to one scale, and sections of the finest and the coarsest mesh of the largest
    sheet."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained", width_ratios=[1.9, 1])
    left = 0
    for length in LENGTHS:
        sheet = SHEET[length, 0.5, 2]
        path = kept_lattice(all_of[0], sheet)
        if not path.exists():
            return None
        plans = [plan + [left + length / 2, length / 2] for plan in Lattice(path).plans()]
        axes[0].add_collection(PolyCollection(plans, facecolors="#e8f0f4", edgecolors="#4a6a7a",
                                              linewidths=0.1, rasterized=True))
        axes[0].text(left + length / 2, -4, f"{length}", ha="center", va="top", fontsize="small")
        left += length + 8
    axes[0].set(aspect="equal", xlim=(-5, left), ylim=(-16, 165), xticks=[], yticks=[])
    axes[0].set_title("L [m], h = 0.5 m, l = 2h", fontsize="medium")
    for half, (thickness, factor) in enumerate(((0.5, 2), (1.5, 3))):
        sheet = SHEET[160, thickness, factor]
        path = kept_lattice(all_of[0], sheet)
        if not path.exists():
            return None
        low = 21 * (1 - half)
        plans = [plan + [0, low] for plan in Lattice(path).plans()
                 if np.all(abs(plan) <= [20, 10], axis=1).any()]
        tiles = PolyCollection(plans, facecolors="#e8f0f4", edgecolors="#4a6a7a", linewidths=0.5)
        axes[1].add_collection(tiles)
        tiles.set_clip_path(Rectangle((-20, low - 10), 40, 20, transform=axes[1].transData))
        axes[1].text(0, low + 10.3 if half == 0 else low - 10.6,
                     f"{sheet.bodies} cells (h = {thickness:g} m, l = {factor}h)", ha="center",
                     va="bottom" if half == 0 else "top", fontsize="small")
    axes[1].set(aspect="equal", xlim=(-20.3, 20.3), ylim=(-14, 35), xticks=[], yticks=[])
    axes[1].set_title("sections of L = 160 m, 40 m × 20 m", fontsize="medium")
    for ax in axes:
        ax.spines[:].set_visible(False)
    return figure


def figure_5(all_of):
    """E of every sheet, in the paper's order: by L, then h, then l."""
    figure, axes = axes_of(8.6, 4)
    ax = axes[0, 0]
    position, ticks = 0, []
    for length in LENGTHS:
        start = position
        for thickness in THICKNESSES:
            for factor in FACTORS:
                sheet = SHEET[length, thickness, factor]
                values = all_of[0].values("tension", sheet, "E") / 1e9
                if len(values):
                    ax.bar(position, values.mean(), 0.85, yerr=values.std(ddof=1) if len(values) > 1
                           else None, capsize=2,
                           color=COLOURS[thickness], alpha=1 if factor == 2 else 0.55,
                           label=f"h = {thickness:g} m, l = {factor}h" if length == LENGTHS[0]
                           else None)
                position += 1
        ticks.append((start + position - 1) / 2)
        position += 1
    ax.axhline(YOUNG / 1e9, color="black", linewidth=1, label="$E_b$ of the beams")
    ax.axhline(LATTICE["E"] * YOUNG / 1e9, color="#c0392b", linewidth=1,
               label="$E^*$ of the infinite lattice")
    ax.set_xticks(ticks, [f"{length}" for length in LENGTHS])
    ax.set(xlabel="sheet size L [m]", ylabel="effective Young's modulus E [GPa]")
    ax.legend(frameon=False, fontsize="small", ncols=2)
    return figure


def by_ratio(axes, campaign, test, column, scale=1, **style):
    """Means and deviations of a column over all sheets against L/l."""
    points = sorted((s.length / s.element_size, *moments(v / scale)) for s in SHEETS
                    if len(v := campaign.values(test, s, column)))
    if points:
        ratio, mean, deviation = zip(*points)
        axes.errorbar(ratio, mean, yerr=deviation, capsize=2, linewidth=0.8, markersize=4,
                      linestyle="none", **style)
    return bool(points)


def moments(values):
    return values.mean(), values.std(ddof=1) if len(values) > 1 else 0


def ratio_axis(axes):
    axes.set_xscale("log")
    axes.set_xticks([2, 5, 10, 25, 50, 100, 160], ["2", "5", "10", "25", "50", "100", "160"])
    axes.minorticks_off()
    axes.set_xlabel("relative sheet size $L/l$")


def figure_6(all_of):
    """E/E* and E/Eb against L/l."""
    figure, axes = axes_of()
    ax = axes[0, 0]
    by_ratio(ax, all_of[0], "tension", "E_over_Estar", fmt="s", color="#1f6f8b",
             markerfacecolor="none", label="$E/E^*$")
    by_ratio(ax, all_of[0], "tension", "E_over_Eb", fmt="o", color="#1f6f8b", label="$E/E_b$")
    for number, campaign in enumerate(all_of[1:]):
        by_ratio(ax, campaign, "tension", "E_over_Eb", fmt="^v<>"[number % 4],
                 color=CURVES[number % 4], markerfacecolor="none",
                 label=f"$E/E_b$, {campaign.label}")
    for level in (1, LATTICE["E"]):
        ax.axhline(level, color="#8a949e", linewidth=0.8, zorder=-1)
    ax.axvline(25, color="#8a949e", linewidth=0.8, linestyle=":", zorder=-1)
    ratio_axis(ax)
    ax.set_ylabel("ratio")
    ax.legend(frameon=False, fontsize="small")
    return figure


def mean_profile(campaign, sheet, column, edges):
    """Mean and deviation over the meshes of w/w0 at the middles of the edges of column 0 (r/l_c) or
    2 (r over the half-width), as far as half of the meshes have bodies; and each mesh's value under
    the load."""
    points = campaign.profiles_of(sheet)
    if not points:
        return None
    centre = (edges[:-1] + edges[1:]) / 2
    centre = centre[centre <= sorted(p[:, column].max() for p in points)[(len(points) - 1) // 2]]
    values = np.array([np.interp(centre, p[:, column], p[:, 1], right=np.nan) for p in points])
    spread = np.nanstd(values, axis=0, ddof=1) if len(points) > 1 else 0 * centre
    return centre, np.nanmean(values, axis=0), spread, [p[0, 1] for p in points]


def profiles_by_width(all_of, lengths, height, columns=1, above=0):
    """Profiles over the half-width. The legend has so many columns, and stands so high above the
    bottom (of 1)."""
    figure, axes = axes_of(8.6, height, columns=2, sharey=True)
    styles = dict(zip(LENGTHS, ["-", ":", "--", "-.", "-"]))
    for ax, factor in zip(axes[0], FACTORS):
        for sheet in SHEETS:
            if sheet.factor != factor or sheet.length not in lengths:
                continue
            found = mean_profile(all_of[0], sheet, 2, np.linspace(0, 1, 25))
            if found is None:
                continue
            y, mean, deviation, peak = found
            y, mean, deviation = np.r_[0, y], np.r_[np.mean(peak),
                                                    mean], np.r_[np.std(peak), deviation]
            ax.plot(y, mean, color=COLOURS[sheet.thickness], linestyle=styles[sheet.length],
                    linewidth=1.2)
            ax.fill_between(y, mean - deviation, mean + deviation, color=COLOURS[sheet.thickness],
                            alpha=0.15, linewidth=0)
        ax.set(xlabel="distance from the load over L/2", title=f"l = {factor}h", xlim=(0, 1))
    axes[0, 0].set_ylabel("downward deflection $w/w_0$")
    axes[0, 0].invert_yaxis()
    lines = [Line2D([], [], color=COLOURS[h], label=f"h = {h:g} m") for h in THICKNESSES]
    lines += [Line2D([], [], color="#4a4a4a", linestyle=styles[length], label=f"L = {length} m")
              for length in lengths]
    axes[0, 1].legend(handles=lines, loc="lower right", bbox_to_anchor=(1, above), ncols=columns,
                      frameon=False, fontsize="small")
    return figure


def figure_7(all_of):
    return profiles_by_width(all_of, [20, 40, 80, 160], 5.2, 2,
                             0.12) if "bending" in all_of[0].tables else None


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
                found = mean_profile(campaign, sheet, 0,
                                     np.linspace(0,
                                                 sheet.length / 2
                                                 / characteristic_length(sheet.thickness), 60))
                if found is None:
                    continue
                r, mean, deviation, peak = found
                first = campaign is all_of[0]
                if first:
                    ax.fill_between(r, mean - deviation, mean + deviation,
                                    color=COLOURS[sheet.thickness], alpha=0.15, linewidth=0)
                ax.plot(np.r_[0, r], np.r_[np.mean(peak), mean], color=COLOURS[sheet.thickness],
                        linewidth=1.3 if first else 0.9,
                        linestyle="-" if first else ":", label=f"h = {sheet.thickness:g} m"
                        + (f", {campaign.label}" if campaign.label else ""))
        ax.plot(ratio, wyman(ratio), color="black", linestyle="--", linewidth=1.1,
                label="infinite plate (Wyman 1950)")
        ax.set(xlabel="distance from the load over $l_c$", title=f"l = {factor}h", xlim=(0, 6))
        ax.axhline(0, color="#8a949e", linewidth=0.8, zorder=-1)
    axes[0, 0].set_ylabel("downward deflection $w/w_0$")
    axes[0, 0].invert_yaxis()
    axes[0, 1].legend(frameon=False, fontsize="small")
    return figure


def moduli(campaign):
    """E, nu, G and K over those of the infinite lattice against L/l, strains over the gauge
    length."""
    if "shear" not in campaign.tables:
        return None
    figure, axes = axes_of(6.8, 4.2)
    ax = axes[0, 0]
    rows = (("tension", "E_gauge_over_Eb", "E", "o", "$E/E^*$"),
            ("tension", "poisson", "nu", "d", "$\\nu/\\nu^*$"),
            ("shear", "G_over_Eb", "G", "s", "$G/G^*$"),
            ("biaxial", "K_over_Eb", "K", "^", "$K/K^*$"))
    for (test, column, name, marker, label), colour in zip(rows,
                                                           ["#1f6f8b", "#8a949e", "#d1802f",
                                                            "#6b4e9b"]):
        by_ratio(ax, campaign, test, column, LATTICE[name], fmt=marker, color=colour, label=label)
    ax.axhline(1, color="#8a949e", linewidth=0.8, zorder=-1)
    ratio_axis(ax)
    ax.set_ylabel("over the infinite lattice's")
    ax.legend(frameon=False, fontsize="small")
    return figure


def size(campaign, calibrated):
    """Deflection under the load against the half-width over l_c, as it comes and calibrated."""
    figure, axes = axes_of(6.8, 4.2)
    ax = axes[0, 0]
    for one, filled, name in ((campaign, True, ""), (calibrated, False, ", calibrated")):
        for factor, marker in zip(FACTORS, "os"):
            points = sorted((s.length / 2 / characteristic_length(s.thickness), *moments(v))
                            for s in SHEETS if s.factor == factor
                            and len(v := one.values("bending", s, "deflection_over_wyman")))
            colour = "#1f6f8b" if factor == 2 else "#d1802f"
            ax.errorbar(*np.transpose(points)[:2], yerr=np.transpose(points)[2], fmt=marker,
                        markersize=4, capsize=2, linewidth=0.8,
                        color=colour, markerfacecolor=colour if filled else "none",
                        label=f"l = {factor}h{name}")
    half = np.linspace(0.45, 10, 300)
    ax.plot(half, 2 / half**2, color="#8a949e", linestyle="--", linewidth=1,
            label="rigid: $8 l_c^2/L^2$")
    ax.axhline(1, color="#8a949e", linewidth=0.8, zorder=-1)
    ax.axvline(5, color="#8a949e", linewidth=0.8, linestyle=":", zorder=-1)
    ax.set_xscale("log")
    ax.set_xticks([0.5, 1, 2, 5, 10], ["0.5", "1", "2", "5", "10"])
    ax.minorticks_off()
    ax.set(xlabel="half-width $L/(2 l_c)$", ylabel="$w/w_0$ under the load", ylim=(0.9, 2.2))
    ax.legend(frameon=False, fontsize="small")
    return figure


def largest_deviation(campaign):
    """Of the mean profiles of the largest sheets from Wyman's, beyond the load's own point: {(h,
    l/h): value}."""
    deviations = {}
    for sheet in largest(campaign):
        farthest = sheet.length / 2 / characteristic_length(sheet.thickness)
        r, mean, _, _ = mean_profile(campaign, sheet, 0, np.linspace(0.2, min(farthest, 6), 40))
        deviations[sheet.thickness, sheet.factor] = float(np.max(np.abs(mean - wyman(r))))
    return deviations


FIGURES = {
    2: (figure_2, "Three sheets with L = 10 m and l = 3h; red: beams."),
    3: (figure_3, "Size range of the sheets, to one scale, and sections of the finest and the "
                  "coarsest mesh of the largest one."),
    5: (figure_5, "Effective Young's modulus; bars are means over the meshes, whiskers standard "
                  "deviations."),
    6: (figure_6, "E/E* and E/Eb against L/l; the dotted line is L/l = 25."),
    7: (figure_7, "Mean deflection profiles over the half-width, w0 of the infinite plate, "
                  "as far as most meshes have centroids; bands (thinner than most lines) "
                  "are standard deviations."),
    8: (figure_8, "The same for L = 80 and 160 m."),
    9: (figure_9, "L = 160 m against distance over the characteristic length."),
}
