// Copyright 2026 lsc_pose_ros contributors
// SPDX-License-Identifier: Apache-2.0

// Changes bodies and joints.

import { drawSelected } from './drawing.js';
import { keep } from './frames.js';
import { ask } from './requests.js';
import { copyOf, jointOf, nameOf, state } from './state.js';

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

export async function addBody() {
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

// Puts a joint on a pixel; returns what there is to say about its depth.
export async function move(place, pixel, depth) {
  const question = { pixel, body: place.body, joint: place.joint };
  if (depth !== undefined) question.depth = depth;
  const { position, depthFrom } = await ask(`place/${state.number}`, question);
  await change(place, (joint) => ({ ...joint, position }));
  const name = `The ${nameOf(place.joint)}`;
  const metres = `${position[2].toFixed(2)} m`;
  if (depthFrom === 'before') {
    return `${name} is not on a body there: its depth stays ${metres}. Type another if it is wrong.`;
  }
  if (depthFrom === 'usual') return `${name} is not on a body there: its depth is a guess, ${metres}.`;
  return '';
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

export const nudge = (right, down) => withSelected((place, joint) => {
  const pixel = [joint.pixel[0] + right, joint.pixel[1] + down];
  return move(place, pixel, joint.position[2]);
});
export const setDepth = (depth) => withSelected((place, joint) => {
  const [nearest, farthest] = state.recording.depths;
  if (!(depth >= nearest && depth <= farthest)) {
    throw new Error(`The depth must be ${nearest} to ${farthest} m.`);
  }
  return move(place, joint.pixel, depth);
});
export const shiftDepth = (metres) => withSelected(
  (place, joint) => setDepth(joint.position[2] + metres));
export const toggleHidden = () => withSelected(
  (place) => change(place, (joint) => ({ ...joint, hidden: !joint.hidden })));
export const removeJoint = () => withSelected((place) => change(place, () => null));
export const removeBody = () => withSelected(
  (place) => keep(state.bodies.filter((body) => body.number !== place.body)));

export function select(place) {
  state.selected = place;
  drawSelected();
}
