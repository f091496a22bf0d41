"""Numbers, units, effects and verdicts as an engineer would say them."""
