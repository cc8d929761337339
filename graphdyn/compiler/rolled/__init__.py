"""Programs of long robots: the step of one body, recorded once for every kind of body and run for body after body."""
