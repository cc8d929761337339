"""User code in any language: programs that answer lines, C functions in shared libraries, files of answers."""
