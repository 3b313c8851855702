"""Theory and statistics of whole sheets to set beside runs. SI units."""
