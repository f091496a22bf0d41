"""What to record next: what cannot be told apart, and the manoeuvre or sensor that would."""
