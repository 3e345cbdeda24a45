"""Finishes as Mitsuba BSDFs."""
