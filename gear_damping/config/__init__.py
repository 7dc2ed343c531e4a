"""From YAML and command line to checked settings: every problem at once, each with its remedy."""
