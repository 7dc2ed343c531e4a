"""Many jobs over one table: their folder, who works on which job, what is seen of them, and what they add up to."""
