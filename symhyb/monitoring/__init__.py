"""A model that runs beside its machine: whether something has changed since, when, what, and by how
much.

A stretch of the source is the reference: the machine as it is. From then on the source is cut into
blocks, each of which is reduced as a diagnosis reduces windows: what the model leaves, and what
every cause would do to that. A sequential test says whether a cause acts otherwise than in the
reference, and which one explains it best.
"""
