"""What the rows of docs/validation.md measure: functions of a row's finished runs and its settings
(tools/validate). SI units."""
import collections
import dataclasses
import math
import re

import h5py
import numpy as np

import floe_fields
import floe_loads
import floe_program
import floe_signals
from floe_output import Output
from floe_program import BadInput

with floe_program.packages():
    from scipy import stats

G = 9.81
RHO_WATER = 1010.0
LEVEL = 0.95  # of bands of means
DRAWS, SEED = 2000, 1  # of bootstraps


@dataclasses.dataclass
class Line:
    """One comparison of a row. values: floe's, one per seed (or one); published: the number beside
    it or None; allowed: [least, most] that agrees, or None if nothing is published; half: half the
    band of the mean where it is not Student's over `values`. by_band: it agrees where the band of
    the mean meets `allowed`, as for a difference of statistics. seeds: how many it is of, where not
    one per value."""
    what: str
    values: list
    published: object = None
    allowed: object = None
    unit: str = ""
    half: object = None
    by_band: bool = False
    seeds: object = None

    @property
    def draws(self):
        """Number of seeds behind it."""
        return self.seeds or len(self.values)

    @property
    def mean(self):
        return float(np.mean(self.values))

    @property
    def band(self):
        """Half the confidence band of the mean by Student's t over the seeds, 0 of one value."""
        if self.half is not None:
            return self.half
        n = len(self.values)
        return float(stats.t.ppf(0.5 + LEVEL / 2, n - 1) * stats.sem(self.values)) if n > 1 else 0.0

    @property
    def deviation(self):
        """Of the mean from what is published, over that; None where nothing is, or it is 0."""
        return self.mean / self.published - 1 if self.published else None

    @property
    def verdict(self):
        """agrees, disagrees, or "" where nothing is published, or one seed has no band."""
        if self.allowed is None or self.by_band and self.draws < 2:
            return ""
        slack = self.band if self.by_band else 0.0
        low, high = self.allowed
        return "agrees" if low - slack <= self.mean <= high + slack else "disagrees"


@dataclasses.dataclass
class Found:
    """What a row's runs give. series: [(label, x, y, half bands or None, "points" or "line")], x
    and y: labels of the axes; log: the axes that are logarithmic, "", "x" or "xy"."""
    lines: list
    x: str
    y: str
    series: list
    log: str = ""


# -- formulas --------------------------------------------------------------------------------------

def iso_slope(h, width, angle, friction, sigma, young, rubble=0.0, poisson=0.3, ice=920.0,
              water=1010.0, porosity=0.3, repose=40.0, inner=45.0, ice_friction=0.05,
              cohesion=0.0):
    """Horizontal load [N] of a sheet on a slope by ISO 19906 (Croasdale): {"H_B": breaking, "H_P":
    pushing through rubble, "H_R": ride-up, "H_L": lifting rubble, "H_T": turning blocks, "H"}.

    h, width, rubble (height): [m]; angle of the slope, repose, inner friction: [degrees]."""
    a, t, phi = np.radians([angle, repose, inner])
    xi = (np.sin(a) + friction * np.cos(a)) / (np.cos(a) - friction * np.sin(a))
    length = (young * h**3 / (12 * water * G * (1 - poisson**2)))**0.25
    long = width + np.pi**2 / 4 * length
    k = 1 - np.tan(t) / np.tan(a)
    cot = 1 / np.tan(t) - 1 / np.tan(a)
    weight = ice * G * (1 - porosity)
    breaking = 0.68 * xi * sigma * (water * G * h**5 / young)**0.25 * long
    pushing = width * rubble**2 * ice_friction * weight * k**2 / (2 * np.tan(t))
    pressure = (0.5 * ice_friction * (ice_friction + friction) * weight * rubble**2 * np.sin(a)
                * cot * k
                + 0.5 * (ice_friction + friction) * weight * rubble**2 * np.cos(a) / np.tan(a) * k
                + rubble * h * ice * G * (np.sin(a) + friction * np.cos(a)) / np.sin(a))
    ride = width * pressure / (np.cos(a) - friction * np.sin(a))
    lifting = xi * width * rubble * k * (0.5 * (cot + np.tan(phi) * k) * rubble * weight + cohesion)
    turning = 1.5 * width * h**2 * ice * G * np.cos(a) / (np.sin(a) - friction * np.cos(a))
    total = (breaking + pushing + ride + lifting + turning) / (1 - breaking / (sigma * long * h))
    return {"H_B": breaking, "H_P": pushing, "H_R": ride, "H_L": lifting, "H_T": turning,
            "H": total}


def iso_crushing(h, width, strength):
    """Global pressure p = C_R (h/1 m)^n (w/h)^-0.16 [Pa] on a vertical structure (ISO 19906)."""
    n = -0.5 + h / 5 if h < 1 else -0.3
    return strength * h**n * (width / h)**-0.16


def first_failure(h, angle, friction, sigma, young, water=RHO_WATER):
    """Horizontal load per width [N/m] at which a semi-infinite beam on water breaks that is pushed
    against a slope by its lower edge: where 6 M/h^2 - H/h reaches sigma (docs/model.md)."""
    a = np.radians(angle)
    xi = (np.sin(a) + friction * np.cos(a)) / (np.cos(a) - friction * np.sin(a))
    rate = (water * G / (4 * young * h**3 / 12))**0.25
    x = rate * np.linspace(0, 3 / rate, 20001)
    moment = np.exp(-x) * (np.sin(x) / (xi * rate) - 0.5 * h * (np.cos(x) + np.sin(x)))
    return sigma / (6 * moment / h**2 - 1 / h).max()


def edge_uplift(h, sigma, young, water=RHO_WATER):
    """Vertical force per width [N/m] at the edge of a semi-infinite beam on water that breaks it
    (Hetenyi): 0.6804 sigma (rho g h^5/E)^(1/4)."""
    # the moment V/lambda e^-x sin x is largest at x = pi/4
    rate = (water * G / (4 * young * h**3 / 12))**0.25
    return sigma * h**2 / 6 * rate / (np.exp(-np.pi / 4) * np.sin(np.pi / 4))


def thin_floe(length, wave, draft):
    """Amplitudes over the wave's of heave, and of pitch over the wave's slope, of a rigid floe that
    is thin against a wave along it: the pressure of the undisturbed wave at its bottom
    (Froude-Krylov), its weight, its buoyancy and its inertia, no added mass."""
    k = 2 * np.pi / wave
    q, decay = k * length / 2, np.exp(-k * draft)
    inertia = 1 - k * draft
    return (decay * np.sin(q) / q / inertia,
            decay * 3 * (np.sin(q) - q * np.cos(q)) / q**3 / inertia)


# -- common ----------------------------------------------------------------------------------------

def by_point(runs):
    """{name of the point: its runs by seed}, in the order of the spec."""
    found = {}
    for run in runs:
        found.setdefault(run.point, []).append(run)
    return found


def mean_and_band(values):
    line = Line("", list(values))
    return line.mean, line.band


def low_passed(run, obstacle, settings):
    """The horizontal force on an obstacle [N] after the start, low-pass filtered, and its times."""
    drawn = floe_loads.read_run(run.folder)
    frequency, start = settings.get("filter", 1.0), settings.get("start", 0.0)
    passed = floe_signals.Filter("low-pass", frequency=frequency).apply(drawn.forces[obstacle],
                                                                        drawn.dt)
    skip = round(start / drawn.dt)
    record = np.hypot(passed[0], passed[1])[skip:]
    return record, (skip + np.arange(len(record)) + 0.5) * drawn.dt


def mean_force(run, obstacle, start=0.0, end=math.inf):
    """Mean force on an obstacle (3) [N] between two times, of all steps."""
    table = run.history
    time = table["time"].to_numpy()
    impulse = time[:, None] * table[[f"{obstacle}_mean_force_{a}" for a in "xyz"]].to_numpy()
    ends = np.clip([start, min(end, time[-1])], time[0], time[-1])
    at = np.stack([np.interp(ends, time, column) for column in impulse.T])
    return (at[:, 1] - at[:, 0]) / (ends[1] - ends[0])


def rubble_height(run, obstacle, time, half):
    """Mean over the structure's width, in eight parts, of the highest ice within 1.5 widths in
    front of it or on it [m above water] at the frame nearest to a time."""
    output = Output(run.folder)
    time = output.times[np.argmin(np.abs(output.times - time))]
    bodies = floe_fields.Bodies(output, time)
    front = run.option("sheet_length") / 2
    middle = (bodies.low + bodies.high) / 2
    near = middle[:, 0] > front - 3 * half
    parts = np.linspace(-half, half, 9)
    tops = [bodies.high[near & (bodies.low[:, 1] < b) & (bodies.high[:, 1] > a), 2]
            for a, b in zip(parts, parts[1:])]
    return float(np.mean([top.max(initial=0.0) for top in tops]))


def slope_of(x, y):
    """Slope of log y over log x."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


# -- measures --------------------------------------------------------------------------------------

def iso(runs, settings):
    """Largest low-pass filtered force of each run over ISO's load with the height of the rubble at
    that time, and over that of bare ice. settings: obstacle, width [m] (default the sheet's),
    angle [degrees], filter [Hz], start [s], allowed [least, most]."""
    lines, heights, loads = [], [], []
    for point, drawn in by_point(runs).items():
        ratios, bare, of_h, forces = [], [], [], []
        for run in drawn:
            record, times = low_passed(run, settings["obstacle"], settings)
            peak = int(np.argmax(record))
            h, width = run.option("sheet_thickness"), settings.get("width",
                                                                   run.option("sheet_width"))
            raised = rubble_height(run, settings["obstacle"], times[peak], width / 2)
            given = {"h": h, "width": width, "angle": settings["angle"],
                     "friction": run.option(f"obstacle_{settings['obstacle']}_friction"),
                     "sigma": run.option("fracture_flexural_strength"),
                     "young": run.option("ice_young"),
                     "ice_friction": run.option("contact_friction"),
                     "water": run.option("water_density"), "ice": run.option("ice_density"),
                     "repose": settings["repose"]}
            ratios.append(record[peak] / iso_slope(rubble=raised, **given)["H"])
            bare.append(record[peak] / iso_slope(**given)["H"])
            of_h.append(raised)
            forces.append(record[peak])
        what = f"h = {h:g} m"
        lines += [Line(f"{what}: peak over ISO with its rubble, {np.mean(of_h):.2f} m high",
                       ratios, 1 / 1.6, settings["allowed"]),
                  Line(f"{what}: peak over ISO without rubble", bare),
                  Line(f"{what}: peak", forces, unit="N")]
        heights.append((what, of_h, ratios))
        loads.append((h, mean_and_band(ratios)))
    series = [(what, raised, ratio, None, "points") for what, raised, ratio in heights]
    span = [0, max(max(raised) for _, raised, _ in heights)]
    series.append(("1/1.6 (measured over ISO)", span, [1 / 1.6] * 2, None, "line"))
    return Found(lines, "height of the rubble [m]", "peak over ISO", series)


def crushing(runs, settings):
    """Largest low-pass filtered force on a vertical leg over width and thickness, against ISO's
    pressure; exponents of width and thickness. settings: obstacle, filter, strength [Pa],
    allowed (exponents: half width of what agrees)."""
    pressures, lines = {}, []
    for point, drawn in by_point(runs).items():
        run = drawn[0]
        h, width = run.option("sheet_thickness"), 2 * run.option("obstacle_leg_radius")
        pressures[width, h] = [low_passed(run, settings["obstacle"], settings)[0].max()
                               / (width * h) for run in drawn]
    for (width, h), found in pressures.items():
        theory = iso_crushing(h, width, settings["strength"])
        lines.append(Line(f"w = {width:g} m, h = {h:g} m: pressure over ISO's",
                          [p / theory for p in found], 1.0, settings["allowed"]))
    series = []
    for what, k in (("width", 0), ("thickness", 1)):
        others = collections.Counter(key[1 - k] for key in pressures)
        fixed = others.most_common(1)[0][0]
        points = sorted(key for key in pressures if key[1 - k] == fixed)
        if len(points) < 2:
            continue
        n = min(len(pressures[key]) for key in points)
        x = [key[k] for key in points]
        found = [slope_of(x, [pressures[key][s] for key in points]) for s in range(n)]
        theory = [iso_crushing(key[1], key[0], settings["strength"]) for key in points]
        published = slope_of(x, theory)
        lines.append(Line(f"exponent of the pressure on {what}", found, published,
                          [published - settings["exponent"], published + settings["exponent"]]))
        means = [mean_and_band(pressures[key]) for key in points]
        label = f"h = {fixed:g} m" if k == 0 else f"w = {fixed:g} m"
        series += [(f"over {what} [m], {label}", x, [m / 1e6 for m, _ in means],
                    [b / 1e6 for _, b in means], "points"),
                   (f"ISO over {what}", x, [p / 1e6 for p in theory], None, "line")]
    return Found(lines, "width, thickness [m]", "pressure [MPa]", series, log="xy")


def southwell(run, load, width):
    """The axial load per width P [N/m] at which the deflection under a small force grows without
    end. With the deflection r per force and its value r_0 without P, P/(r - r_0) falls to 0 there
    along a line (Southwell 1932): of the last four rows in which r is over three times r_0."""
    table = run.history
    time = table["time"].to_numpy()[1:]
    moved = table[f"{load}_load_displacement_z"].to_numpy()
    compliance = np.abs(moved[1:] - moved[0]) / time  # the loads grow in proportion
    start = 2 * compliance[0] - compliance[1]
    falling = np.diff(compliance) < 0  # past the critical load
    end = int(np.argmax(falling)) + 1 if falling.any() else len(time)
    last = np.arange(max(end - 4, 0), end)
    last = last[compliance[last] > 3 * start]
    if len(last) < 2:
        raise BadInput(f"{run.folder}: its deflection does not grow enough")
    line = np.polyfit(time[last] / (compliance[last] - start), time[last], 1)
    axial = abs(run.option("load_push_force")[0]) / run.option("load_push_ramp")
    return float(line[1]) * axial / width


def buckling(runs, settings):
    """Buckling loads over sqrt(k EI*) and 2 sqrt(k EI*), EI* of the same sheet bent by its ends.
    settings: allowed."""
    points, lines = by_point(runs), []
    ratios = {"free": [], "held": [], "free, theory pushed at the cells' centroids": []}
    for point in points:
        if not point.startswith("bend_"):
            continue
        what = point.removeprefix("bend_")
        stiffness, size = {}, None
        for run in points[point]:
            with h5py.File(run.folder / "lattice.h5") as file:
                x = file["bodies/position"][:, 0]
                left, right = x[file["sets/left"][:]].mean(), x[file["sets/right"][:]].mean()
            turn = 2 * abs(run.option("boundary_left_angular_velocity")[1])
            moment = np.abs([run.column(f"{side}_moment_y")[-1] for side in ("left", "right")])
            width, size = run.option("sheet_width"), run.option("sheet_element_size")
            ei = moment.mean() * (right - left) / turn / width
            inset = left + run.option("sheet_length") / 2
            k = run.option("water_density") * run.option("gravity") if (
                "water_density" in run.options) else RHO_WATER * G
            stiffness[run.seed] = k, ei, inset, width
        label = settings["labels"].get(what, what)
        for end, factor in (("free", 1), ("held", 2)):
            found, centroids = [], []
            for run in points.get(f"{end}_{what}", []):
                if run.seed not in stiffness:
                    continue
                k, ei, inset, width = stiffness[run.seed]
                critical = southwell(run, "nudge", width)
                found.append(critical / (factor * math.sqrt(k * ei)))
                rate = (k / (4 * ei))**0.25
                # an edge that reaches beyond where it is pushed rests on water there: to first
                # order P = sqrt(k EI) (1 + 2 a alpha), alpha = lambda/sqrt 2
                centroids.append(found[-1] / (1 + math.sqrt(2) * rate * inset))
            if not found:
                continue
            lines.append(Line(f"{label}, {end} end: load over {'2 ' * (factor - 1)}sqrt(k EI*)",
                              found, 1.0, settings["allowed"]))
            ratios[end].append((size, what, found))
            if end == "free":
                lines.append(Line(f"{label}, free end: the same, of a beam pushed at the cells' "
                                  "centroids", centroids, 1.0, settings["allowed"]))
                ratios["free, theory pushed at the cells' centroids"].append((size, what,
                                                                              centroids))
    series = []
    for label, found in ratios.items():
        found = sorted(one for one in found if "calibrated" not in one[1])
        series.append((label, [size for size, _, _ in found],
                       [np.mean(values) for _, _, values in found],
                       [Line("", values).band for _, _, values in found], "points"))
    return Found(lines, "size of the elements [m]", "load over theory", series)


def slope_failure(runs, settings):
    """Load on a slope just before a strip's first break over that of a beam on water. settings:
    slow [m/s], up to which theory holds, allowed."""
    lines, series = [], collections.defaultdict(list)
    for point, drawn in by_point(runs).items():
        ratios = []
        for run in drawn:
            normal = run.option("obstacle_slope_normal")
            angle = np.degrees(np.arctan2(-normal[0], normal[2]))
            with h5py.File(run.folder / "lattice.h5") as file:
                h = float(file["beams/height"][0])
                width = float(file["beams/width"][0])
            speed = run.option("boundary_push_velocity")[0]
            theory = first_failure(h, angle, run.option("obstacle_slope_friction"),
                                   run.option("fracture_tensile_strength"), settings["young"])
            time, broken = run.column("time"), run.column("beams_broken")
            if not broken.any():
                raise BadInput(f"{run.folder}: nothing has broken")
            last = time[np.argmax(broken > 0) - 1]  # before the break
            load = mean_force(run, "slope", 0.99 * last, last)[0]
            ratios.append(load / width / theory)
        what = f"h = {h:g} m, {angle:.0f} degrees, {speed:g} m/s"
        slow = speed <= settings["slow"]
        lines.append(Line(f"{what}: load over theory", ratios, 1.0 if slow else None,
                          settings["allowed"] if slow else None))
        series[f"h = {h:g} m, {angle:.0f}°"].append((speed, np.mean(ratios)))
    drawn = [(label, *map(list, zip(*sorted(pairs))), None, "points")
             for label, pairs in series.items()]
    speeds = [speed for pairs in series.values() for speed, _ in pairs]
    drawn.append(("beam on water, slow", [min(speeds), max(speeds)], [1, 1], None, "line"))
    return Found(lines, "speed [m/s]", "load at the first break over theory", drawn, log="x")


def uplift(runs, settings):
    """Load of the first break at a lifted edge over theory. settings: allowed."""
    lines, series = [], {}
    for point, drawn in by_point(runs).items():
        ratios = []
        for run in drawn:
            h, size = run.option("sheet_thickness"), run.option("sheet_element_size")
            sigma = (run.option("fracture_flexural_strength")
                     if "fracture_flexural_strength" in run.options
                     else run.option("fracture_tensile_strength"))
            broken = np.flatnonzero(run.column("beams_broken") > 0)
            if len(broken):
                time = run.column("time")[broken[0]]
            else:  # the first break was the end of the run
                found = re.search(r"dynamic failure at load factor ([\d.eE+-]+)",
                                  run.summary.get("message", ""))
                if not found:
                    raise BadInput(f"{run.folder}: nothing has broken")
                time = float(found[1]) * run.option("time_end")
            load = run.option("load_edge_force")[2] * time / run.option("load_edge_ramp")
            ratios.append(load / run.option("sheet_width")
                          / edge_uplift(h, sigma, run.option("ice_young")))
        calibrated = point.startswith("calibrated")
        kind = "calibrated sheet" if calibrated else "beams' own stiffness and strength"
        lines.append(Line(f"l = {size / h:g} h, {kind}: load over theory", ratios, 1.0,
                          settings["allowed"]))
        series.setdefault(kind, []).append((size / h, *mean_and_band(ratios)))
    drawn = [(label, *map(list, zip(*sorted(rows))), "points") for label, rows in series.items()]
    drawn.append(("beam on water", [min(r[0] for rows in series.values() for r in rows),
                                    max(r[0] for rows in series.values() for r in rows)],
                  [1, 1], None, "line"))
    return Found(lines, "size of the elements over thickness",
                 "load of the first break over theory", drawn)


def cantilever(runs, settings):
    """6 F L/(w h^2) of the largest force at a cantilever's tip over the sheet's flexural strength.
    settings: length, width [m], allowed."""
    lines, series = [], []
    for point, drawn in by_point(runs).items():
        ratios = []
        for run in drawn:
            h, size = run.option("sheet_thickness"), run.option("sheet_element_size")
            force = np.abs(run.column("press_force_z")).max()
            ratios.append(6 * force * settings["length"] / (settings["width"] * h**2)
                          / run.option("fracture_flexural_strength"))
        lines.append(Line(f"l = {size / h:g} h: 6 F L/(w h²) over the sheet's flexural strength",
                          ratios, None, settings["allowed"]))
        series.append((f"l = {size / h:g} h", [run.seed for run in drawn], ratios, None, "points"))
    seeds = [run.seed for run in runs]
    for edge in settings["allowed"]:
        series.append((f"published: {edge:g}", [min(seeds), max(seeds)], [edge, edge], None,
                       "line"))
    return Found(lines, "seed", "nominal strength over flexural strength", series)


def waves(runs, settings):
    """Amplitudes of heave and pitch of a floe over those of theory, by least squares over the last
    periods. settings: periods, allowed."""
    lines, series = [], {"heave": [], "pitch": []}
    for point, drawn in by_point(runs).items():
        ratios = {"heave": [], "pitch": []}
        for run in drawn:
            output = Output(run.folder)
            period, amplitude = run.option("waves_period"), run.option("waves_height") / 2
            wave = G * period**2 / (2 * np.pi)
            frequency = 2 * np.pi / period
            times = output.times[output.times > output.times[-1] - settings["periods"] * period]
            x, mass = output.position[:, 0], output.mass
            x = x - np.average(x, weights=mass)
            moved = np.array([output.field("bodies_displacement", t)[:, 2] for t in times])
            heave = moved @ mass / mass.sum()
            pitch = (moved - heave[:, None]) @ (mass * x) / (mass @ x**2)
            waves_of = np.column_stack([np.cos(frequency * times), np.sin(frequency * times),
                                        np.ones(len(times))])
            length = run.option("sheet_length")
            draft = run.option("sheet_thickness") * 920 / run.option("water_density")
            theory = thin_floe(length, wave, draft)
            for what, record, scale, expected in (
                    ("heave", heave, amplitude, theory[0]),
                    ("pitch", pitch, amplitude * 2 * np.pi / wave, theory[1])):
                fitted = np.linalg.lstsq(waves_of, record, rcond=None)[0]
                found = np.hypot(*fitted[:2]) / scale
                ratios[what].append(found / expected)
                series[what].append((wave / length, found, expected))
        for what in ratios:
            lines.append(Line(f"wave of {wave / length:.2g} lengths of the floe: {what} over "
                              "theory", ratios[what], 1.0, settings["allowed"]))
    drawn = []
    for what, rows in series.items():
        ratio, found, _ = map(list, zip(*sorted(rows)))
        drawn.append((what, ratio, found, None, "points"))
        fine = np.linspace(ratio[0], ratio[-1], 100)
        theory = [thin_floe(length, one * length, draft)[what == "pitch"] for one in fine]
        drawn.append((f"{what}, theory", list(fine), theory, None, "line"))
    return Found(lines, "wave's length over the floe's",
                 "amplitude, slope over the wave's", drawn)


def scaling(runs, settings):
    """Cauchy-Froude: forces over s^3 at times over sqrt(s) of scenes scaled by s. settings: scales
    {point: s}, base, obstacle, exact (largest relative difference), allowed."""
    points, lines, series = by_point(runs), [], []
    base = {run.seed: run for run in points.get(settings["base"], [])}
    if not base:
        raise BadInput(f"no run of the point {settings['base']} is finished")
    column = f"{settings['obstacle']}_mean_force_x"

    def impulse(run, scale):
        return run.column("time") * run.column(column) / scale**3.5

    first = next(iter(base.values()))
    series.append(("s = 1", list(first.column("time")),
                   list(first.column(f"{settings['obstacle']}_force_x") / 1e3), None, "line"))
    for point, scale in settings["scales"].items():
        before, whole, means, peaks, mean_of_base, peaks_of_base = [], [], [], [], [], []
        for run in points.get(point, []):
            if run.seed not in base:
                continue
            one = base[run.seed]
            n = min(len(run.history), len(one.history))
            a, b = impulse(one, 1)[:n], impulse(run, scale)[:n]
            apart = np.abs(a - b) / np.abs(a).max()
            broken = one.column("beams_broken")[:n] + run.column("beams_broken")[:n]
            until = int(np.argmax(broken > 0)) if broken.any() else n
            before.append(float(apart[:max(until, 1)].max()))
            whole.append(float(apart.max()))
            for kept, drawn, s in ((means, run, scale), (mean_of_base, one, 1)):
                kept.append(mean_force(drawn, settings["obstacle"])[0] / s**3)
            for kept, drawn, s in ((peaks, run, scale), (peaks_of_base, one, 1)):
                kept.append(low_passed(drawn, settings["obstacle"],
                                       {"filter": settings["filter"] / math.sqrt(s)})[0].max()
                            / s**3)
        if not before:
            continue
        lines.append(Line(f"s = {scale:g}: impulse until the first break, largest difference over "
                          "its largest", [max(before)], 0.0, [0.0, settings["exact"]]))
        lines[-1].seeds = len(before)
        exact = max(whole) <= settings["exact"]
        lines.append(Line(f"s = {scale:g}: the same, whole run", [max(whole)], 0.0 if exact else
                          None, [0.0, settings["exact"]] if exact else None))
        lines[-1].seeds = len(before)
        for what, here, there in (("mean force", means, mean_of_base),
                                  ("peak", peaks, peaks_of_base)):
            if len(here) > 1:
                here, there = np.array(here), np.array(there)
                error = np.hypot(stats.sem(here) / here.mean(), stats.sem(there) / there.mean())
                half = stats.t.ppf(0.5 + LEVEL / 2, 2 * len(here) - 2) * error
                line = Line(f"s = {scale:g}: {what} over s³ over that of s = 1, means of seeds",
                            [here.mean() / there.mean()], 1.0, [1.0, 1.0], half=float(half),
                            by_band=True)
                line.seeds = len(here)
                lines.append(line)
        run = points[point][0]
        series.append((f"s = {scale:g}, scaled", list(run.column("time") / math.sqrt(scale)),
                       list(run.column(f"{settings['obstacle']}_force_x") / scale**3 / 1e3), None,
                       "line"))
    return Found(lines, "time over √s [s]", "force over s³ [kN]", series)


def scatter(runs, settings):
    """Coefficients of variation of mean and peak over seeds, sheets with strengths that scatter
    over homogeneous ones, with bootstrap bands. settings: points [homogeneous, scattered],
    obstacle, filter, start."""
    points, lines, series = by_point(runs), [], []
    found = {}
    for point in settings["points"]:
        drawn = points.get(point, [])
        if len(drawn) < 5:
            raise BadInput(f"fewer than 5 runs of {point} are finished")
        records = [low_passed(run, settings["obstacle"], settings)[0] for run in drawn]
        found[point] = {"mean": np.array([record.mean() for record in records]),
                        "peak": np.array([record.max() for record in records])}
        ordered = np.sort(found[point]["peak"]) / 1e3
        series.append((point, list(ordered), list((np.arange(len(ordered)) + 0.5) / len(ordered)),
                       None, "points"))
    generator = np.random.default_rng(SEED)

    def variation(values, axis=-1):
        return values.std(axis=axis, ddof=1) / values.mean(axis=axis)
    one, other = settings["points"]
    for what in ("mean", "peak"):
        drawn = [generator.choice(values, (DRAWS, len(values)))
                 for values in (found[one][what], found[other][what])]
        drawn = np.array([variation(one) for one in drawn])
        drawn = drawn[:, np.all(drawn > 0, axis=0)]  # without draws of one run only
        ends = np.quantile(np.log(drawn[1] / drawn[0]), [0.5 - LEVEL / 2,
                                                         0.5 + LEVEL / 2])
        ratio = variation(found[other][what]) / variation(found[one][what])
        for point in settings["points"]:
            line = Line(f"{what}, {point}: variation over seeds", [variation(found[point][what])])
            line.seeds = len(found[point][what])
            lines.append(line)
        line = Line(f"{what}: variation of {other} over that of {one}", [ratio], 1.0, [1.0, 1.0],
                    half=float(ratio * (np.exp((ends[1] - ends[0]) / 2) - 1)), by_band=True)
        line.seeds = min(len(values[what]) for values in found.values())
        lines.append(line)
        line = Line(f"{what}: mean of {other} over that of {one}",
                    [found[other][what].mean() / found[one][what].mean()])
        line.seeds = lines[-1].seeds
        lines.append(line)
    return Found(lines, "peak of a run [kN]", "share of the runs below", series)


def punch(runs, settings):
    """Mean upward force on a plate in rubble over the last part of its way, over the net buoyancy
    of the blocks that move down with it. settings: last [s], allowed."""
    ratios, forces, moving, curves = [], [], [], []
    for run in runs:
        output = Output(run.folder)
        end = float(output.times[-1])
        force = -mean_force(run, "plate", end - settings["last"], end)[2]
        speed = abs(run.option("obstacle_plate_velocity")[2])
        frames = output.times[output.times >= end - settings["last"] - 1e-6]
        down = -(output.field("bodies_displacement", frames[-1])
                 - output.field("bodies_displacement", frames[0]))[:, 2]
        moves = down > 0.5 * speed * (frames[-1] - frames[0])
        net = G * (output.mass[moves] / 920 * RHO_WATER - output.mass[moves]).sum()
        forces.append(abs(force))
        moving.append(int(moves.sum()))
        ratios.append(abs(force) / net)
        table = floe_loads.read_run(run.folder)
        record = np.abs(floe_signals.Filter("mean", length=1.0).apply(table.forces["plate"],
                                                                      table.dt)[2])
        curves.append((np.arange(len(record)) * table.dt + 0.5, record))
    lines = [Line("residual force over the buoyancy of the blocks that move", ratios, 1.0,
                  settings["allowed"]),
             Line("residual force", forces, unit="N"), Line("blocks that move", moving)]
    series = [("seeds" if k == 0 else "", list(t), list(record / 1e3), None, "line")
              for k, (t, record) in enumerate(curves[:5])]
    return Found(lines, "time [s]", "force on the plate, mean of 1 s [kN]", series)


def ridging(runs, settings):
    """Mean force per width on the held end after the start, by rows, against thickness; its work
    over the gain of potential energy. settings: start [s], published_ratio, allowed_ratio."""
    forces, ratios = {}, {}
    for point, drawn in by_point(runs).items():
        for run in drawn:
            time, force = run.column("time"), np.abs(run.column("hold_force_x"))
            way = run.column("push_displacement_x")
            late = time >= settings["start"]
            h = run.option("sheet_thickness")
            forces.setdefault(h, {})[run.seed] = force[late].mean() / run.option("sheet_width")
            potential = run.column("energy_gravity") + run.column("energy_water")
            ratios.setdefault(h, []).append(np.trapz(force, way) / (potential[-1] - potential[0]))
    thickness = sorted(forces)
    seeds = sorted(set.intersection(*(set(found) for found in forces.values())))
    exponents = [slope_of(thickness, [forces[h][seed] for h in thickness]) for seed in seeds]
    lines = [Line("exponent of thickness in the force per width", exponents, 1.0, [1.0, 1.0],
                  by_band=True)]
    for h in thickness:
        lines.append(Line(f"h = {h:g} m: mean force per width", list(forces[h].values()),
                          unit="N/m"))
        lines.append(Line(f"h = {h:g} m: work over the gain of potential energy", ratios[h],
                          settings["published_ratio"], settings["allowed_ratio"]))
    means = [mean_and_band(list(forces[h].values())) for h in thickness]
    linear = means[0][0] / thickness[0]
    series = [("floe", thickness, [m / 1e3 for m, _ in means], [b / 1e3 for _, b in means],
               "points"), ("linear in h", thickness, [linear * h / 1e3 for h in thickness], None,
                           "line")]
    return Found(lines, "thickness [m]", "mean force per width [kN/m]", series, log="xy")


def wide(runs, settings):
    """Peaks per width of cones against their width over thickness, over that of the narrowest,
    beside the same of ISO's load of bare ice. settings: obstacle, angle, filter, start, allowed."""
    found = {}
    for point, drawn in by_point(runs).items():
        for run in drawn:
            name = settings["obstacle"]
            base, top = run.option(f"obstacle_{name}_radius"), run.option(
                f"obstacle_{name}_top_radius")
            height = run.option(f"obstacle_{name}_height")
            foot = run.option(f"obstacle_{name}_base")[2]
            width = 2 * (base + (top - base) * -foot / height)
            angle = float(np.degrees(np.arctan2(height, base - top)))
            record, _ = low_passed(run, name, settings)
            h = run.option("sheet_thickness")
            iso_load = iso_slope(h, width, angle, run.option(f"obstacle_{name}_friction"),
                                 run.option("fracture_flexural_strength"), run.option("ice_young"))
            found.setdefault(round(width, 6), []).append(
                (record.max() / width, record.mean() / width, record.std() / record.mean(),
                 iso_load["H"] / width))
    widths, lines = sorted(found), []
    narrow = np.array(found[widths[0]])
    for width in widths:
        values = np.array(found[width])
        what = f"D/h = {width / h:.0f}"
        lines.append(Line(f"{what}: peak per width", list(values[:, 0]), unit="N/m"))
        lines.append(Line(f"{what}: deviation over mean, in time", list(values[:, 2])))
        if width > widths[0]:
            ratio = values[:, 0].mean() / narrow[:, 0].mean()
            theory = values[0, 3] / narrow[0, 3]
            many = min(len(values), len(narrow))
            half = 0.0
            if many > 1:
                error = math.hypot(stats.sem(values[:, 0]) / values[:, 0].mean(),
                                   stats.sem(narrow[:, 0]) / narrow[:, 0].mean())
                half = float(ratio * error * stats.t.ppf(0.5 + LEVEL / 2, 2 * many - 2))
            line = Line(f"{what}: peak per width over that of D/h = {widths[0] / h:.0f}",
                        [ratio], theory, [theory * one for one in settings["allowed"]], half=half)
            line.seeds = many
            lines.append(line)
    x = [width / h for width in widths]
    columns = [[mean_and_band(np.array(found[width])[:, k]) for width in widths] for k in (0, 1)]
    series = [(label, x, [m / 1e3 for m, _ in column], [b / 1e3 for _, b in column], "points")
              for label, column in zip(("peaks", "means"), columns)]
    series.append(("ISO, bare ice", x, [found[width][0][3] / 1e3 for width in widths], None,
                   "line"))
    return Found(lines, "D/h", "force per width [kN/m]", series, log="xy")


MEASURES = {"iso": iso, "crushing": crushing, "buckling": buckling,
            "slope_failure": slope_failure, "uplift": uplift, "cantilever": cantilever,
            "waves": waves, "scaling": scaling, "scatter": scatter, "punch": punch,
            "ridging": ridging, "wide": wide}
