"""What is wrong with a function although its formulas are right: differences, solvers, limits, batches, joints."""
