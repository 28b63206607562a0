"""Where the files of the package are found."""

import sys
from pathlib import Path

import pytest

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources import default_model, find_model, resource, shipped_models


@pytest.fixture
def places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Path, Path]:
    """The share folders of a workspace and of this Python environment, both empty."""
    workspace, environment = tmp_path / 'install', tmp_path / 'environment'
    monkeypatch.setenv('AMENT_PREFIX_PATH', f'/nowhere:{workspace}')
    monkeypatch.setattr(sys, 'prefix', str(environment))
    shares = tuple(place / 'share' / 'lsc_pose_ros' for place in (workspace, environment))
    for share in shares:
        share.mkdir(parents=True)
    return shares


def put(share: Path, *parts: str) -> Path:
    path = share.joinpath(*parts)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.touch()
    return path


def test_source_tree_comes_last(places: tuple[Path, Path]) -> None:
    source = resource('config', 'pose_node.yaml')
    assert source == Path(__file__).resolve().parents[1] / 'config' / 'pose_node.yaml'
    in_environment = put(places[1], 'config', 'pose_node.yaml')
    assert resource('config', 'pose_node.yaml') == in_environment
    in_workspace = put(places[0], 'config', 'pose_node.yaml')
    assert resource('config', 'pose_node.yaml') == in_workspace


def test_without_a_sourced_workspace(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv('AMENT_PREFIX_PATH', raising=False)
    assert resource('config', 'fastdds_profile.xml').is_file()


def test_missing_file_is_named() -> None:
    with pytest.raises(InputError, match=r'config/nothing\.yaml'):
        resource('config', 'nothing.yaml')


def test_default_model(places: tuple[Path, Path]) -> None:
    path = put(places[1], 'models', 'default.npz')
    assert default_model() == path


def test_without_a_default_model(
    places: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr('lsc_pose_ros.resources.__file__', str(tmp_path / 'a' / 'b.py'))
    assert places
    with pytest.raises(InputError, match='lsc_pose train'):
        default_model()


def test_models_have_names(places: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    workspace, environment = places
    front = put(environment, 'models', 'front.npz')
    put(environment, 'models', 'default.npz')
    default = put(workspace, 'models', 'default.npz')
    put(workspace, 'models', 'README.md')
    monkeypatch.setattr('lsc_pose_ros.resources.__file__', '/nowhere/a/b.py')
    assert shipped_models() == {'default': default, 'front': front}
    assert find_model() == find_model('') == find_model('default') == default
    assert find_model('front') == find_model(Path('front')) == front


def test_a_file_goes_before_a_model_of_the_package_of_that_name(
    shipped: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (shipped / 'front.npz').touch()
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'front').mkdir()  # a folder is no model
    assert find_model('front') == shipped / 'front.npz'
    (tmp_path / 'front').rmdir()
    (tmp_path / 'front').touch()
    assert find_model('front') == Path('front')


def test_what_looks_like_a_path_is_one(shipped: Path) -> None:
    (shipped / 'front.npz').touch()
    for path in ('front.npz', 'folder/front', '/front', '../front'):
        assert find_model(path) == Path(path)


def test_an_unknown_name_is_answered_with_those_that_there_are(shipped: Path) -> None:
    with pytest.raises(InputError, match=r'no model file back, .* no model does'):
        find_model('back')
    for name in ('front', 'default'):
        (shipped / f'{name}.npz').touch()
    with pytest.raises(InputError, match='its models are default, front'):
        find_model('back')
