"""Course scenes as Mitsuba scene dictionaries.

`scene_description` gives the dictionary, without loading Mitsuba: each element of a scene by a pure function in its own
module. Its leaves are numbers, strings and lists, but for meshes and textures, which are this project's own data:
`load` turns them into Mitsuba's objects in memory, `export` into files beside a `scene.xml`. Both give the same
picture.
"""
