"""Plays recordings onto the wire and collects what is published."""
