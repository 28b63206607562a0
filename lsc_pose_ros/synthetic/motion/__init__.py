"""Poses and motion by rule, within what joints allow."""
