"""The exception for inputs that cannot be used."""


class InputError(Exception):
    """A file, topic, parameter or argument cannot be used.

    The message is one sentence that names the input and says what to do. The command line prints
    it and ends with status 2; the node logs it.
    """
