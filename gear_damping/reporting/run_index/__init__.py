"""The index of all runs: one page with a table that sorts."""

from gear_damping.reporting.run_index.page import IndexRow, index_page

__all__ = ["IndexRow", "index_page"]
