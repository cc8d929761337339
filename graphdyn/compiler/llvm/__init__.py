"""LLVM code of a program: vectors with one sample per lane, aligned memory."""
