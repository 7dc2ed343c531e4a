"""The figures by name."""
from gear_damping.reporting.style import new_figure
def figure(name, study): return new_figure()
