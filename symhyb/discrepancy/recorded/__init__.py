"""A recording made ready: its motion, what acts along it, windows, and ΔF."""
