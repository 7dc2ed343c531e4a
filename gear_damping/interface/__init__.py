"""What `import gear_damping as gd` offers: the nouns of the field, and what can be done with them."""
