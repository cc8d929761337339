"""What the tables of a study say of the methods: intervals, ranks and tests."""
