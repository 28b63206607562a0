# Copyright 2026 lsc_pose_ros contributors
# SPDX-License-Identifier: Apache-2.0
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Package lsc_pose_ros for pip and colcon."""

import re
import sys
from pathlib import Path

from setuptools import find_packages, setup

PACKAGE = 'lsc_pose_ros'
ADDRESS = 'https://github.com/lsc-pose-ros/lsc_pose_ros'
BRANCH = 'main'
# colcon runs a symbolic link to this file in a folder without the README.
README = Path(__file__).resolve().with_name('README.md')

# Training and offline work: no ROS.
REQUIREMENTS = [
    'matplotlib>=3.6',
    'mcap>=1.3',
    'numba>=0.58',
    'numpy>=1.26',
    'pillow>=9.4',
    'pyyaml>=6.0',
    'rosbags>=0.10.11',
    'tqdm>=4.60',
    'zstandard>=0.20',
]

EXTRAS = {
    # ROS 2 Jazzy from wheels, for machines without ROS.
    'ros': [
        'ros-jazzy-diagnostic-msgs>=5.3',
        'ros-jazzy-rclpy[fastrtps]>=7.1',
        'ros-jazzy-sensor-msgs>=5.3',
        'ros-jazzy-visualization-msgs>=5.3',
    ],
    # `lsc_pose import utd-mhad` reads MATLAB files.
    'mat': ['scipy>=1.11'],
    # Completion of `lsc_pose` in the shell.
    'completion': ['argcomplete>=2'],
    # `lsc_pose import itop` reads HDF5 files.
    'itop': ['h5py>=3.8'],
    # `lsc_pose export -o joints.parquet` writes Parquet files.
    'parquet': ['pyarrow>=14'],
    # `lsc_pose label --from c3d` reads C3D files.
    'c3d': ['c3d>=0.5'],
    'test': [
        'argcomplete>=2',
        'c3d>=0.5',
        'h5py>=3.8',
        'hypothesis>=6.100',
        'import-linter>=2.0',
        'mypy==2.4.1',
        'playwright>=1.40',
        'pyarrow>=14',
        'pytest>=7.4,<10',
        'pytest-xdist>=3.5',
        'ruff==0.17.6',
        'scipy>=1.11',
        'scipy-stubs',
        'setuptools>=70.1',
        'types-pyyaml',
        'types-tqdm',
    ],
}

PROGRAMS = {
    'lsc_pose': 'lsc_pose_ros.cli.program:main',
    'pose_node': 'lsc_pose_ros.ros.node.main:main',
}


def ros2_run_files() -> list[tuple[str, list[str]]]:
    """Return the data files with which `ros2 run` finds the executables of a wheel.

    It looks in `lib/lsc_pose_ros`, but pip installs the executables in `bin`. colcon, which
    builds no wheel, installs the executables themselves there.
    """
    if not {'bdist_wheel', 'sdist'} & set(sys.argv):
        return []
    return [(f'lib/{PACKAGE}', [f'resource/ros2_run/{program}' for program in PROGRAMS])]


def description() -> str:
    """Return the README with absolute addresses, since PyPI has only its text."""
    text = README.read_text(encoding='utf-8')
    raw = ADDRESS.replace('github.com', 'raw.githubusercontent.com')
    text = re.sub(r'(!\[[^]]*\]\()(?!https?:)', rf'\1{raw}/{BRANCH}/', text)
    return re.sub(r'((?<!!)\[[^]]*\]\()(?!https?:|#)', rf'\1{ADDRESS}/blob/{BRANCH}/', text)


def shared_files(folder: str, source: str = '') -> list[tuple[str, list[str]]]:
    """Return the data files that copy `source` to `folder` of the package's ament share.

    Args:
        folder: the folder below `share/lsc_pose_ros`.
        source: the folder in the repository; empty: the same as `folder`.

    Returns:
        Pairs of a target folder and its files, as setuptools wants them.
    """
    root = Path(source or folder)
    groups: dict[str, list[str]] = {}
    for path in sorted(root.rglob('*')):
        if path.is_file() and path.suffix != '.pyc':
            target = Path('share', PACKAGE, folder, path.parent.relative_to(root))
            groups.setdefault(target.as_posix(), []).append(path.as_posix())
    return list(groups.items())


setup(
    name=PACKAGE,
    version='0.1.0',
    description='Human joints in 3-D from one depth image and a person mask, for ROS 2',
    long_description=description(),
    long_description_content_type='text/markdown',
    license='Apache-2.0 AND CC0-1.0',
    license_files=['LICENSE', f'{PACKAGE}/resources/bodies/LICENSE.md'],
    url=ADDRESS,
    project_urls={
        'Documentation': f'{ADDRESS}/blob/{BRANCH}/docs/README.md',
        'Source': ADDRESS,
        'Issues': f'{ADDRESS}/issues',
        'Changelog': f'{ADDRESS}/blob/{BRANCH}/CHANGELOG.rst',
    },
    author='lsc_pose_ros contributors',
    maintainer='lsc_pose_ros maintainers',
    maintainer_email='maintainers@users.noreply.h-seed-a1dd597a.example',
    keywords=['ROS', 'human pose estimation', 'depth image', 'regression forest'],
    classifiers=[
        'Development Status :: 4 - Beta',
        'Environment :: Console',
        'Intended Audience :: Developers',
        'Intended Audience :: Science/Research',
        'Operating System :: POSIX :: Linux',
        'Programming Language :: Python :: 3 :: Only',
        *(f'Programming Language :: Python :: 3.{minor}' for minor in range(10, 15)),
        'Topic :: Scientific/Engineering :: Image Recognition',
        'Typing :: Typed',
    ],
    python_requires='>=3.10',
    packages=find_packages(include=[PACKAGE, f'{PACKAGE}.*']),
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{PACKAGE}']),
        (f'share/{PACKAGE}', ['package.xml']),
        *shared_files('config', f'{PACKAGE}/resources/config'),
        *shared_files('launch'),
        *ros2_run_files(),
    ],
    package_data={
        PACKAGE: ['py.typed'],
        f'{PACKAGE}.resources': [
            'annotate/*',
            'bodies/*',
            'body_parts/*',
            'config/*',
            'config/*/*',
            'models/*',
        ],
    },
    install_requires=REQUIREMENTS,
    extras_require=EXTRAS,
    zip_safe=False,
    entry_points={
        'console_scripts': [f'{program} = {target}' for program, target in PROGRAMS.items()],
    },
)
