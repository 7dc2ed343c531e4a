"""What was measured, in the roles that the explanation gives it, with its noise."""
