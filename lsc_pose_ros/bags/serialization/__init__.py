"""Serialised messages (CDR) to plain values and back."""
