"""Course scenes in POV-Ray's language, version 3.7.

`povray_scene` gives the text, the textures it names and a list of what POV-Ray cannot express: each element of a scene
by a pure function in its own module. `export_povray` writes them to files.
"""
