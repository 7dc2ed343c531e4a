"""One look for every page that a run leaves: template, style, pictures and tables, all of it inside the file."""
