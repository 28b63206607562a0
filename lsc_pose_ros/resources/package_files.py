"""Finds the files that come with the package: configuration, models, the body."""

from importlib.resources import files
from pathlib import Path

from lsc_pose_ros.errors import InputError

PACKAGE = 'lsc_pose_ros'
RESOURCES = f'{PACKAGE}.resources'

DEFAULT_MODEL = 'default'
"""The model of the package that is used where none is named."""


def resource(*parts: str) -> Path:
    """Return the path of a file of the package, e.g. `resource('config', 'pose_node.yaml')`.

    Raises:
        InputError: the file is not there.
    """
    path = _folder().joinpath(*parts)
    if path.exists():
        return path
    msg = f'{"/".join(parts)} is not installed with {PACKAGE}; install the package again'
    raise InputError(msg)


def _folder() -> Path:
    # The package is installed as files (zip_safe=False), so that this is a folder.
    return Path(str(files(RESOURCES)))


def default_model() -> Path:
    """Return the path of the model that comes with the package.

    Raises:
        InputError: none does.
    """
    try:
        return resource('models', f'{DEFAULT_MODEL}.npz')
    except InputError as error:
        msg = (
            f'no model comes with this {PACKAGE}; '
            'give the path of one that `lsc_pose train` has made'
        )
        raise InputError(msg) from error


def shipped_models() -> dict[str, Path]:
    """Return the models that come with the package, by name: the file's without its suffix."""
    return {path.stem: path for path in sorted((_folder() / 'models').glob('*.npz'))}


def find_model(name: str | Path = '') -> Path:
    """Return the path of the model that a user calls `name`.

    Args:
        name: a path; or the bare name of a model that comes with the package, such as 'default';
            or empty, for that one.

    Raises:
        InputError: a bare name is neither a file nor a model of the package, or no model comes
            with the package.
    """
    word = str(name)
    if not word:
        return default_model()
    path = Path(word)
    # What looks like a path is left to the reader of model files, who says what is wrong with it.
    if path.is_file() or path.suffix or len(path.parts) != 1:
        return path
    models = shipped_models()
    if word in models:
        return models[word]
    known = f'its models are {", ".join(models)}' if models else 'no model does'
    msg = f'there is no model file {word}, and no model {word} comes with {PACKAGE}: {known}'
    raise InputError(msg)
