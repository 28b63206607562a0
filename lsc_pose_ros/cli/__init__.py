"""The command line: parses words, calls the layer below, prints."""
