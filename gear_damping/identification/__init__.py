"""Damping from signals: learned estimators, classical estimators and the limits of information."""
