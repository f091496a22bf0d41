"""Exact runs: friction that holds, stops that touch, jumps, every transition located."""
