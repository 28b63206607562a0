"""The argument --model, the same for every command that estimates."""

import argparse


def add_model_argument(group: argparse._ActionsContainer, otherwise: str = '') -> None:
    """Add --model to `group`; `find_model` understands what it holds.

    Args:
        group: a parser or a group of arguments.
        otherwise: what is said, beside the default, in the help.
    """
    default = '; '.join(filter(None, ['default: the one that comes with the package', otherwise]))
    group.add_argument(
        '--model',
        default='',
        metavar='MODEL',
        help='a model that `train` wrote, or the name of one that comes with the package '
        f'({default})',
    )
