"""From mismatch to model: candidate forces screened, fitted on trajectories, applied."""
