"""What the command prints and shows, section by section."""
