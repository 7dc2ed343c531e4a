"""Solving the equation of motion: the only room that imports torchdiffeq."""
