"""What tests of a rig would tell of its damping, before any is made."""
