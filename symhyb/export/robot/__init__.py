"""What was found, written into the robot's own file."""
