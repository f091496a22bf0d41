"""Own curves: the answer where a force of stretch or of rate acts that no listed law is.

The class says that such a force acts at a place. Where one of the stretch alone, or of the rate
alone, explains as much as the class, it is a characteristic curve, whose points the data place.
"""
