"""What is looked at first: rest, modes, response, energy, timing, repeats, faults of recordings."""
