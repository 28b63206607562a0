"""Public data sets, read as labelled frames."""
