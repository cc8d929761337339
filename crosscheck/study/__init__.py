"""The study of identification methods: many simulated recordings, every method on each, and the errors of all."""
