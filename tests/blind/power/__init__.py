"""How small an effect is still seen and named, beside how small anybody could see and name it."""
