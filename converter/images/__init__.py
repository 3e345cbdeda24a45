"""Image files: textures read, pictures written."""
