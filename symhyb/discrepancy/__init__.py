"""Where model and recording differ: motion, ΔF, scores, places and named hypotheses."""
