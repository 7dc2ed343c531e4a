"""One small reader per file format, found by the suffix of the file."""
