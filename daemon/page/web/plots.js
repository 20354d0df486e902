// Plots on canvases, in the colours of the style sheet.

const kShortest = 5; // s, of a plot over time
const kEllipse95 = Math.sqrt(5.991); // of two dimensions

function colours() {
  const style = getComputedStyle(document.documentElement);
  const read = (name) => style.getPropertyValue(name).trim();
  return { back: read('--back'), text: read('--text'), dim: read('--dim'), line: read('--line'), series: [read('--s1'), read('--s2'), read('--s3')] };
}

/** Makes the canvas as large as it is shown; returns its context and size in px of the style sheet. */
function prepare(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = '12px system-ui, sans-serif';
  return { context, width, height };
}

/** A step of 1, 2 or 5 times a power of ten that gives at most `count` ticks. */
function tickStep(span, count) {
  const raw = span / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= raw);
}

function ticks(low, high, count) {
  const step = tickStep(high - low, count);
  const found = [];
  for (let i = Math.ceil(low / step); i * step <= high; ++i) found.push(i * step);
  return found;
}

const shortNumber = (value) => String(Number(value.toPrecision(4)));

/** Lines over the time of their data, at most the last minute. Bands of two standard deviations are cut at the plot's edge, so
 *  that large ones leave the line readable. `series`: of Model.series; `least`: smallest range of the values. */
export function drawLines(canvas, series, least) {
  const { context, width, height } = prepare(canvas);
  const colour = colours();
  const points = series.flat().filter((point) => point !== null);
  const left = 44, right = width - 8, top = 8, bottom = height - 20;
  const values = points.map((point) => point[1]);
  const margin = Math.max(0.15 * (Math.max(0, ...values) - Math.min(0, ...values)), least / 2);
  const low = Math.min(0, ...values) - margin, high = Math.max(0, ...values) + margin;
  const begin = Math.min(-kShortest, ...points.map((point) => point[0]));
  const x = (seconds) => left + (right - left) * (1 - seconds / begin);
  const y = (value) => bottom - (bottom - top) * (value - low) / (high - low);

  context.strokeStyle = colour.line;
  context.lineWidth = 1;
  context.fillStyle = colour.dim;
  context.textBaseline = 'middle';
  context.textAlign = 'right';
  for (const tick of ticks(low, high, 4)) {
    line(context, left, y(tick), right, y(tick));
    context.fillText(shortNumber(tick), left - 6, y(tick));
  }
  context.textBaseline = 'top';
  context.textAlign = 'center';
  for (const tick of ticks(begin, 0, 4)) context.fillText(tick === 0 ? 'now' : `${shortNumber(tick)} s`, Math.min(x(tick), right - 10), bottom + 5);

  context.save();
  context.beginPath();
  context.rect(left, top, right - left, bottom - top);
  context.clip();
  series.forEach((one, i) => {
    context.fillStyle = colour.series[i];
    context.strokeStyle = colour.series[i];
    context.lineWidth = 1.6;
    context.setLineDash([[], [6, 3], [2, 2]][i]);
    for (const run of runs(one)) {
      context.globalAlpha = 0.22;
      context.beginPath();
      run.forEach((point) => context.lineTo(x(point[0]), y(point[1] + 2 * (point[2] ?? 0))));
      [...run].reverse().forEach((point) => context.lineTo(x(point[0]), y(point[1] - 2 * (point[2] ?? 0))));
      context.fill();
      context.globalAlpha = 1;
      context.beginPath();
      run.forEach((point) => context.lineTo(x(point[0]), y(point[1])));
      context.stroke();
    }
  });
  context.restore();
}

function line(context, x0, y0, x1, y1) {
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  context.stroke();
}

/** The parts of a series between its gaps. */
function runs(series) {
  const found = [[]];
  for (const point of series) {
    if (point === null) found.push([]);
    else found.at(-1).push(point);
  }
  return found.filter((run) => run.length > 0);
}

/** The path of the newest epoch, x upwards and y to the left, earlier epochs not shown. */
export function drawPlan(canvas, model) {
  const { context, width, height } = prepare(canvas);
  const colour = colours();
  const newest = model.newest, shown = model.shown;
  if (!newest) return;
  const get = (sample, name) => model.value(sample, name);
  const epoch = get(newest, 'epoch');
  const path = [...model.path.filter((point) => get(point, 'epoch') === epoch), newest];
  const xs = path.map((point) => get(point, 'x')), ys = path.map((point) => get(point, 'y'));
  const span = Math.max((Math.max(...xs) - Math.min(...xs)) / height, (Math.max(...ys) - Math.min(...ys)) / width, 4 / height) * 1.25;
  const cx = (Math.max(...xs) + Math.min(...xs)) / 2, cy = (Math.max(...ys) + Math.min(...ys)) / 2;
  const toX = (y) => width / 2 - (y - cy) / span, toY = (x) => height / 2 - (x - cx) / span;

  drawGrid(context, [width, height], [cx - span * height / 2, cx + span * height / 2, toY], [cy - span * width / 2, cy + span * width / 2, toX], colour);

  context.strokeStyle = colour.series[0];
  context.lineWidth = 2;
  context.beginPath();
  path.forEach((point) => context.lineTo(toX(get(point, 'y')), toY(get(point, 'x'))));
  context.stroke();

  context.strokeStyle = colour.series[1];
  context.lineWidth = 1.2;
  const every = Math.max(1, Math.floor(path.length / 12));
  path.forEach((point, i) => {
    if (i % every !== 0 && i !== path.length - 1) return;
    ellipse(context, toX(get(point, 'y')), toY(get(point, 'x')), get(point, 'xx'), get(point, 'xy'), get(point, 'yy'), span);
  });
  drawStart(context, toX(ys[0]), toY(xs[0]), colour);
  const heading = get(shown, 'yaw');
  const px = toX(get(shown, 'y')), py = toY(get(shown, 'x'));
  context.fillStyle = colour.text;
  context.beginPath();
  for (const [turn, length] of [[0, 13], [2.5, 9], [Math.PI, 3], [-2.5, 9]])
    context.lineTo(px - length * Math.sin(heading + turn), py - length * Math.cos(heading + turn));
  context.fill();
}

/** Lines with their metres, forward at the left edge and to the left at the lower one. `forward`, `left`: [low, high, to px]. */
function drawGrid(context, [width, height], forward, left, colour) {
  const step = tickStep(left[1] - left[0], 6);
  const values = ([low, high]) => Array.from({ length: Math.floor(high / step) - Math.ceil(low / step) + 1 }, (_, i) => (Math.ceil(low / step) + i) * step);
  context.strokeStyle = colour.line;
  context.lineWidth = 1;
  context.fillStyle = colour.dim;
  context.textAlign = 'left';
  context.textBaseline = 'bottom';
  for (const value of values(forward)) {
    const y = forward[2](value);
    line(context, 0, y, width, y);
    if (y > 30 && y < height - 20) context.fillText(shortNumber(value), 4, y - 1);
  }
  for (const value of values(left)) {
    const x = left[2](value);
    line(context, x, 0, x, height);
    if (x > 40 && x < width - 95) context.fillText(shortNumber(value), x + 3, height - 3);
  }
  context.textBaseline = 'top';
  context.fillText('forward, m ↑', 4, 4);
  context.textBaseline = 'bottom';
  context.textAlign = 'right';
  context.fillText('← left, m', width - 4, height - 3);
}

/** A ring where the path of the epoch begins. */
function drawStart(context, x, y, colour) {
  context.strokeStyle = colour.text;
  context.fillStyle = colour.text;
  context.lineWidth = 2;
  context.beginPath();
  context.arc(x, y, 5, 0, 2 * Math.PI);
  context.stroke();
  context.textAlign = 'left';
  context.textBaseline = 'middle';
  context.fillText('start', x + 9, y);
}

/** 95 % of a position with this covariance, x upwards and y to the left. */
function ellipse(context, px, py, xx, xy, yy, metresPerPixel) {
  if (xx === null) return;
  const mean = (xx + yy) / 2, difference = Math.hypot((xx - yy) / 2, xy);
  const large = Math.sqrt(Math.max(mean + difference, 0)), small = Math.sqrt(Math.max(mean - difference, 0));
  const direction = Math.atan2(2 * xy, xx - yy) / 2; // of the large axis, from x to y
  context.beginPath();
  context.ellipse(px, py, kEllipse95 * large / metresPerPixel, kEllipse95 * small / metresPerPixel, -Math.PI / 2 - direction, 0, 2 * Math.PI);
  context.stroke();
}

export function quantile(sorted, share) {
  return sorted.length === 0 ? NaN : sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
}

/** Histogram of values in ms; returns the median, the 99th percentile and the number. */
export function drawHistogram(canvas, values) {
  const { context, width, height } = prepare(canvas);
  const colour = colours();
  const sorted = [...values].sort((a, b) => a - b);
  const result = { median: quantile(sorted, 0.5), p99: quantile(sorted, 0.99), count: sorted.length };
  if (sorted.length === 0) return result;
  const bins = 40, left = 44, right = width - 8, top = 8, bottom = height - 20;
  const end = Math.max(quantile(sorted, 0.995) * 1.3, 1);
  const counts = new Array(bins).fill(0);
  for (const value of sorted) ++counts[Math.min(bins - 1, Math.floor(bins * value / end))];
  const most = Math.max(...counts);
  context.fillStyle = colour.series[0];
  counts.forEach((count, i) => {
    const size = (bottom - top) * count / most;
    context.fillRect(left + (right - left) * i / bins, bottom - size, (right - left) / bins - 1, size);
  });
  context.fillStyle = colour.dim;
  context.textBaseline = 'top';
  context.textAlign = 'center';
  for (const tick of ticks(0, end, 6)) context.fillText(`${shortNumber(tick)} ms`, left + (right - left) * tick / end, bottom + 5);
  context.textAlign = 'right';
  context.fillText(String(most), left - 6, top);
  context.strokeStyle = colour.line;
  line(context, left, bottom, right, bottom);
  return result;
}
