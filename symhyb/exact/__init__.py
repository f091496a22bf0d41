"""Exact runs: dry friction that holds, stops that touch, every transition located."""
