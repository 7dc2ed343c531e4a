"""What is said of a search: figures, tables and the content of explanation.json."""
