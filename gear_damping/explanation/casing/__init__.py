"""What an accelerometer on the casing of a gear pair says: findings by angle and order, no cause."""
