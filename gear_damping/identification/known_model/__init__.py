"""Estimators that know the equation of the runs: what is left for data alone to tell is the damping and the start."""
