"""Equations of motion as sums of named terms, batched, in pure torch."""
