"""From a selected structure to elements, numbers with deviations, and words."""
