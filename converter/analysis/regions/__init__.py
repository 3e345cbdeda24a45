"""Regions of scenes in which methods are known to fail: where they begin is what `whitted stability` measures."""
