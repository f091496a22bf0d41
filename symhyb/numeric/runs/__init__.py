"""Simulation: whole runs, exact runs with events, windows, and how they depend on numbers."""
