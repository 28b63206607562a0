// Copyright 2026 lsc_pose_ros contributors
// SPDX-License-Identifier: Apache-2.0
'use strict';

// The page of `lsc_pose annotate`. The server keeps all that is done; this script only shows it
// and asks for changes. `state.bodies` are the labels of the frame as the server gives them.

const token = new URLSearchParams(location.search).get('token') || '';
const element = (id) => document.getElementById(id);
const SVG = 'http://www.w3.org/2000/svg';

const state = {
  recording: null, number: 0, width: 1, height: 1, done: false, bodies: [],
  selected: null,          // { body, joint }
  undone: [], past: [],    // labels of this frame, to come back to
};

async function ask(path, content) {
  const options = { headers: { 'X-Token': token } };
  if (content !== undefined) {
    options.method = 'POST';
    options.body = JSON.stringify(content);
  }
  const response = await fetch(path, options);
  const answer = await response.json();
  if (!response.ok) throw new Error(answer.error || response.statusText);
  return answer;
}

// One action after the other: a change is kept before the next one begins.
let queue = Promise.resolve();
function act(action) {
  queue = queue.then(action).then(() => say(''), (error) => say(error.message));
  return queue;
}

function say(text, good = false) {
  if (!text && element('message').classList.contains('good')) return;
  element('message').textContent = text;
  element('message').classList.toggle('good', good);
}

const copyOf = (value) => JSON.parse(JSON.stringify(value));
const bodyOf = (number) => state.bodies.find((body) => body.number === number);
const jointOf = (place) => place && bodyOf(place.body) && bodyOf(place.body).joints[place.joint];
const words = (joint) => joint.replace('l_', 'left ').replace('r_', 'right ');
const sideOf = (joint) => ({ l_: 'left', r_: 'right' }[joint.slice(0, 2)] || 'middle');

// Frames

async function show(number) {
  // The first answer takes long if the model was never used on this computer.
  element('caption').textContent = `Frame ${number + 1} is being read.`;
  const frame = await ask(`frame/${number}`);
  Object.assign(state, frame, { undone: [], past: [] });
  if (!jointOf(state.selected)) state.selected = null;
  const picture = await fetch(`depth/${number}`, { headers: { 'X-Token': token } });
  const url = URL.createObjectURL(await picture.blob());
  draw(url);
}

function take(frame) {
  Object.assign(state, frame);
  state.recording.done[frame.number] = frame.done;
  draw();
}

async function keep(bodies, done = state.done) {
  state.past.push(copyOf(state.bodies));
  state.undone = [];
  take(await ask(`keep/${state.number}`, { bodies, done }));
}

async function accept() {
  take(await ask(`keep/${state.number}`, { bodies: state.bodies, done: true }));
  if (state.number + 1 < state.recording.done.length) await show(state.number + 1);
}

async function goBack(from, to) {
  if (!from.length) return;
  to.push(copyOf(state.bodies));
  take(await ask(`keep/${state.number}`, { bodies: from.pop(), done: state.done }));
}

async function copyPrevious() {
  if (!state.number) throw new Error('There is no previous frame.');
  const before = await ask(`frame/${state.number - 1}`);
  await keep(before.bodies);
}

async function step(way) {
  const number = state.number + way;
  if (number >= 0 && number < state.recording.done.length) await show(number);
}

// Bodies and joints

// A standing person: columns and rows of the joints in parts of the height of the image.
const STANDING = {
  head: [0, -0.36], neck: [0, -0.28], torso: [0, -0.14], pelvis: [0, 0],
  l_shoulder: [0.08, -0.26], l_elbow: [0.12, -0.12], l_wrist: [0.13, 0], l_hand: [0.13, 0.04],
  l_hip: [0.04, 0], l_knee: [0.05, 0.2], l_ankle: [0.05, 0.38], l_foot: [0.06, 0.41],
};
for (const joint of Object.keys(STANDING).filter((name) => name.startsWith('l_'))) {
  const [column, row] = STANDING[joint];
  STANDING[joint.replace('l_', 'r_')] = [-column, row];
}

async function addBody() {
  const numbers = state.bodies.map((body) => body.number);
  const number = Math.max(0, ...numbers) + 1;
  const joints = {};
  for (const joint of state.recording.joints) {
    const [column, row] = STANDING[joint];
    const pixel = [state.width / 2 + column * state.height, (0.5 + row) * state.height];
    const answer = await ask(`place/${state.number}`, { pixel, depth: 2.5 });
    joints[joint] = { position: answer.position, hidden: false };
  }
  await keep([...copyOf(state.bodies), { number, joints }]);
  select({ body: number, joint: 'head' });
}

async function move(place, pixel, depth) {
  const question = { pixel, body: place.body, joint: place.joint };
  if (depth !== undefined) question.depth = depth;
  const { position } = await ask(`place/${state.number}`, question);
  await change(place, (joint) => ({ ...joint, position }));
}

async function change(place, how) {
  const bodies = copyOf(state.bodies);
  const body = bodies.find((each) => each.number === place.body);
  const changed = how(body.joints[place.joint]);
  if (changed) body.joints[place.joint] = changed;
  else delete body.joints[place.joint];
  await keep(bodies);
}

function withSelected(action) {
  const place = state.selected;
  const joint = jointOf(place);
  if (!joint) throw new Error('Select a joint first.');
  return action(place, joint);
}

const nudge = (right, down) => withSelected((place, joint) => {
  const pixel = [joint.pixel[0] + right, joint.pixel[1] + down];
  return move(place, pixel, joint.position[2]);
});
const setDepth = (depth) => withSelected((place, joint) => {
  if (!(depth > 0)) throw new Error('The depth is in metres, more than 0.');
  return move(place, joint.pixel, depth);
});
const shiftDepth = (metres) => withSelected(
  (place, joint) => setDepth(joint.position[2] + metres));
const toggleHidden = () => withSelected(
  (place) => change(place, (joint) => ({ ...joint, hidden: !joint.hidden })));
const removeJoint = () => withSelected((place) => change(place, () => null));
const removeBody = () => withSelected(
  (place) => keep(state.bodies.filter((body) => body.number !== place.body)));

function select(place) {
  state.selected = place;
  draw();
}

// Drawing

function shape(name, attributes, parent) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  parent.append(made);
  return made;
}

let shown = '';
function draw(url = shown) {
  const image = element('image');
  const focused = document.activeElement && document.activeElement.dataset.place;
  if (url !== shown) URL.revokeObjectURL(shown);
  shown = url;
  image.setAttribute('viewBox', `0 0 ${state.width} ${state.height}`);
  image.replaceChildren();
  shape('image', { href: url, width: state.width, height: state.height }, image);
  for (const body of state.bodies) drawBody(body, image);
  if (focused) {
    const again = image.querySelector(`[data-place="${CSS.escape(focused)}"]`);
    if (again) again.focus({ preventScroll: true });
  }
  drawPanel();
}

function drawBody(body, image) {
  const at = (joint) => body.joints[joint] && body.joints[joint].pixel;
  const unit = state.width / 320;
  for (const [parent, child] of state.recording.limbs) {
    const [from, to] = [at(parent), at(child)];
    if (!from || !to) continue;
    shape('line', {
      x1: from[0], y1: from[1], x2: to[0], y2: to[1], 'stroke-width': unit,
      class: `limb ${sideOf(child)}`,
    }, image);
  }
  for (const [joint, { pixel, position, hidden }] of Object.entries(body.joints)) {
    if (!pixel) continue;
    const place = { body: body.number, joint };
    const chosen = state.selected && state.selected.body === place.body
      && state.selected.joint === joint;
    const circle = shape('circle', {
      cx: pixel[0], cy: pixel[1], r: 2.6 * unit, tabindex: 0, role: 'button',
      class: `joint ${sideOf(joint)}${chosen ? ' selected' : ''}${hidden ? ' hidden' : ''}`,
      'data-place': `${body.number}/${joint}`,
      'aria-label': `${words(joint)} of body ${body.number}, ${position[2].toFixed(2)} metres`
        + (hidden ? ', hidden' : ''),
    }, image);
    circle.addEventListener('focus', () => {
      if (!chosen) select(place);
    });
    circle.addEventListener('pointerdown', (event) => drag(event, place));
  }
}

function drawPanel() {
  const { done } = state.recording;
  const count = done.filter(Boolean).length;
  element('done').max = done.length;
  element('done').value = count;
  element('count').textContent = `${count} of ${done.length}`;
  element('frame').textContent = `${state.number + 1} of ${done.length}`;
  element('caption').textContent = `Frame ${state.number + 1} is ${state.done ? 'done' : 'open'}; `
    + `${state.bodies.length} ${state.bodies.length === 1 ? 'body' : 'bodies'}.`;
  element('undo').disabled = !state.past.length;
  element('redo').disabled = !state.undone.length;
  element('previous').disabled = element('copy').disabled = !state.number;
  element('next').disabled = state.number + 1 === done.length;
  const options = [new Option('none', '')];
  for (const body of state.bodies) {
    for (const joint of Object.keys(body.joints)) {
      options.push(new Option(`${words(joint)}, body ${body.number}`, `${body.number}/${joint}`));
    }
  }
  element('joint').replaceChildren(...options);
  const joint = jointOf(state.selected);
  element('joint').value = joint ? `${state.selected.body}/${state.selected.joint}` : '';
  element('depth').value = joint ? joint.position[2].toFixed(3) : '';
  element('hidden').checked = Boolean(joint && joint.hidden);
  for (const id of ['depth', 'hidden', 'remove', 'removeBody']) element(id).disabled = !joint;
}

// Pointer

function pixelAt(event) {
  const matrix = element('image').getScreenCTM().inverse();
  const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix);
  return [point.x, point.y];
}

function drag(event, place) {
  event.preventDefault();
  select(place);
  const image = element('image');
  const circle = image.querySelector(`[data-place="${place.body}/${place.joint}"]`);
  circle.focus({ preventScroll: true });
  let pixel = null;
  const follow = (moved) => {
    pixel = pixelAt(moved);
    circle.setAttribute('cx', pixel[0]);
    circle.setAttribute('cy', pixel[1]);
  };
  const end = () => {
    window.removeEventListener('pointermove', follow);
    window.removeEventListener('pointerup', end);
    if (pixel) act(() => move(place, pixel));
  };
  window.addEventListener('pointermove', follow);
  window.addEventListener('pointerup', end);
}

// Keys and buttons

const KEYS = {
  Enter: accept, PageUp: () => step(-1), PageDown: () => step(1),
  ArrowLeft: (event) => nudge(event.shiftKey ? -10 : -1, 0),
  ArrowRight: (event) => nudge(event.shiftKey ? 10 : 1, 0),
  ArrowUp: (event) => nudge(0, event.shiftKey ? -10 : -1),
  ArrowDown: (event) => nudge(0, event.shiftKey ? 10 : 1),
  '+': () => shiftDepth(0.01), '-': () => shiftDepth(-0.01),
  h: toggleHidden, Delete: removeJoint, c: copyPrevious, a: addBody,
};

document.addEventListener('keydown', (event) => {
  const inField = event.target.matches('input, select, button, summary');
  if ((event.ctrlKey || event.metaKey) && !event.altKey) {
    const key = event.key.toLowerCase();
    const redo = key === 'y' || (key === 'z' && event.shiftKey);
    if (key !== 'z' && key !== 'y') return;
    event.preventDefault();
    act(() => (redo ? goBack(state.undone, state.past) : goBack(state.past, state.undone)));
    return;
  }
  const action = KEYS[event.key] || KEYS[event.key.toLowerCase()];
  if (!action || event.altKey || (inField && !event.key.startsWith('Page'))) return;
  event.preventDefault();
  act(() => action(event));
});

for (const [id, action] of Object.entries({
  previous: () => step(-1), next: () => step(1), accept, copy: copyPrevious, add: addBody,
  undo: () => goBack(state.past, state.undone), redo: () => goBack(state.undone, state.past),
  remove: removeJoint, removeBody,
})) element(id).addEventListener('click', () => act(action));

element('finish').addEventListener('click', () => act(async () => {
  const { text } = await ask('finish', {});
  say(`${text}. This page can be closed.`, true);
}));
element('joint').addEventListener('change', (event) => {
  const [body, joint] = event.target.value.split('/');
  select(joint ? { body: Number(body), joint } : null);
});
element('depth').addEventListener('change', (event) => act(() => setDepth(+event.target.value)));
element('hidden').addEventListener('change', () => act(toggleHidden));
element('panel').addEventListener('submit', (event) => event.preventDefault());

act(async () => {
  state.recording = await ask('recording');
  document.title = `Annotate ${state.recording.name}`;
  element('name').textContent = state.recording.name;
  const open = state.recording.done.indexOf(false);
  await show(open < 0 ? 0 : open);
});
