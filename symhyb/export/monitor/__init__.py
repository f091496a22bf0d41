"""A monitor in C: what ``symhyb watch`` does, for targets without Python."""
