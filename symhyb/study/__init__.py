"""Studies as files: what a study.toml states, one diagnosis of it, and its files."""
