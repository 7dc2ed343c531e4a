"""task=paper: the figures and tables of Yousfi et al. (2026), printed beside repeated."""

from gear_damping.tasks.paper.study import run

__all__ = ["run"]
