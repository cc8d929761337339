"""What a command finds, for the pipelines of others: SARIF and JUnit files, baselines, waivers."""
