"""Files of measured data become records here: the only door that they come in by."""
