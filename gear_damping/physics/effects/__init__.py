"""One file an effect: its equation, parameters, bounds and reference."""
