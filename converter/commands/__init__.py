"""The command line: one file a sub-command of `whitted`, and `raytrace`, the program that the course asks for."""
