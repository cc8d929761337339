"""A URDF file before it is a robot: sources, xacro, the XML tree, its elements and numbers."""
