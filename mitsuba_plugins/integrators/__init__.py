"""Whitted ray tracing as a Mitsuba integrator, and the ways in which it finds what a ray hits."""
