"""One file for each library that is measured; each imports its library alone."""
