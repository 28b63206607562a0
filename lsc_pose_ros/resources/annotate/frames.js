// Copyright 2026 lsc_pose_ros contributors
// SPDX-License-Identifier: Apache-2.0

// Shows frames, and keeps their labels.

import { draw, drawSelected } from './drawing.js';
import { ask, picture } from './requests.js';
import { copyOf, element, jointOf, recorded, state } from './state.js';
import { beginFrame } from './view.js';

export async function show(number) {
  // The first answer takes long if the model was never used on this computer.
  element('caption').textContent = `Frame ${recorded(number)} is being read.`;
  const frame = await ask(`frame/${number}`);
  const before = state.picture;
  const address = await picture(number);
  Object.assign(state, frame, { picture: address, undone: [], past: [] });
  state.recording.done[number] = frame.done;
  if (!jointOf(state.selected)) state.selected = null;
  beginFrame();
  draw();
  URL.revokeObjectURL(before);
}

function take(frame) {
  Object.assign(state, frame);
  state.recording.done[frame.number] = frame.done;
  drawSelected();
}

// If another page has changed the frame meanwhile, the frame is shown as it is there.
async function send(bodies, done) {
  try {
    take(await ask(`keep/${state.number}`, { bodies, done, revision: state.revision }));
  } catch (error) {
    if (error.isStale) await show(state.number);
    throw error;
  }
}

// Shows what other pages have done since.
export async function refresh() {
  state.recording = await ask('recording');
  const { revision } = await ask(`frame/${state.number}`);
  if (revision === state.revision) {
    draw();
    return '';
  }
  await show(state.number);
  return `Frame ${recorded(state.number)} was changed on another page; it is shown as it is there.`;
}

export async function keep(bodies, done = state.done) {
  const before = copyOf(state.bodies);
  await send(bodies, done);
  state.past.push(before);
  state.undone = [];
  draw();
}

export async function accept() {
  await send(state.bodies, true);
  if (state.number + 1 < state.recording.done.length) await show(state.number + 1);
}

async function goBack(from, to) {
  if (!from.length) return;
  const before = copyOf(state.bodies);
  await send(from.at(-1), state.done);
  from.pop();
  to.push(before);
  draw();
}
export const undo = () => goBack(state.past, state.undone);
export const redo = () => goBack(state.undone, state.past);

export async function copyPrevious() {
  if (!state.number) throw new Error('There is no previous frame.');
  const before = await ask(`frame/${state.number - 1}`);
  await keep(before.bodies);
}

export async function step(way) {
  const number = state.number + way;
  if (number >= 0 && number < state.recording.done.length) await show(number);
}

// Goes to a frame by its number in the recording, or to the nearest one that is to be labelled.
export async function goTo(text) {
  const { numbers, count } = state.recording;
  const wanted = text.trim() === '' ? NaN : Number(text);
  if (!Number.isInteger(wanted) || wanted < 0 || wanted >= count) {
    throw new Error(`The recording has the frames 0 to ${count - 1}.`);
  }
  const away = numbers.map((number) => Math.abs(number - wanted));
  const nearest = away.indexOf(Math.min(...away));
  await show(nearest);
  if (!away[nearest]) return '';
  return `Frame ${wanted} is not among those to label; ${numbers[nearest]} is the nearest.`;
}
