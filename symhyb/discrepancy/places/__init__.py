"""Where something is missing, and what could be: the map of the mismatch and the hypotheses."""
