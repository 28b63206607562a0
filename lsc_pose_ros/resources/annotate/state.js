// Copyright 2026 lsc_pose_ros contributors
// SPDX-License-Identifier: Apache-2.0

// What the page shows: the recording, one of its frames, and the joint that is selected.

export const state = {
  recording: null,         // as the server describes it
  number: 0,               // of the frame, among those to label
  width: 1, height: 1, done: false,
  people: null,            // left, top, right and bottom of the mask of all people
  revision: 0,             // of the labels, which each change of any page makes larger
  isWritten: false,        // whether the recording is written, and the command has ended
  bodies: [],              // the labels of the frame, as the server gives them
  picture: '',             // the address of the depth image
  selected: null,          // { body, joint }
  undone: [], past: [],    // labels of this frame, to come back to
};

export const element = (id) => document.getElementById(id);
export const copyOf = (value) => JSON.parse(JSON.stringify(value));

export const bodyOf = (number) => state.bodies.find((body) => body.number === number);
export const jointOf = (place) => (
  place && bodyOf(place.body) && bodyOf(place.body).joints[place.joint]);
export const isSelected = ({ body, joint }) => Boolean(
  state.selected && state.selected.body === body && state.selected.joint === joint);

// A joint as a word: that of a field, and of the circle that shows it.
export const wordOf = ({ body, joint }) => `${body}/${joint}`;
export function placeOf(word) {
  const [body, joint] = (word || '').split('/');
  return joint ? { body: Number(body), joint } : null;
}

export const nameOf = (joint) => joint.replace('l_', 'left ').replace('r_', 'right ');
export const sideOf = (joint) => ({ l_: 'left', r_: 'right' }[joint.slice(0, 2)] || 'middle');

// The number in the recording of a frame among those to label.
export const recorded = (number) => state.recording.numbers[number];
