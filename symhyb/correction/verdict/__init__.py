"""What is claimed and what is refused, proven on unseen recordings."""
