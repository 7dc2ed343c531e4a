"""The bases that effects are added to: `gear_pair` and `oscillator`."""
