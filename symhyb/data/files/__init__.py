"""Files of loggers: a path in, named columns out, one reader a format."""
