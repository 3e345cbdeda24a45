"""How much two pictures, or two ray trees, of the same scene differ."""
