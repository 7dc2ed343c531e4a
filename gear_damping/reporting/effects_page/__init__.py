"""The page docs/effects.md: every effect from its declaration, with its signature from a real run."""
