"""Readers of output folders: one file of a run each. SI units."""
