"""The innovations likelihood: one Kalman pass over a linearised recording."""
