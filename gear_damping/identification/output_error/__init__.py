"""Parameters from a record by output error: the simulator itself is fitted to what was measured."""
