"""Trains a model from labelled frames."""
