"""Pictures of runs by matplotlib: run.plot.load(), .sheet(), .fragments(), .energies(); of an
ensemble .exceedance(). Each draws into `axes`, or into a new figure, and returns the Axes."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from floe.errors import InputError
from floe.results import breakage
from floe.results.output import BEAM_STRESSES, BODY_QUANTITIES, Output, scaled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from floe.run import Ensemble, Run

INK, WARM, GREY = "#22577a", "#c1440e", "#8a949e"
COMPONENTS = ("horizontal", "x", "y", "z", "total")


def new_axes(axes: Axes | None, size: tuple[float, float]) -> Axes:
    """The axes that are given, or those of a new figure of this size [inches]."""
    if axes is None:
        import matplotlib.pyplot as plt
        _, axes = plt.subplots(figsize=size, layout="constrained")
    axes.spines[["top", "right"]].set_visible(False)
    return axes


def figure_of(axes: Axes) -> Any:
    return axes.figure


def unit_of_time(output: Output) -> str:
    """" [s]", but in statics, where time orders the load steps."""
    statics = output.options().get("integrator", "quasistatic") == "quasistatic"
    return "" if statics else " [s]"


# -- forces and energies against time -------------------------------------------------------------

def force_of(table: Any, name: str, component: str) -> np.ndarray:
    """A component of the force on an obstacle in the rows of a history [N]."""
    force = np.stack([table[f"{name}_force_{axis}"].to_numpy() for axis in "xyz"])
    if component == "horizontal":
        return np.hypot(force[0], force[1])
    return np.linalg.norm(force, axis=0) if component == "total" else force["xyz".index(component)]


def load(table: Any, names: list[str], component: str, axes: Axes | None = None) -> Axes:
    """A component of the forces on obstacles against time. table: run.history."""
    axes = new_axes(axes, (7, 3.4))
    for name in names:
        axes.plot(table.index, force_of(table, name, component) / 1e3, linewidth=1, label=name)
    label = {"horizontal": "horizontal force [kN]", "total": "force [kN]"}.get(
        component, f"$F_{component}$ [kN]")
    axes.set(xlabel="time [s]", ylabel=label)
    axes.legend(frameon=False)
    return axes


def load_panels(table: Any, names: list[str]) -> Figure:
    """A panel for each of x, y and z in which some force is more than 0.1 % of the largest."""
    import matplotlib.pyplot as plt
    most = {axis: max(np.abs(table[f"{name}_force_{axis}"]).max() for name in names)
            for axis in "xyz"}
    acting = [axis for axis in "xyz" if most[axis] > 1e-3 * max(most.values())] or ["z"]
    figure, panels = plt.subplots(len(acting), 1, figsize=(7, 1.2 + 2.2 * len(acting)), sharex=True,
                                  squeeze=False, layout="constrained")
    for axis, panel in zip(acting, panels[:, 0]):
        load(table, names, axis, panel)
        if panel is not panels[0, 0]:
            panel.get_legend().remove()
        panel.label_outer()
    figure.align_ylabels()
    return figure


def energies(table: Any, axes: Axes | None = None) -> Axes:
    """The energies of a history against time, those above a thousandth of the largest change."""
    axes = new_axes(axes, (7, 4))
    columns = [name for name in table if name.startswith("energy_") and "error" not in name]
    change = {name: table[name] - table[name].iloc[0] for name in columns}
    most = max((np.abs(values).max() for values in change.values()), default=0.0)
    size, unit = next(((size, unit) for size, unit in ((1e9, "GJ"), (1e6, "MJ"), (1e3, "kJ"))
                       if most >= size), (1.0, "J"))
    shown = {name: values for name, values in change.items()
             if np.abs(values).max() > 1e-3 * most}
    for k, (name, values) in enumerate(shown.items()):
        # more curves than colours: those that come again are dashed
        axes.plot(table.index, values / size, color=f"C{k % 10}", linewidth=1,
                  linestyle="-" if k < 10 else "--",
                      label=name.removeprefix("energy_").replace("_", " "))
    axes.set(xlabel="time [s]", ylabel=f"energy since the first row [{unit}]")
    if shown:
        axes.legend(frameon=False, fontsize=8, ncols=2)
    return axes


# -- sheets from above ----------------------------------------------------------------------------

def colours(values: np.ndarray) -> tuple[str, Any]:
    """Colour map and range: diverging about zero if both signs matter, else sequential."""
    from matplotlib.colors import Normalize
    low, high = values.min(), values.max()
    if low < 0 < high and min(-low, high) > 0.1 * max(-low, high):
        size = max(-low, high)
        return "coolwarm", Normalize(-size, size)
    if high <= low:
        high = low + (abs(low) or 1) * 1e-3
    return ("viridis" if high > 0 else "viridis_r"), Normalize(low, high)


def paint(axes: Axes, collection: Any, values: np.ndarray, label: str) -> None:
    """Colours `collection` by `values` and explains it beside the picture."""
    colour_map, norm = colours(values)
    collection.set(array=values, cmap=colour_map, norm=norm)
    bar = figure_of(axes).colorbar(collection, ax=axes, shrink=0.85, pad=0.02, aspect=30)
    bar.set_label(label)
    bar.outline.set_visible(False)


def mean_over_beams(ice: Any, values: np.ndarray) -> np.ndarray:
    """Per body the mean n of its beams' values m; 0 without beams."""
    total, count = np.zeros(len(ice.position)), np.zeros(len(ice.position))
    for end in ice.beams["bodies"].T:
        np.add.at(total, end, values)
        np.add.at(count, end, 1)
    return total / np.maximum(count, 1)


def quantity(output: Output, name: str, time: float,
             on_cells: bool) -> tuple[np.ndarray, str, bool]:
    """Values of a quantity in a readable unit, label with that unit, and whether they belong to
    cells."""
    if name in BODY_QUANTITIES:
        values, unit, label = output.body_quantity(name, time)
    else:
        (values, label), unit = output.beam_stress(name, time), "Pa"
        if on_cells:
            values, label = mean_over_beams(output.at(time), values), label + ", mean"
    values, unit = scaled(values, unit)
    return values, f"{label} [{unit}]", on_cells or name in BODY_QUANTITIES


def sheet(output: Output, time: float | None = None, colour: str = "axial", cells: bool = False,
          deformed: float = 0, axes: Axes | None = None) -> Axes:
    """A lattice from above at the frame nearest to `time` (None: the last), beams or cells coloured
    by what they carry.

    colour: a name of BODY_QUANTITIES (u, ux, ..., rz) or BEAM_STRESSES (axial, tensile, shear);
    cells: a stress on the cells, not on the beams; deformed: factor of displacements that are
    drawn."""
    from matplotlib.collections import LineCollection, PolyCollection
    if colour not in (known := (*BEAM_STRESSES, *BODY_QUANTITIES)):
        raise InputError(f"colour '{colour}' is none of {', '.join(known)}")
    if not output.beams and colour in BEAM_STRESSES:
        raise InputError(f"{output.folder} has no beams; colour by a quantity of the bodies")
    if not output.shapes and (cells or colour in BODY_QUANTITIES):
        raise InputError(f"{output.folder} has no shapes of bodies; colour by a stress of beams")
    at = output.nearest(time)
    ice = output.at(at)
    move = deformed * output.field("bodies_displacement", at)[:, :2]
    centre = ice.position[:, :2] + move
    extent = np.ptp(centre, axis=0) + 1e-9 * np.ptp(centre)
    # 7.2 wide less colour bar and labels
    axes = new_axes(axes, (7.2, float(np.clip(0.9 + 5.7 * extent[1] / extent[0], 2.5, 9))))
    fine = np.sqrt(2000 / max(len(centre), 2000))  # thinner lines on finer meshes
    values, label, of_cells = quantity(output, colour, at, cells)
    if ice.shapes:
        plans = [plan + by for plan, by in zip(ice.plans(), move)]
        tiles = PolyCollection(plans, facecolors="#f1f4f6", linewidths=0.5 * fine,
                               edgecolors="#ffffff60" if of_cells else GREY)
        tiles.set_rasterized(len(plans) > 5000)
        axes.add_collection(tiles)
        if of_cells:
            paint(axes, tiles, values, label)
    if not of_cells:
        lines = LineCollection(centre[ice.beams["bodies"]], linewidths=2.0 * fine,
                               capstyle="round")
        lines.set_rasterized(len(centre) > 5000)
        axes.add_collection(lines)
        paint(axes, lines, values, label)
    axes.autoscale_view()
    axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]")
    scale = f", displacements × {deformed:g}" if deformed else ""
    axes.set_title(f"{output.folder.name}: {len(centre)} bodies, "
                   f"{len(ice.beams.get('bodies', []))} beams, "
                   f"time {at:g}{scale}", fontsize="medium", loc="left")
    return axes


# -- broken sheets --------------------------------------------------------------------------------

def facets(ice: Any, beams: np.ndarray) -> np.ndarray:
    """Ends k x 2 x 2 [m], in plan, of the sections of `beams` (their facets) in the reference
    state."""
    ends = ice.position[ice.beams["bodies"][beams]]
    middle = ends.mean(axis=1)[:, :2]
    half = 0.5 * ice.beams["width"][beams][:, None] * ice.beams["axis_y"][beams][:, :2]
    return np.stack([middle - half, middle + half], axis=1)


def fragments(output: Output, time: float | None = None, axes: Axes | None = None) -> Axes:
    """Cells coloured by fragment (the largest one pale), cracks coloured by the time of their
    breaking, at the frame nearest to `time` (None: the end of the run)."""
    import matplotlib.pyplot as plt
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.colors import ListedColormap
    if not (output.folder / "breaks.h5").exists():
        raise InputError(f"{output.folder} has no breaks.h5: nothing could break in this run")
    ice: Any = output
    breaks = None
    if time is not None or output.changes:
        at = output.nearest(time)
        ice, breaks = output.at(at), breakage.at_frame(output, at)
    breaks = breaks or breakage.at_end(output)
    axes = new_axes(axes, (7.2, 5.2))
    fragment = breaks["fragments/of_body"]
    palette = plt.get_cmap("tab20")(np.arange(20))
    faces = palette[1 + (fragment - 1) % 19]
    faces[fragment == 0] = (0.93, 0.96, 0.98, 1)
    axes.add_collection(PolyCollection(ice.plans(), facecolors=faces, edgecolors="#c8d4dc",
                                       linewidths=0.15))
    if len(breaks["beam"]):
        # that shows on pale cells
        dark = ListedColormap(plt.get_cmap("inferno")(np.linspace(0.8, 0, 256)))
        lines = LineCollection(facets(ice, breaks["beam"]), array=breaks["time"], cmap=dark,
                               linewidths=1.4)
        first, last = breaks["time"].min(), breaks["time"].max()
        lines.set_clim(first, last if last > first else first * (1 + 1e-3) + 1e-9)
        axes.add_collection(lines)
        bar = figure_of(axes).colorbar(lines, ax=axes, shrink=0.85,
                                       label=f"time of the break{unit_of_time(output)}")
        bar.outline.set_visible(False)
    axes.set_aspect("equal")
    axes.autoscale()
    axes.set(xlabel="x [m]", ylabel="y [m]")
    count = len(breaks["fragments/mass"])
    axes.set_title(f"{len(breaks['beam'])} beams broken, {count} fragment{'s' * (count > 1)}"
                   + (f", time {at:g}" if time is not None else ""), loc="left")
    return axes


def counts(output: Output, table: Any, axes: Axes | None = None) -> Axes:
    """Numbers of broken beams and of fragments against time. table: run.history."""
    axes = new_axes(axes, (5, 4))
    axes.plot(table.index, table["beams_broken"], color=INK, label="beams broken")
    axes.plot(table.index, table["fragments"], color=WARM, label="fragments")
    axes.set(xlabel=f"time{unit_of_time(output)}", ylabel="number", ylim=(0, None))
    axes.legend(frameon=False)
    return axes


class Plots:
    """run.plot: pictures of a run. Each method draws into `axes` or a new figure, and returns the
    Axes, whose figure.savefig(file) writes them."""

    def __init__(self, run: Run):
        self._run = run

    def load(self, component: str = "horizontal", obstacle: str | None = None,
             axes: Axes | None = None) -> Axes:
        """A component (horizontal, x, y, z, total) of the forces on all obstacles, or on one,
        against time."""
        if component not in COMPONENTS:
            raise InputError(f"component '{component}' is none of {', '.join(COMPONENTS)}")
        return load(self._run.history, self._run.one_or_all(obstacle), component, axes)

    def energies(self, axes: Axes | None = None) -> Axes:
        """The energies against time."""
        return energies(self._run.history, axes)

    def sheet(self, time: float | None = None, colour: str = "axial", cells: bool = False,
              deformed: float = 0, axes: Axes | None = None) -> Axes:
        """The lattice from above at the frame nearest to `time`; see floe.plots.sheet."""
        return sheet(self._run.output, time, colour, cells, deformed, axes)

    def fragments(self, time: float | None = None, axes: Axes | None = None) -> Axes:
        """Fragments and cracks from above; see floe.plots.fragments."""
        return fragments(self._run.output, time, axes)


    def motion(self, structure: str | None = None, component: str | None = None,
               start: float = 0) -> Figure:
        """Motion of a structure and its spectrum from a time on [s]; see floe.panels.motion and
        floe.results.motion.read."""
        from floe import panels
        from floe.results import motion as motions
        return panels.motion(motions.read(self._run.history, structure, component, start))

    def pressure(self, obstacle: str | None = None, start: float = 0) -> Figure:
        """Pressures on an obstacle from a time on [s]; see floe.panels.pressure."""
        from floe import panels
        from floe.results import pressure as pressures
        return panels.pressure(pressures.chosen(self._run.pressure, obstacle, start))

    def deflection(self, axes: Axes | None = None) -> Axes:
        """A point-loaded sheet beside Wyman's infinite plate; see floe.panels.deflection."""
        from floe import panels
        return panels.deflection([self._run.output], axes)


class EnsemblePlots:
    """ensemble.plot: pictures of an ensemble."""

    def __init__(self, ensemble: Ensemble):
        self._ensemble = ensemble

    def exceedance(self, obstacle: str | None = None, axes: Axes | None = None,
                   **settings: Any) -> Axes:
        """Maxima at their plotting positions and Gumbel's law with its band; settings as of
        ensemble.loads. InputError if the runs differ in more than their seeds."""
        from floe.loads import figures, statements
        found = self._ensemble.loads(obstacle, **settings)
        if len(found) > 1:
            raise InputError(f"{self._ensemble.folder}: its runs are of {len(found)} scenes, which "
                             "have laws of their own")
        axes = new_axes(axes, (5, 4))
        size, unit = figures.unit_of(max(found[0]["maxima"]))
        figures.draw_exceedance(axes, found[0], statements.settings_of(**settings), size, unit)
        return axes
