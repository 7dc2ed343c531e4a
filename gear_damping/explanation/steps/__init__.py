"""The steps of a search, none of which knows another."""
