"""Pixels whose bytes are proven: what the tracer of intervals is told of a scene, and what it finds."""
