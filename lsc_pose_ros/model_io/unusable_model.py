"""The exception for model files whose content cannot be used."""


class UnusableModelError(ValueError):
    """A part of a model is wrong; the message says which, and is put in brackets."""
