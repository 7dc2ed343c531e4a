"""Where effects are tried beside a model: scored, fitted in full, and what residuals hold."""
