"""Whitted ray tracing as a Mitsuba integrator."""
