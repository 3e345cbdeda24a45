"""Cameras as Mitsuba sensors."""
