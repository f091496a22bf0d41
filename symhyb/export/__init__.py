"""A correction, or a whole model, for other programs: C, FMU, LaTeX and Adams source."""
