"""What the scripts of this folder make scenes of."""
