"""Programs that have a machine, asked for its masses, forces and slopes: an FMU, MuJoCo."""
