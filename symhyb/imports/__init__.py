"""Models from files of other programs: one module for each format, one writer for all."""
