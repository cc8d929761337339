"""What a robot looks like: boxes, cylinders, spheres and mesh files as triangles."""
