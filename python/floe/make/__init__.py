"""What makes lattices, outlines, hulls and tables for scenes. SI units."""
