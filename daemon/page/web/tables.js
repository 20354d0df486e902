// Texts and tables of the page.

export const byId = (id) => document.getElementById(id);

const isNumber = (value) => typeof value === 'number' && Number.isFinite(value);

/** `value` with so many decimals; what rounds to zero has no sign. */
const fixed = (value, digits) => (Number(value.toFixed(digits)) || 0).toFixed(digits);

export function number(value, digits, unit = '') {
  return isNumber(value) ? `${fixed(value, digits)}${unit ? ` ${unit}` : ''}` : '–';
}

/** Writes text only where it changed, so that a screen reader reads only news. */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Rows of [heading, cell, ...]; keeps the elements of a table of the same shape. */
export function setRows(body, rows) {
  while (body.rows.length > rows.length) body.deleteRow(-1);
  rows.forEach((cells, i) => {
    const row = body.rows[i] ?? body.insertRow();
    while (row.cells.length > cells.length) row.deleteCell(-1);
    cells.forEach((text, j) => {
      let cell = row.cells[j];
      if (!cell) {
        cell = document.createElement(j === 0 ? 'th' : 'td');
        if (j === 0) cell.scope = 'row';
        row.append(cell);
      }
      setText(cell, text);
    });
  });
}

/** Items of a list, replaced only if they changed. */
export function setItems(list, items) {
  const shown = [...list.children].map((item) => item.textContent);
  if (shown.length === items.length && shown.every((text, i) => text === items[i])) return;
  list.replaceChildren(...items.map((text) => {
    const item = document.createElement('li');
    item.textContent = text;
    return item;
  }));
}

export function motionRows(model) {
  const sample = model.shown;
  if (!sample) return [];
  const get = (name) => model.value(sample, name);
  const degrees = 180 / Math.PI;
  const scaled = (value, factor) => (value === null ? null : factor * value);
  const row = (name, value, stddev, digits, unit, factor = 1, bound = null) =>
    [name, number(scaled(value, factor), digits, unit), number(scaled(stddev, 2 * factor), digits + 1, unit), number(scaled(bound, factor), digits + 1, unit)];
  const stddev = (variance) => (variance === null ? null : Math.sqrt(Math.max(variance, 0)));
  return [
    row('Speed', get('speed'), get('stddev_speed'), 2, 'm/s', 1, get('bound_speed')),
    row('Yaw rate', get('yaw_rate'), get('stddev_yaw_rate'), 1, '°/s', degrees, get('bound_yaw_rate')),
    row('Pitch rate', get('pitch_rate'), get('stddev_pitch_rate'), 1, '°/s', degrees, get('bound_pitch_rate')),
    row('Roll rate', get('roll_rate'), get('stddev_roll_rate'), 1, '°/s', degrees, get('bound_roll_rate')),
    ['Translation of the last second', '–', '–', number(get('bound_motion'), 3, 'm')],
    ['Rotation of the last second', '–', '–', number(scaled(get('bound_rotation'), degrees), 2, '°')],
    ['Quality, 0 to 100', number(get('quality'), 0), '–', '–'],
    row('Position forward', get('x'), stddev(get('xx')), 2, 'm'),
    row('Position left', get('y'), stddev(get('yy')), 2, 'm'),
    row('Heading', get('yaw'), null, 1, '°', degrees),
    ['Features', `${get('features')} detected, ${get('tracked')} tracked, ${get('inliers')} inliers`, '–', '–'],
  ];
}

const withStddev = (value, stddev, digits, unit) =>
  (isNumber(value) ? `${number(value, digits, unit)}${isNumber(stddev) ? ` (σ ${number(stddev, digits, unit)})` : ''}` : '–');

export function clockRows(health) {
  return [
    ['Offset, right minus left exposure', withStddev(health.offset_ms, health.offset_stddev_ms, 2, 'ms')],
    ['Offset that the arrival times lack, by the cameras’ clocks', number(health.clock_by_reports_ms, 2, 'ms')],
    ['The same by the pictures (both should agree)', number(health.clock_by_pictures_ms, 2, 'ms')],
    ['Right camera later than its time stamps', withStddev(health.right_late_ms, health.right_late_stddev_ms, 2, 'ms')],
    ['Instants of the left camera from', health.left.instants],
    ['Instants of the right camera from', health.right.instants],
    ['Skew of the left camera’s clock', number(health.left.skew_ppm, 1, 'ppm')],
    ['Skew of the right camera’s clock', number(health.right.skew_ppm, 1, 'ppm')],
    ['Processing of a pair, median', number(health.process_ms, 1, 'ms')],
  ];
}

/** Rows of the stages' mean times. `pairs`: objects of ms by name. */
export function stageRows(pairs) {
  const mean = (name) => pairs.reduce((sum, pair) => sum + pair[name], 0) / pairs.length;
  return Object.keys(pairs.at(-1) ?? {}).map((name) => [name.replaceAll('_', ' ').replace(/^./, (letter) => letter.toUpperCase()), number(mean(name), 2, 'ms')]);
}

export function cameraRows({ left, right }) {
  const row = (name, read) => [name, read(left), read(right)];
  return [
    row('State', (camera) => camera.state),
    row('Frame rate', (camera) => number(camera.frame_rate, 1, 'Hz')),
    row('Frames', (camera) => String(camera.frames)),
    row('Damaged', (camera) => String(camera.damaged)),
    row('Reconnections', (camera) => String(camera.reconnections)),
    row('Decoding', (camera) => number(camera.decode_ms, 1, 'ms')),
    row('Exposure to first packet', (camera) => number(camera.latency_ms, 1, 'ms')),
    row('Steps of its clock', (camera) => String(camera.clock_steps)),
    row('Last error', (camera) => camera.last_error || 'none'),
  ];
}

/** Frames that are in no pair, by the reason. */
function leftOut(health) {
  const counts = {
    'without a partner': health.dropped_no_partner,
    damaged: health.dropped_damaged,
    'out of order': health.dropped_out_of_order,
    'beyond the buffer': health.dropped_overflow,
    'from before a clock was set back': health.dropped_clock,
    'of another size': health.refused_size,
  };
  return Object.entries(counts).filter(([, count]) => count > 0).map(([words, count]) => `${count} ${words}`).join(', ') || 'none';
}

export function programRows(health) {
  const axes = ['pitch', 'yaw', 'roll'];
  return [
    ['Version', health.version],
    ['Running since', `${number(health.uptime_s / 60, 1)} min`],
    ['Pairs', `${health.pairs}, ${number(health.pair_rate, 1, 'Hz')}; ${health.pairs_skipped} skipped`],
    ['Frames in no pair', leftOut(health)],
    ['State', health.odometry_state],
    ['Estimates', `${health.estimates_valid} valid, ${health.estimates_invalid} invalid`],
    ['Features aimed at', `${health.features_least} of ${health.features_configured}`],
    ['Memory', number(health.memory_mb, 0, 'MB')],
    ['Right camera’s rotation against the rig file', axes.map((name, i) =>
      `${name} ${withStddev(health.right_rotation_deg[i], health.right_rotation_stddev_deg[i], 3, '°')}`).join(', ')],
    ['Readout, left and right', [0, 1].map((i) => withStddev(health.readout_ms[i], health.readout_stddev_ms[i], 1, 'ms')).join(', ')],
  ];
}

/** Other texts for the operator, beside the cause that is shown. The table of the cameras has their errors. */
export function sentences(health, cause) {
  const errors = [health.left.last_error, health.right.last_error].filter((error) => error !== '');
  const isShown = (text) => cause.includes(text) || errors.some((error) => text.endsWith(error));
  return [health.problem, health.bound_exceeded, health.self_check].filter((text) => text !== '' && !isShown(text));
}

export function recordingText(recording) {
  const size = `${recording.pictures} pictures, ${(recording.bytes / 1e6).toFixed(1)} MB`;
  const lost = recording.dropped_pictures > 0 ? `, ${recording.dropped_pictures} left out because the disk is too slow` : '';
  if (recording.on) return `Recording to ${recording.folder}: ${size}${lost}${recording.text ? `. ${recording.text}` : ''}`;
  const last = recording.folder ? `Not recording. The last recording is ${recording.folder}. ` : 'Not recording. ';
  return last + recording.text;
}
