"""What the commands share: options, output files, exit codes, console, processes."""
