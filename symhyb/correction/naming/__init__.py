"""From a believed structure to elements, numbers with deviations, and words."""
