"""What the checks of several subjects read from a run."""
import csv

import h5py

from launch import FULL


def short(*options):
    """Options that shorten a run, in the short form of the tests."""
    return () if FULL else options


def last_row(output):
    """Last row of history.csv as {column: number}."""
    with open(output.folder / "history.csv", newline="") as file:
        return {key: float(value) for key, value in list(csv.DictReader(file))[-1].items()}


def breaks(output, name):
    with h5py.File(output.folder / "breaks.h5") as file:
        return file[name][:]
