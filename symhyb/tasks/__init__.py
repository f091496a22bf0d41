"""Many diagnoses of one study: the tasks of its sweep, how they are run, and what came out."""
