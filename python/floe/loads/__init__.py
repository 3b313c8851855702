"""Statistics of the forces on obstacles. SI units."""
