"""What the package declares and what it installs."""

import ast
import configparser
import importlib.metadata
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import pytest

import lsc_pose_ros

ROOT = Path(__file__).parents[1]

# What may be imported, besides the standard library: the name in setup.py (None: only ROS has
# it) and the rosdep key in package.xml.
DEPENDENCIES: dict[str, tuple[str | None, str]] = {
    'PIL': ('pillow', 'python3-pil'),
    'ament_index_python': (None, 'ament_index_python'),
    'builtin_interfaces': (None, 'builtin_interfaces'),
    'diagnostic_msgs': ('ros-jazzy-diagnostic-msgs', 'diagnostic_msgs'),
    'launch': (None, 'launch'),
    'launch_ros': (None, 'launch_ros'),
    'matplotlib': ('matplotlib', 'python3-matplotlib'),
    'mcap': ('mcap', 'mcap-ros2-support'),
    'numba': ('numba', 'python3-numba'),
    'numpy': ('numpy', 'python3-numpy'),
    'rcl_interfaces': (None, 'rcl_interfaces'),
    'rclpy': ('ros-jazzy-rclpy', 'rclpy'),
    'rosbags': ('rosbags', 'python3-rosbags-pip'),
    'scipy': ('scipy', 'python3-scipy'),
    'rosgraph_msgs': (None, 'rosgraph_msgs'),
    'sensor_msgs': ('ros-jazzy-sensor-msgs', 'sensor_msgs'),
    'tf2_msgs': (None, 'tf2_msgs'),
    'tqdm': ('tqdm', 'python3-tqdm'),
    'visualization_msgs': ('ros-jazzy-visualization-msgs', 'visualization_msgs'),
    'yaml': ('pyyaml', 'python3-yaml'),
    'zstandard': ('zstandard', 'mcap-ros2-support'),
}

# Messages that are looked up when they are needed, by their package or the name of their type:
# /diagnostics, `replay --publish --clock`, publish_tf.
IMPORTED_BY_NAME = {'diagnostic_msgs', 'rosgraph_msgs', 'tf2_msgs'}


def imported_modules() -> set[str]:
    """Return the top-level names that the package and its launch files import."""
    names: set[str] = set()
    for path in [*(ROOT / 'lsc_pose_ros').rglob('*.py'), *(ROOT / 'launch').rglob('*.py')]:
        for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
            if isinstance(node, ast.Import):
                names.update(alias.name.partition('.')[0] for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names.add(node.module.partition('.')[0])
    return (names | IMPORTED_BY_NAME) - sys.stdlib_module_names - {'lsc_pose_ros'}


def package_xml() -> ET.Element:
    return ET.parse(ROOT / 'package.xml').getroot()  # noqa: S314 - our own file


def text_of(element: ET.Element, name: str) -> str:
    return (element.findtext(name) or '').strip()


def find_version(distribution: str) -> tuple[int, ...]:
    """Return the installed version's numbers; none where it is not installed."""
    try:
        version = importlib.metadata.version(distribution)
    except importlib.metadata.PackageNotFoundError:
        return ()
    return tuple(int(number) for number in re.findall(r'\d+', version)[:2])


@pytest.fixture(scope='module')
def wheel(tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    """Return the wheel that pip makes; made from a copy, so that no build/ is left behind."""
    installed = {name: find_version(name) for name in ('pip', 'setuptools', 'wheel')}
    if not installed['pip'] or installed['setuptools'] < (64,):
        pytest.skip('pip and setuptools 64 or newer are not both installed')
    if installed['setuptools'] < (70, 1) and not installed['wheel']:
        pytest.skip('setuptools before 70.1 makes wheels only with the package wheel')
    source = tmp_path_factory.mktemp('source')
    for name in ('lsc_pose_ros', 'resource', 'config', 'launch', 'bodies', 'models'):
        if (ROOT / name).is_dir():
            ignore = shutil.ignore_patterns('__pycache__')
            shutil.copytree(ROOT / name, source / name, ignore=ignore)
    for name in ('setup.py', 'setup.cfg', 'pyproject.toml', 'package.xml', 'README.md', 'LICENSE'):
        shutil.copy(ROOT / name, source)
    target = tmp_path_factory.mktemp('wheel')
    options = ['--quiet', '--no-deps', '--no-build-isolation', '--no-index', '--wheel-dir']
    subprocess.run(
        [sys.executable, '-m', 'pip', 'wheel', *options, str(target), str(source)],
        check=True,
        timeout=300,
    )
    (path,) = target.glob('*.whl')
    return zipfile.ZipFile(path)


def test_the_version_is_the_same_everywhere() -> None:
    setup = re.search(r"version='([^']+)'", (ROOT / 'setup.py').read_text(encoding='utf-8'))
    assert setup is not None
    assert setup.group(1) == lsc_pose_ros.__version__ == text_of(package_xml(), 'version')


def test_the_package_is_one_that_ros_knows() -> None:
    package = package_xml()
    assert package.get('format') == '3'
    assert text_of(package, 'name') == 'lsc_pose_ros'
    assert text_of(package, 'license') == 'Apache-2.0'
    assert text_of(package, 'export/build_type') == 'ament_python'
    assert (ROOT / 'resource' / 'lsc_pose_ros').is_file()
    scripts = configparser.ConfigParser()
    scripts.read(ROOT / 'setup.cfg')
    assert scripts['develop']['script_dir'] == '$base/lib/lsc_pose_ros'
    assert scripts['install']['install_scripts'] == '$base/lib/lsc_pose_ros'


def test_every_import_is_declared_to_pip_and_to_rosdep() -> None:
    imported = imported_modules()
    assert imported - set(DEPENDENCIES) == set()
    setup = (ROOT / 'setup.py').read_text(encoding='utf-8')
    keys = {text_of(depend, '.') for depend in package_xml() if depend.tag.endswith('depend')}
    for module in imported:
        requirement, key = DEPENDENCIES[module]
        assert requirement is None or re.search(rf"'{requirement}\b", setup), module
        assert key in keys, module


def test_nothing_is_declared_that_is_not_imported() -> None:
    used = {DEPENDENCIES[module][1] for module in imported_modules()}
    declared = {text_of(depend, '.') for depend in package_xml().iter('exec_depend')}
    assert declared == used


def test_the_wheel_holds_every_module(wheel: zipfile.ZipFile) -> None:
    modules = {str(path.relative_to(ROOT)) for path in (ROOT / 'lsc_pose_ros').rglob('*.py')}
    assert modules == {
        name for name in wheel.namelist() if re.match(r'lsc_pose_ros/.*\.py$', name)
    }


def test_the_wheel_holds_the_shared_files_at_their_places(wheel: zipfile.ZipFile) -> None:
    expected = {'share/ament_index/resource_index/packages/lsc_pose_ros'}
    expected.add('share/lsc_pose_ros/package.xml')
    for folder in ('config', 'launch'):
        expected |= {
            f'share/lsc_pose_ros/{path.relative_to(ROOT)}'
            for path in (ROOT / folder).rglob('*')
            if path.is_file() and path.suffix != '.pyc'
        }
    data = f'lsc_pose_ros-{lsc_pose_ros.__version__}.data/data/'
    assert expected == {
        name.removeprefix(data)
        for name in wheel.namelist()
        if name.startswith(data) and not name.endswith('/')
    }


def test_the_wheel_gives_both_executables(wheel: zipfile.ZipFile) -> None:
    folder = f'lsc_pose_ros-{lsc_pose_ros.__version__}.dist-info'
    scripts = configparser.ConfigParser()
    scripts.read_string(wheel.read(f'{folder}/entry_points.txt').decode())
    assert set(scripts['console_scripts']) == {'lsc_pose', 'pose_node'}
    for target in scripts['console_scripts'].values():
        module, _, function = target.partition(':')
        assert callable(getattr(importlib.import_module(module), function))


def test_links_between_the_documents_lead_somewhere() -> None:
    documents = [*ROOT.glob('*.md'), *ROOT.glob('docs/**/*.md')]
    assert documents
    for document in documents:
        for link in re.findall(r'\]\(([^)#\s]+)', document.read_text(encoding='utf-8')):
            assert '://' in link or (document.parent / link).exists(), f'{document}: {link}'
