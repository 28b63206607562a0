// Copyright 2026 lsc_pose_ros contributors
// SPDX-License-Identifier: Apache-2.0

// Draws the frame, and fills the fields.

import {
  element, isSelected, jointOf, nameOf, recorded, sideOf, state, wordOf,
} from './state.js';
import { applyView, reveal, unit } from './view.js';

const SVG = 'http://www.w3.org/2000/svg';

// Pixels of the screen.
const RADIUS = 6;
const RING = 11;
const LIMB = 2.5;

export function draw() {
  const image = element('image');
  const focusedOnJoint = element('skeletons').contains(document.activeElement);
  const picture = element('picture');
  if (picture.getAttribute('href') !== state.picture) {
    picture.setAttribute('href', state.picture);
    picture.setAttribute('width', state.width);
    picture.setAttribute('height', state.height);
  }
  applyView();
  element('skeletons').replaceChildren();
  for (const body of state.bodies) drawBody(body, element('skeletons'));
  const selected = focusedOnJoint && state.selected && circleOf(wordOf(state.selected));
  if (selected) selected.focus({ preventScroll: true });
  image.setAttribute('aria-label', `Depth image of frame ${recorded(state.number)} with the `
    + 'joints of all bodies');
  drawPanel();
}

// Draws, and shows the part of the image where the selected joint is.
export function drawSelected() {
  const joint = jointOf(state.selected);
  if (joint && joint.pixel) reveal(joint.pixel);
  draw();
}

export const circleOf = (word) => (
  element('skeletons').querySelector(`[data-place="${CSS.escape(word)}"]`));

function shape(name, attributes, parent) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  parent.append(made);
}

function drawBody(body, parent) {
  const at = (joint) => body.joints[joint] && body.joints[joint].pixel;
  const pixel = unit();
  for (const [from, to] of state.recording.limbs) {
    if (!at(from) || !at(to)) continue;
    const ends = { x1: at(from)[0], y1: at(from)[1], x2: at(to)[0], y2: at(to)[1] };
    shape('line', { ...ends, 'stroke-width': (LIMB + 2) * pixel, class: 'casing' }, parent);
    shape('line', { ...ends, 'stroke-width': LIMB * pixel, class: `limb ${sideOf(to)}` }, parent);
  }
  for (const joint of Object.keys(body.joints)) {
    if (at(joint)) drawJoint({ body: body.number, joint }, body.joints[joint], parent);
  }
}

function drawJoint(place, { pixel, position, hidden }, parent) {
  const at = { cx: pixel[0], cy: pixel[1] };
  if (isSelected(place)) {
    for (const name of ['ring casing', 'ring']) {
      shape('circle', { ...at, r: RING * unit(), class: name }, parent);
    }
  }
  shape('circle', {
    ...at, r: RADIUS * unit(), tabindex: 0, role: 'button',
    class: `joint ${sideOf(place.joint)}${hidden ? ' hidden' : ''}`,
    'aria-pressed': isSelected(place),
    'data-place': wordOf(place),
    'aria-label': `${nameOf(place.joint)} of body ${place.body}, ${position[2].toFixed(2)} metres`
      + (hidden ? ', hidden' : ''),
  }, parent);
}

function drawPanel() {
  const { done, count } = state.recording;
  const finished = done.filter(Boolean).length;
  element('done').max = done.length;
  element('done').value = finished;
  element('count').textContent = `${finished} of ${done.length}`;
  const which = `${recorded(state.number)} of the recording `
    + `(${state.number + 1} of ${done.length})`;
  element('frame').textContent = which;
  element('caption').textContent = `Frame ${which} is ${state.done ? 'done' : 'open'}; `
    + `${state.bodies.length} ${state.bodies.length === 1 ? 'body' : 'bodies'}.`;
  element('goto').max = count - 1;
  element('goto').value = recorded(state.number);
  element('undo').disabled = !state.past.length;
  element('redo').disabled = !state.undone.length;
  element('previous').disabled = element('copy').disabled = !state.number;
  element('next').disabled = state.number + 1 === done.length;
  drawJointFields();
}

function drawJointFields() {
  const options = [new Option('none', '')];
  for (const body of state.bodies) {
    for (const joint of Object.keys(body.joints)) {
      const place = { body: body.number, joint };
      options.push(new Option(`${nameOf(joint)}, body ${body.number}`, wordOf(place)));
    }
  }
  element('joint').replaceChildren(...options);
  const joint = jointOf(state.selected);
  const [nearest, farthest] = state.recording.depths;
  Object.assign(element('depth'), {
    min: nearest, max: farthest, value: joint ? joint.position[2].toFixed(3) : '',
  });
  element('joint').value = joint ? wordOf(state.selected) : '';
  element('hidden').checked = Boolean(joint && joint.hidden);
  for (const id of ['depth', 'hidden', 'remove', 'removeBody']) element(id).disabled = !joint;
}
