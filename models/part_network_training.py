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


# ruff: noqa: INP001, T201 - a part of a program
"""Trains the network of body parts, with PyTorch."""

import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from body_part_examples import Example, draw_example
from body_part_scenes import PartGrids
from torch import Tensor, nn
from torch.nn import functional

from lsc_pose_ros.body_parts.classes import CLASSES, NOT_A_PERSON
from lsc_pose_ros.body_parts.part_network import INPUTS, OUTPUTS, Layer, PartNetwork
from lsc_pose_ros.files.kinds import begins_with
from lsc_pose_ros.files.output_file import write_output

PLANES = 16, 32, 64, 96
"""The number of planes of each level."""

LAST_PLANES = 24
"""The number of planes before the scores."""

_STATE = begins_with('a state of a training', b'PK')

MIDDLE_WEIGHT = 2.0
"""How much an error of the middle of one metre counts."""

MIDDLE_ERROR = 0.1
"""Smaller errors of the middle count by their square, metres."""

MIXES = ('up_2', 'up_1', 'up_0', 'scores')
HALVINGS = ('halve_1', 'halve_2', 'halve_3')


class TrainingPlan(NamedTuple):
    """How the network is trained.

    Attributes:
        images: number of images that it sees.
        batch: number of images of each step.
        rate: the largest learning rate.
        warm_up: number of steps in which the rate rises to it.
        decay: of the weights.
        save_every: number of steps after which the state is saved.
    """

    images: int = 400_000
    batch: int = 32
    rate: float = 4e-3
    warm_up: int = 300
    decay: float = 1e-3
    save_every: int = 500


class TorchNetwork(nn.Module):
    """The network of `lsc_pose_ros.body_parts.part_network`, as PyTorch trains it."""

    def __init__(self) -> None:
        """Start with random weights."""
        super().__init__()
        c0, c1, c2, c3 = PLANES
        sizes = {
            'down_0': (INPUTS, c0),
            'halve_1': (c0, c1),
            'down_1': (c1, c1),
            'halve_2': (c1, c2),
            'down_2': (c2, c2),
            'halve_3': (c2, c3),
            'down_3a': (c3, c3),
            'down_3b': (c3, c3),
            'up_2': (c3, c2),
            'refine_2': (c2, c2),
            'up_1': (c2, c1),
            'refine_1': (c1, c1),
            'up_0': (c1, c0),
            'refine_0': (c0, LAST_PLANES),
            'scores': (LAST_PLANES, OUTPUTS),
        }
        self.layers = nn.ModuleDict({name: _module(name, *size) for name, size in sizes.items()})

    def forward(self, planes: Tensor) -> Tensor:
        """Return the outputs, shape (N, OUTPUTS, h, w), of planes of shape (N, INPUTS, h, w)."""
        level_0 = functional.relu(self.layers['down_0'](planes))
        level_1 = self._residual(self._halved(level_0, 'halve_1'), 'down_1')
        level_2 = self._residual(self._halved(level_1, 'halve_2'), 'down_2')
        level_3 = self._residual(self._halved(level_2, 'halve_3'), 'down_3a')
        level_3 = self._residual(level_3, 'down_3b')
        level_2 = self._residual(self._from_above(level_2, level_3, 'up_2'), 'refine_2')
        level_1 = self._residual(self._from_above(level_1, level_2, 'up_1'), 'refine_1')
        level_0 = self._from_above(level_0, level_1, 'up_0')
        scores: Tensor = self.layers['scores'](functional.relu(self.layers['refine_0'](level_0)))
        return scores

    def _halved(self, planes: Tensor, name: str) -> Tensor:
        return functional.relu(self.layers[name](planes))

    def _residual(self, planes: Tensor, name: str) -> Tensor:
        return functional.relu(planes + self.layers[name](planes))

    def _from_above(self, planes: Tensor, above: Tensor, name: str) -> Tensor:
        doubled = functional.interpolate(self.layers[name](above), scale_factor=2.0)
        return functional.relu(planes + doubled[:, :, : planes.shape[2], : planes.shape[3]])


def _module(name: str, inputs: int, outputs: int) -> nn.Module:
    if name in MIXES:
        return nn.Conv2d(inputs, outputs, 1)
    stride = 2 if name in HALVINGS else 1
    convolution = nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False)
    return nn.Sequential(convolution, nn.BatchNorm2d(outputs))


def train_part_network(
    grids: Sequence[PartGrids], plan: TrainingPlan, seed: int, state: Path
) -> PartNetwork:
    """Return a network trained on `grids`; a training that was interrupted goes on.

    Args:
        grids: the images.
        plan: how.
        seed: of all random numbers.
        state: the file of the unfinished training.
    """
    torch.manual_seed(seed)
    network = TorchNetwork().to(memory_format=torch.channels_last)
    optimizer = torch.optim.AdamW(network.parameters(), lr=plan.rate, weight_decay=plan.decay)
    first = _resume(network, optimizer, state)
    steps = plan.images // plan.batch
    begin, total = time.monotonic(), 0.0
    for step, examples in enumerate(_batches(grids, plan, steps, first, seed), start=first):
        for group in optimizer.param_groups:
            group['lr'] = learning_rate(plan, step, steps)
        loss = _loss(network, examples)
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        nn.utils.clip_grad_norm_(network.parameters(), 2.0)
        optimizer.step()
        total += loss.item()
        if (step + 1) % plan.save_every == 0:
            _save_state(network, optimizer, step + 1, state)
            minutes = (time.monotonic() - begin) / 60
            mean = total / plan.save_every
            print(f'step {step + 1} of {steps}, {minutes:.0f} min, loss {mean:.4f}', flush=True)
            total = 0.0
    return exported(network)


def learning_rate(plan: TrainingPlan, step: int, steps: int) -> float:
    """Return the learning rate: it rises linearly, then falls along a cosine."""
    rising = min((step + 1) / plan.warm_up, 1.0)
    return plan.rate * rising * (0.5 + 0.5 * float(np.cos(np.pi * step / steps)) + 0.003)


def _batches(
    grids: Sequence[PartGrids], plan: TrainingPlan, steps: int, first: int, seed: int
) -> Iterator[list[Example]]:
    """Yield the examples of each step from `first` on, in random order."""
    images = [(each, index) for each in grids for index in range(len(each.depth))]
    for step in range(first, steps):
        random = np.random.default_rng([seed, step])
        chosen = random.integers(len(images), size=plan.batch).tolist()
        yield [
            draw_example(each, index, random) for each, index in map(images.__getitem__, chosen)
        ]


def _loss(network: TorchNetwork, examples: list[Example]) -> Tensor:
    """Return the cross entropy of the parts and of person or not, and the error of the middle."""
    planes, parts, to_middle, weights = (
        torch.from_numpy(np.stack(arrays)) for arrays in zip(*examples, strict=True)
    )
    outputs = network(planes.contiguous(memory_format=torch.channels_last))
    logarithms = functional.log_softmax(outputs[:, :CLASSES], 1)
    of_part = -logarithms.gather(1, parts[:, None])[:, 0]
    nobody = logarithms[:, NOT_A_PERSON].clamp(max=-1e-6)
    somebody = torch.log1p(-torch.exp(nobody))
    of_person = -torch.where(parts == NOT_A_PERSON, nobody, somebody)
    people = weights * (parts != NOT_A_PERSON)
    of_middle = functional.smooth_l1_loss(
        outputs[:, CLASSES:], to_middle, reduction='none', beta=MIDDLE_ERROR
    ).sum(1)
    loss = ((of_part + of_person) * weights).sum() / weights.sum()
    return loss + MIDDLE_WEIGHT * (of_middle * people).sum() / (people.sum() + 1)


def _resume(network: TorchNetwork, optimizer: torch.optim.Optimizer, state: Path) -> int:
    """Restore what an interrupted training has saved, and return its next step."""
    if not state.exists():
        return 0
    saved = torch.load(state, weights_only=True)
    network.load_state_dict(saved['network'])
    optimizer.load_state_dict(saved['optimizer'])
    return int(saved['step'])


def _save_state(
    network: TorchNetwork, optimizer: torch.optim.Optimizer, step: int, state: Path
) -> None:
    content = {'network': network.state_dict(), 'optimizer': optimizer.state_dict(), 'step': step}
    write_output(state, _STATE, lambda file: torch.save(content, file))


def exported(network: TorchNetwork) -> PartNetwork:
    """Return the network with each normalisation folded into the convolution before it."""
    return PartNetwork(*(_exported(network.layers[name]) for name in PartNetwork._fields))


def _exported(module: nn.Module) -> Layer:
    with torch.no_grad():
        if isinstance(module, nn.Conv2d) and module.bias is not None:
            return Layer(module.weight[:, :, 0, 0].numpy().copy(), module.bias.numpy().copy())
        convolution, norm = module.children()
        if not isinstance(convolution, nn.Conv2d) or not isinstance(norm, nn.BatchNorm2d):
            raise TypeError
        if norm.running_mean is None or norm.running_var is None:
            raise TypeError
        scale = norm.weight / torch.sqrt(norm.running_var + norm.eps)
        weights = convolution.weight * scale[:, None, None, None]
        bias = norm.bias - norm.running_mean * scale
        return Layer(weights.flatten(2).numpy().copy(), bias.numpy().copy())
