"""Functions over many samples: without copies, compiled, kept; least squares by blocks."""
