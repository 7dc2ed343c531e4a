"""The linear oscillator from measured records."""
