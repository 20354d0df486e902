// Plots on canvases, in the colours of the style sheet.

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

/** Lines over the last minute with bands of two standard deviations. `series`: of Model.series. */
export function drawLines(canvas, series, least) {
  const { context, width, height } = prepare(canvas);
  const colour = colours();
  const points = series.flat().filter((point) => point !== null);
  const left = 44, right = width - 8, top = 8, bottom = height - 20;
  const magnitude = (point) => 2 * Math.min(point[2] ?? 0, 0.5 * Math.abs(point[1]) + least);
  let low = Math.min(0, ...points.map((point) => point[1] - magnitude(point)));
  let high = Math.max(0, ...points.map((point) => point[1] + magnitude(point)));
  if (high - low < least) { high += least / 2; low -= low < 0 ? least / 2 : 0; }
  const x = (seconds) => left + (right - left) * (seconds + 60) / 60;
  const y = (value) => bottom - (bottom - top) * (value - low) / (high - low);

  context.strokeStyle = colour.line;
  context.fillStyle = colour.dim;
  context.textBaseline = 'middle';
  context.textAlign = 'right';
  for (const tick of ticks(low, high, 4)) {
    line(context, left, y(tick), right, y(tick));
    context.fillText(shortNumber(tick), left - 6, y(tick));
  }
  context.textBaseline = 'top';
  context.textAlign = 'center';
  for (const tick of [-60, -45, -30, -15, 0]) context.fillText(tick === 0 ? 'now' : `${tick} s`, Math.min(x(tick), right - 10), bottom + 5);

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

  const step = tickStep(span * width, 5);
  context.strokeStyle = colour.line;
  for (let i = Math.ceil((cy - span * width / 2) / step); i * step < cy + span * width / 2; ++i) line(context, toX(i * step), 0, toX(i * step), height);
  for (let i = Math.ceil((cx - span * height / 2) / step); i * step < cx + span * height / 2; ++i) line(context, 0, toY(i * step), width, toY(i * step));
  context.fillStyle = colour.dim;
  context.fillText(`grid ${shortNumber(step)} m`, 8, height - 8);

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
  const heading = get(shown, 'yaw');
  const px = toX(get(shown, 'y')), py = toY(get(shown, 'x'));
  context.fillStyle = colour.text;
  context.beginPath();
  for (const [turn, length] of [[0, 13], [2.5, 9], [Math.PI, 3], [-2.5, 9]])
    context.lineTo(px - length * Math.sin(heading + turn), py - length * Math.cos(heading + turn));
  context.fill();
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
