"""Course scenes to pictures: the format's parser, both renderers' drivers, their comparison and the command line."""
