"""Pictures of several panels by matplotlib: run.plot.motion(), .pressure(), .deflection(). Each
returns the Figure."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Sequence

import numpy as np

from floe.plots import GREY, new_axes
from floe.results.output import Output

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def motion(found: Any) -> Figure:
    """Displacement, velocity and acceleration against time, and the spectrum of the velocity.
    found: floe.results.motion.Motion."""
    import matplotlib.pyplot as plt
    length = found.unit
    figure, panels = plt.subplots(4, 1, figsize=(7, 9), layout="constrained")
    for panel, values, label in zip(
            panels, (found.displacement, found.velocity, found.acceleration),
            (f"${found.component}$ [{length}]", f"velocity [{length}/s]",
             f"acceleration [{length}/s$^2$]")):
        panel.plot(found.time, values, linewidth=0.8)
        panel.set_ylabel(label)
        panel.sharex(panels[0])
    panels[2].set_xlabel("time [s]")
    frequency, density = found.spectrum()
    shown = frequency > 0
    panels[3].semilogy(frequency[shown], np.maximum(density[shown], density.max() * 1e-12),
                       linewidth=0.8)
    panels[3].set_xlabel("frequency [Hz]")
    panels[3].set_ylabel(f"velocity [({length}/s)$^2$/Hz]")
    for panel in panels:
        panel.spines[["top", "right"]].set_visible(False)
    figure.align_ylabels()
    return figure


def pressure_map(panel: Axes, where: Any, values: np.ndarray, title: str) -> None:
    """A map of the pressure [Pa] on patches. where: floe.results.pressure.unrolled."""
    from matplotlib.collections import PatchCollection
    from matplotlib.patches import Rectangle
    x, half, label, z, tall, shown = where
    squares = [Rectangle((x[k] - half[k], z[k] - tall[k]), 2 * half[k], 2 * tall[k])
               for k in np.flatnonzero(shown)]
    drawn = PatchCollection(squares, cmap="viridis", linewidth=0)
    drawn.set_array(values[shown] / 1e6)
    drawn.set_clim(0, max(values[shown].max(initial=0) / 1e6, 1e-12))
    panel.add_collection(drawn)
    panel.autoscale_view()
    panel.set_title(title, fontsize=9)
    panel.set_xlabel(label)
    panel.set_ylabel("height [m]")
    panel.figure.colorbar(drawn, ax=panel, label="MPa")


def pressure(patches: Any) -> Figure:
    """Maps of the largest and the mean pressure and of that at the time of the largest force, the
    largest mean pressure against the area beside ISO 19906's curve, and the area in contact.
    patches: floe.results.pressure.Patches."""
    import matplotlib.pyplot as plt

    from floe.results import pressure as pressures
    area, curve = pressures.area_curve(patches)
    figure, panels = plt.subplot_mosaic([["largest", "area"], ["mean", "area"], ["at", "extent"]],
                                        figsize=(11, 9), layout="constrained")
    where, values = pressures.unrolled(patches), patches.pressure
    top = int(np.argmax(np.linalg.norm(patches.total, axis=1)))
    pressure_map(panels["largest"], where, values.max(axis=0), "largest")
    pressure_map(panels["mean"], where, patches.mean(values), "mean")
    pressure_map(panels["at"], where, values[top],
                 f"at {patches.time[top]:.4g} s, the largest force")
    panel = panels["area"]
    panel.loglog(area, curve / 1e6, ".-", linewidth=0.8, label=patches.name)
    span = np.geomspace(area.min(), max(area.max(), 2 * area.min()), 100)
    panel.loglog(span, pressures.iso(span) / 1e6, "k--", linewidth=0.8, label="ISO 19906")
    panel.set_xlabel("area [m$^2$]")
    panel.set_ylabel("largest mean pressure [MPa]")
    panel.legend(frameon=False)
    panels["extent"].plot(patches.time, 100 * patches.loaded(), linewidth=0.8)
    panels["extent"].set_xlabel("time [s]")
    panels["extent"].set_ylabel("area in contact [%]")
    for name in ("area", "extent"):
        panels[name].spines[["top", "right"]].set_visible(False)
    return figure


def deflection(outputs: Sequence[Output], axes: Axes | None = None) -> Axes:
    """Deflection of point-loaded floating sheets beside Wyman's infinite plate (1950), a set of
    points for each output: over w0 of that plate, against the distance from the load over the
    characteristic length."""
    from floe.sheets.plate import plate, profile, wyman
    axes = new_axes(axes, (6.8, 4.4))
    farthest = 0.0
    for output, marker in zip(outputs, "os^Dv<>p*" * len(outputs)):
        options = output.options()
        length, w0 = plate(options)
        r, w = profile(output, options)
        top = output.summary.get("deflection_max")
        if top is not None:
            r, w = np.concatenate([[0], r]), np.concatenate([[top], w])
        farthest = max(farthest, r.max() / length)
        label = (f"{output.folder.name}: L = {float(options['sheet_length']):g} m, "
                 f"h = {float(options['sheet_thickness']):g} m, "
                 f"l = {float(options['sheet_element_size']):g} m")
        axes.plot(r / length, w / w0, marker, markersize=4.5, markerfacecolor="none", label=label)
    ratio = np.linspace(0, farthest, 400)
    axes.plot(ratio, wyman(ratio), color="black", linewidth=1.2,
              label="infinite plate (Wyman 1950)", zorder=0)
    axes.axhline(0, color=GREY, linewidth=0.8, zorder=-1)
    axes.invert_yaxis()
    axes.set(xlabel="distance from the load $r/l_c$", ylabel="downward deflection $w/w_0$")
    axes.legend(frameon=False)
    return axes
