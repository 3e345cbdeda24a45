"""Pictures without rounding: a small tracer that decides every tie by the format's rules."""
