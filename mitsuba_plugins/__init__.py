"""Mitsuba 3 plugins that reproduce the course's shading model: textures, a BSDF, an emitter, a sensor, an integrator.

    import mitsuba
    import mitsuba_plugins

    mitsuba_plugins.set_variant("auto")
    image = mitsuba.render(mitsuba.load_file("scene.xml", optimize=False))

Importing this package is cheap and loads neither Mitsuba nor LLVM; `set_variant` and `register` do.
"""

from mitsuba_plugins.backend import BackendError, register, set_variant

__all__ = ["BackendError", "register", "set_variant"]
