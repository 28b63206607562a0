// Copyright 2026 lsc_pose_ros contributors
// SPDX-License-Identifier: Apache-2.0

// Asks the server, which keeps all that is done.

const token = new URLSearchParams(location.search).get('token') || '';

const ENDED = 'The command no longer runs; start it again and open the new address.';
const STRANGE = 'This address is that of an earlier command; open the one that it prints now.';

// The server's sentences are those of the command line, which begin small; names of files stay.
const sentence = (text) => `${text.replace(/^[a-z]+(?= )/, (word) => (
  word.charAt(0).toUpperCase() + word.slice(1)))}.`;

async function answerTo(path, options = {}) {
  let response;
  try {
    response = await fetch(path, { ...options, headers: { 'X-Token': token } });
  } catch {
    throw new Error(ENDED);
  }
  if (response.status === 403) throw new Error(STRANGE);
  if (response.ok) return response;
  const { error } = await response.json().catch(() => ({}));
  throw Object.assign(new Error(sentence(error || response.statusText)), {
    isStale: response.status === 409,
  });
}

export async function ask(path, content) {
  const options = content === undefined ? {} : { method: 'POST', body: JSON.stringify(content) };
  return (await answerTo(path, options)).json();
}

// The address of the depth image of a frame; to be revoked.
export async function picture(number) {
  return URL.createObjectURL(await (await answerTo(`depth/${number}`)).blob());
}
