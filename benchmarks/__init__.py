"""Simulation, wavelet transform and training beside other libraries: `make bench`."""
