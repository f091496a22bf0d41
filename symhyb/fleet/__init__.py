"""Many units of one kind: what they have in common, how they differ, and which deviate."""
