"""The one exception that means: what the user gave cannot be used."""


class InputError(Exception):
    """A file, topic, parameter or argument cannot be used.

    The message is one sentence that names the culprit and says what to do. The command line
    prints it and ends with status 2; the node logs it.
    """
