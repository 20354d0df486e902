// The bar: one word for odometry and cameras, the motion, and a line of cause and remedy.
import { byId, number, setText } from '/tables.js';

const kLights = { // word, symbol (as text, not as an emoji), class
  driving: ['DRIVING', '▶\uFE0E', 'good'],
  standstill: ['STANDSTILL', '■\uFE0E', 'still'],
  invalid: ['INVALID', '✕\uFE0E', 'bad'],
  no_camera: ['NO CAMERA', '⊘\uFE0E', 'bad'],
  no_connection: ['NO CONNECTION', '?', 'unknown'],
};
const kOld = 1.5; // s, age of a camera's newest frame

export const isValid = (light) => light?.state === 'driving' || light?.state === 'standstill';

export const isMissing = (age) => age === null || age > kOld;

const sentence = (text) => (text ? text.replace(/^./, (letter) => letter.toUpperCase()).replace(/([^.!?])$/, '$1.') : '');

/** Cause and remedy of a light, and whether there is any; `help`: Troubleshooting, or null if it is not read yet. */
function showAdvice(light, help) {
  const found = help?.find(light.cause, light.topic) ?? { cause: light.cause, remedy: '', link: '/help.html' };
  byId('advice').hidden = !light.cause;
  byId('advice').className = isValid(light) ? 'warning' : 'bad';
  setText(byId('cause'), sentence(found.cause));
  setText(byId('remedy'), sentence(found.remedy));
  byId('help').href = found.link;
}

export function showLight(light, help) {
  const [word, symbol, level] = kLights[light.state];
  byId('bar').className = level;
  setText(byId('word'), word);
  setText(byId('symbol'), symbol);
  document.title = `${word} · cartvo`;
  showAdvice(light, help);
}

/** Speed and yaw rate of a sample of the model; dashes where the light is not valid. */
export function showMotion(model, light) {
  const get = (name) => (model.shown && isValid(light) ? model.value(model.shown, name) : null);
  const rate = get('yaw_rate');
  setText(byId('speed-now'), number(get('speed'), 2));
  setText(byId('yaw-now'), number(rate === null ? null : rate * 180 / Math.PI, 1));
}

function showChip(side, camera, age) {
  const isOld = isMissing(age);
  const isGood = camera.state === 'streaming' && !isOld;
  const state = camera.state === 'streaming' && isOld ? 'no picture' : camera.state;
  byId(`${side}-chip`).className = isGood ? 'chip' : 'chip away';
  setText(byId(`${side}-state`), isGood ? `${number(camera.frame_rate, 1, 'Hz')} ✓` : `${state} ✗`);
}

/** Both cameras and the latency. `ages`: of each camera's newest frame, s. */
export function showCameras(health, ages) {
  ['left', 'right'].forEach((side, i) => showChip(side, health[side], ages[i]));
}
