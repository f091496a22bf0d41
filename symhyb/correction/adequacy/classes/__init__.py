"""Generic rivals: whole classes of effects, none of which is a law by name. One file each.

A class is a set of columns (forces at a place, along an input, or parts of what a sensor shows)
whose coefficients have a Gaussian prior of the size of what acts there. It competes by the same
evidence as any named cause: a named law has to beat the class that it belongs to, and where it does
not, the class is the answer. The columns follow the measured motion.
"""
