"""The model that is held against the records, and what may be added to it."""
