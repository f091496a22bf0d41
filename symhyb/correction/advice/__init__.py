"""What to record next: what cannot be distinguished, and the manoeuvre or sensor that would."""
