"""Courses: how a number that changes along recordings runs over the time.

The class says that a number changes. Where a step, a drift, a period or a line through points that
the data place explains as much as the class, it is the answer, with its band.
"""
