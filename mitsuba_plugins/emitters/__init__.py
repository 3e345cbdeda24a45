"""Lights as Mitsuba emitters."""
