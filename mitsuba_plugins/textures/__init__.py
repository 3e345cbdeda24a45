"""Pigments as Mitsuba textures."""
