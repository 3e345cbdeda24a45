"""A small scalar tracer with the mistakes of students, each a switch: draws what their programs draw.

It shares no code with `native_tracer`. With no switch set it draws the same pictures, and so is an opinion of its own.
The table of mistakes, and what each is called, is `src/deviations.def`.
"""

from student_tracer._student import Scene, deviations, levels, shows, trace, trace_pixel

__all__ = ["Scene", "deviations", "levels", "shows", "trace", "trace_pixel"]
