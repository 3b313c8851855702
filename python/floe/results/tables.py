"""Tables of a run, as pandas reads them, and the units of their columns."""
import io
import re
from pathlib import Path

from floe.errors import InputError, reading
from floe.results.output import rows_of

# By the ends of columns' names, the first that fits; as CF writes units.
UNITS = ((r"^time$", "s"), (r"^energy_", "J"), (r"^mass_", "kg"), (r"^momentum_", "kg m s-1"),
         (r"_force_[xyz]$", "N"), (r"_moment_[xyz]$", "N m"), (r"_velocity_[xyz]$", "m s-1"),
         (r"_spin_[xyz]$", "rad s-1"), (r"_rotation_[xyz]$", "rad"), (r"_r[xyz]$", "rad"),
         (r"_[xyz]$", "m"), (r"_tension$", "N"), (r"_length$", "m"))


def unit_of(column: str) -> str:
    """Unit of a column of history.csv; 1 of numbers of things and ratios."""
    return next((unit for pattern, unit in UNITS if re.search(pattern, column)), "1")


def whole_lines(path: str | Path) -> io.StringIO:
    """A text file, of a run that is under way without a last line that is not whole yet."""
    text = Path(path).read_text()
    return io.StringIO(text[:text.rfind("\n") + 1])


def table_of(path: str | Path, **options):
    """A CSV file as a pandas.DataFrame, numbers to the last bit; options: of pandas.read_csv.
    InputError where it is not there, or is none."""
    import pandas
    with reading(path):
        return pandas.read_csv(whole_lines(path), float_precision="round_trip", **options)


def history(folder: str | Path):
    """history.csv as a pandas.DataFrame of numbers with the time [s] as a column."""
    path = Path(folder) / "history.csv"
    if not path.exists() and Path(folder).is_dir():
        raise InputError(f"{folder}: has no history.csv yet")
    try:
        table = table_of(path, dtype=float)
        whole = not table.isna().to_numpy().any()
    except InputError:
        whole = False
    if not whole:
        rows_of(folder)  # says which line is wrong; one that holds nan is not
        table = table_of(path, dtype=float)
    return table


def obstacles_of(columns) -> list[str]:
    """Names of the obstacles in a history: those with a peak force."""
    return [name.removesuffix("_peak_force_x") for name in columns
            if name.endswith("_peak_force_x")]
