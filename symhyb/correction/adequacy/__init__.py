"""Whether what was decided is good enough: what acts beyond it, and of which class that is."""
