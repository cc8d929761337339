"""Virtual recordings, with every channel of joints and bodies, in CSV and Parquet files."""
