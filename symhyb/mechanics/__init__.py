"""Mechanics in SymPy: kinematics, force laws and equations of motion, never simplified."""
