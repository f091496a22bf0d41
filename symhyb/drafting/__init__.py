"""A first model file: from a template or from coordinates, with the columns of a recording."""
