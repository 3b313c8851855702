"""Motion of structures, from history.csv."""
import dataclasses

import numpy as np

from floe.errors import InputError

COMPONENTS = ("x", "y", "z", "rx", "ry", "rz")
LEAST = 16  # rows of which a spectrum is made


@dataclasses.dataclass
class Motion:
    """A component of the motion of a structure, at the rows of history.csv."""
    structure: str
    component: str
    time: np.ndarray          # (n) [s]
    displacement: np.ndarray  # (n) [m] or rotation [rad]
    velocity: np.ndarray      # (n) [m/s, rad/s]

    @property
    def unit(self):
        """Of the displacement: m or rad."""
        return "m" if len(self.component) == 1 else "rad"

    @property
    def acceleration(self):
        """Differences of the velocities: rows must be close against the periods of interest."""
        return np.gradient(self.velocity, self.time)

    def spectrum(self):
        """Frequencies [Hz] and power density of the velocity: Welch's method with Hann windows of a
        quarter of the time, at even times."""
        from scipy.signal import welch
        even = np.linspace(self.time[0], self.time[-1], len(self.time))
        each = max(len(self.time) // 4, min(len(self.time), 64))
        return welch(np.interp(even, self.time, self.velocity), 1 / (even[1] - even[0]),
                     nperseg=each)

    def largest(self):
        """Largest displacement, velocity and acceleration, and the frequency [Hz] that has most of
        the spectrum."""
        frequency, density = self.spectrum()
        return {"displacement": np.abs(self.displacement).max(),
                "velocity": np.abs(self.velocity).max(),
                "acceleration": np.abs(self.acceleration).max(),
                "frequency": frequency[np.argmax(density)]}


def structures(table):
    """Names of the structures: those with a velocity."""
    return [name.removesuffix("_velocity_x") for name in table if name.endswith("_velocity_x")]


def read(table, structure=None, component=None, start=0.0):
    """The Motion of a structure (None: the first), of a component (None: the one of x, y and z that
    moves most), from a time on [s]. table: run.history. InputError if there is none of it."""
    names = structures(table)
    if not names:
        raise InputError("the scene has no structures (obstacles with a mass)")
    name = structure or names[0]
    if name not in names:
        raise InputError(f"structure {name}: must be one of {', '.join(names)}")
    if component is not None and component not in COMPONENTS:
        raise InputError(f"component '{component}' is none of {', '.join(COMPONENTS)}")
    table = table[table.index >= start]
    if len(table) < LEAST:
        raise InputError(f"start {start:g}: leaves {len(table)} rows of history.csv, fewer than "
                         f"{LEAST}")
    chosen = component or max(COMPONENTS[:3], key=lambda c: np.ptp(table[f"{name}_{c}"].to_numpy()))
    rate = f"{name}_velocity_{chosen}" if len(chosen) == 1 else f"{name}_spin_{chosen[1]}"
    return Motion(name, chosen, table.index.to_numpy(), table[f"{name}_{chosen}"].to_numpy(),
                  table[rate].to_numpy())
