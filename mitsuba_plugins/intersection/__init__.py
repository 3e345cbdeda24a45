"""What a ray hits, and where: the exact surfaces of a scene, and the ways in which they are searched."""
