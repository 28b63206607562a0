"""Model files: numpy arrays and a page of JSON in a zip archive, nothing that can run.

The file is what `numpy.savez_compressed` writes, read with `allow_pickle=False`. How the forest is
put in it is told in `compact_forest.py`; versions 1 and 2 had its arrays as they are in memory.
"""

import json
import os
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.model_io.forest_packing import ARRAYS as FOREST_ARRAYS
from lsc_pose_ros.model_io.forest_packing import Form, pack_forest, unpack_forest
from lsc_pose_ros.model_io.model_check import (
    UnusableModelError,
    check_model,
    read_provenance,
    read_settings,
)
from lsc_pose_ros.pose.forest.forest import Forest, LeafVotes
from lsc_pose_ros.pose.inference.confidence import uncalibrated
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.resources.package_files import find_model

FORMAT = 'lsc_pose model'
VERSION = 3
# Version 1 knows only the paper's feature, and its confidence is the share of the votes; the
# settings that it lacks have their defaults.
_READ = (1, 2, VERSION)

# A model of hundreds of megabytes is no model of ours, but a zip bomb.
LARGEST_ARRAY = 1 << 30

_SKELETON: dict[str, Form] = {
    'joints': (np.uint16, 1),
    'edges': (np.int32, 2),
    'limb_lengths': (np.float32, 1),
}
_OLD_FOREST: dict[str, Form] = {
    'roots': (np.int32, 1),
    'feature': (np.int16, 1),
    'threshold': (np.uint8, 1),
    'left': (np.int32, 1),
    'joint_start': (np.int32, 1),
    'joint_target': (np.uint8, 1),
    'joint_offset': (np.float16, 2),
    'joint_weight': (np.float16, 1),
    'pair_start': (np.int32, 1),
    'pair_target': (np.uint8, 1),
    'pair_offset': (np.float16, 2),
    'pair_weight': (np.float16, 1),
}
# Models whose confidence is not calibrated lack it.
_CALIBRATION = 'calibration'
_CALIBRATION_FORM: Form = (np.float32, 2)


def save_model(path: str | os.PathLike[str], model: Model) -> None:
    """Write `model` to `path`, beside it first and then renamed.

    Raises:
        InputError: the file cannot be written.
    """
    target = Path(path)
    beside = target.with_name(f'.{target.name}.{os.getpid()}.part')
    header = {
        'format': FORMAT,
        'version': VERSION,
        'settings': model.settings._asdict(),
        'provenance': model.provenance,
    }
    arrays: dict[str, Any] = {
        'joints': model.joints,
        'edges': model.edges,
        'limb_lengths': model.limb_lengths,
        **({_CALIBRATION: model.calibration} if len(model.calibration) else {}),
        **pack_forest(model.forest),
    }
    try:
        with beside.open('wb') as file:
            np.savez_compressed(file, header=_to_bytes(header), **arrays)
        beside.replace(target)
    except OSError as error:
        msg = f'cannot write the model {target}: {error.strerror or error}'
        raise InputError(msg) from error
    finally:
        beside.unlink(missing_ok=True)


def load_model(model: str | os.PathLike[str]) -> Model:
    """Return the model in a file, or a model that comes with the package.

    Args:
        model: the path of a model file, or the name of a model of the package: 'default' or
            'front'. A file takes precedence over a model of the package with the same name.

    Raises:
        InputError: there is no such file or name, the file is no model, it has another version,
            or its parts do not fit together.
    """
    source = find_model(os.fspath(model))
    try:
        _check_sizes(source)
        with np.load(source, allow_pickle=False) as archive:
            header = _read_header(source, archive)
            old = header['version'] < VERSION
            forms = _SKELETON | (_OLD_FOREST if old else FOREST_ARRAYS)
            if _CALIBRATION in archive:
                forms |= {_CALIBRATION: _CALIBRATION_FORM}
            arrays = {
                name: _read_array(source, archive, name, form) for name, form in forms.items()
            }
    except FileNotFoundError as error:
        msg = f'there is no model file {source}; make one with `lsc_pose train`'
        raise InputError(msg) from error
    except InputError:
        raise
    except Exception as error:  # numpy lets through whatever a damaged file makes it stumble on
        raise _wrong(source, str(error) or type(error).__name__) from error
    try:
        forest = _old_forest(arrays) if old else unpack_forest(arrays)
        return _assemble(header, arrays, forest)
    except UnusableModelError as error:
        raise _wrong(source, str(error)) from error


def describe_model(model: Model) -> dict[str, str]:
    """Return what there is to say of a model, in order, for people to read."""
    forest = model.forest
    leaves = len(forest.joint_votes.start) - 1
    return {
        'joints': ', '.join(names_of(model.joints)),
        'trees': str(len(forest.roots)),
        'nodes': str(len(forest.feature)),
        'leaves': str(leaves),
        'joint votes': str(len(forest.joint_votes.target)),
        'pair votes': str(len(forest.pair_votes.target)),
        'confidence': 'calibrated' if len(model.calibration) else 'the share of the votes',
        **{
            name.replace('_', ' '): f'{value:g}' if isinstance(value, float) else str(value)
            for name, value in model.settings._asdict().items()
        },
        **model.provenance,
    }


def _to_bytes(header: dict[str, Any]) -> NDArray[np.uint8]:
    return np.frombuffer(json.dumps(header, indent=1).encode(), np.uint8)


def _wrong(path: Path, why: str) -> InputError:
    return InputError(f'{path} is not a usable model file ({why}); make one with `lsc_pose train`')


def _check_sizes(path: Path) -> None:
    with zipfile.ZipFile(path) as archive:
        for entry in archive.infolist():
            if entry.file_size > LARGEST_ARRAY:
                raise _wrong(path, f'its part {entry.filename} is {entry.file_size} bytes large')


def _read_header(path: Path, archive: Any) -> dict[str, Any]:  # noqa: ANN401
    if 'header' not in archive:
        raise _wrong(path, 'it has no header')
    header = json.loads(archive['header'].astype(np.uint8).tobytes())
    if not isinstance(header, dict) or header.get('format') != FORMAT:
        raise _wrong(path, 'its header is of another kind')
    if header.get('version') not in _READ:
        msg = (
            f'{path} is a model of version {header.get("version")}, but this program reads '
            f'versions up to {VERSION}; train it anew or use the program that wrote it'
        )
        raise InputError(msg)
    return header


def _read_array(
    path: Path,
    archive: Any,  # noqa: ANN401
    name: str,
    form: Form,
) -> NDArray[np.generic]:
    if name not in archive:
        raise _wrong(path, f'its part {name} is missing')
    array, (kind, dimensions) = archive[name], form
    if array.dtype != np.dtype(kind) or array.ndim != dimensions:
        raise _wrong(path, f'its part {name} is {array.dtype} of {array.ndim} dimensions')
    return np.ascontiguousarray(array)


def _old_forest(arrays: dict[str, Any]) -> Forest:
    joint, pair = (
        LeafVotes(
            arrays[f'{kind}_start'],
            arrays[f'{kind}_target'],
            arrays[f'{kind}_offset'].astype(np.float32),
            arrays[f'{kind}_weight'].astype(np.float32),
        )
        for kind in ('joint', 'pair')
    )
    return Forest(
        arrays['roots'], arrays['feature'], arrays['threshold'], arrays['left'], joint, pair
    )


def _assemble(header: dict[str, Any], arrays: dict[str, Any], forest: Forest) -> Model:
    model = Model(
        arrays['joints'],
        arrays['edges'],
        arrays['limb_lengths'],
        read_settings(header.get('settings')),
        forest,
        read_provenance(header.get('provenance')),
        arrays.get(_CALIBRATION, uncalibrated()),
    )
    check_model(model)
    return model
