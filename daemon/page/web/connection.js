// Requests to the server.

const kTimeout = 15_000; // ms; a busy computer serves the page last

export class LoginNeeded extends Error {}

async function request(path, options = {}) {
  const answer = await fetch(path, { ...options, signal: AbortSignal.timeout(kTimeout), cache: 'no-store' });
  if (answer.status === 401 && !options.method) throw new LoginNeeded();
  return answer;
}

export const readJson = async (path) => JSON.parse(await readText(path));

export async function readText(path) {
  const answer = await request(path);
  if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
  return answer.text();
}

/** Sends a text; returns why the server refuses it, or '' if it does not. */
export async function post(path, text) {
  const answer = await request(path, { method: 'POST', headers: { 'Content-Type': 'text/plain' }, body: text });
  return answer.ok ? '' : (await answer.text()).trim();
}

/** A frame: {json, jpeg}; null if there is no newer one. */
export async function readFrame(path) {
  const answer = await request(path);
  if (answer.status === 204 || answer.status === 404) return null;
  if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
  const bytes = await answer.arrayBuffer();
  const length = new DataView(bytes).getUint32(0, true);
  const json = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
  return { json, jpeg: new Blob([new Uint8Array(bytes, 4 + length)], { type: 'image/jpeg' }) };
}
