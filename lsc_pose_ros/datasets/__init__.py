"""Importers of public data sets as labelled frames."""
