"""Typed schema of every configuration group, and one check that collects every problem."""
