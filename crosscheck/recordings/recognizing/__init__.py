"""Recognition of what the columns of a log are: by names, by how they move together, and against the robot."""
