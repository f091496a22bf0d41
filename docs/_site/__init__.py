"""What the site is built with, beside Sphinx: contents, generated references, checks."""
