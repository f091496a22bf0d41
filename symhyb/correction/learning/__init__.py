"""What learns a force: sparse regression, networks and smooth remainders, and what bounds them."""
