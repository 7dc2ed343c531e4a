"""Measured against simulated: calibrate, find what is missing, name it, extend, measure the gain."""
