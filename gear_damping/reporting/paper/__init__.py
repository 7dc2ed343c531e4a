"""The figures and tables of Yousfi et al. (2026), printed beside repeated."""
