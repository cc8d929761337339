"""The study of identification methods: many simulated recordings, every method on each of them, the errors of all."""
