"""The files of a recording: MCAP, SQLite, and metadata.yaml."""
