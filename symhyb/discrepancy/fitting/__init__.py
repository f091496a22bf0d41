"""Trajectories matched to windows, and the scores that models are judged by."""
