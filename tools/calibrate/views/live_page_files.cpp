// HTML and JavaScript of the live calibration page.
#include "tools/calibrate/views/live_page_files.hpp"

namespace cartvo {

const char* const kLivePageHtml = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>cartvo calibrate</title>
<style>
body { font-family: sans-serif; max-width: 1400px; margin: 1em auto; padding: 0 1em; color: #222; background: #fff }
h1 { font-size: 1.2em } h2 { font-size: 1em; margin: 1.2em 0 .3em }
#now { font-size: 2em; min-height: 1.3em; margin: .2em 0 }
#next { font-size: 1.4em; color: #06c; min-height: 1.3em; margin: .2em 0 }
.pictures { display: flex; flex-wrap: wrap; gap: 1em }
figure { margin: 0; flex: 1 1 400px; max-width: 680px }
.frame { position: relative; background: #ddd; min-height: 8em }
.frame img { display: block; width: 100% }
.frame svg { position: absolute; inset: 0; width: 100%; height: 100% }
table { border-collapse: collapse } td, th { border: 1px solid #ccc; padding: .2em .6em; text-align: left }
progress { width: 20em }
.yes { color: #183 } .no { color: #999 } .failed { color: #c22 }
pre { background: #f4f4f4; padding: 1em; overflow-x: auto }
</style>
</head>
<body>
<h1>Calibration with <span id="board"></span></h1>
<p id="now" role="status">waiting for the cameras</p>
<p id="next"></p>
<div class="pictures">
<figure><div class="frame"><img id="picture-left" alt="the left camera"><svg id="cells-left" preserveAspectRatio="none"></svg></div>
<figcaption id="caption-left">left</figcaption></figure>
<figure><div class="frame"><img id="picture-right" alt="the right camera"><svg id="cells-right" preserveAspectRatio="none"></svg></div>
<figcaption id="caption-right">right</figcaption></figure>
</div>
<p>Red: no corners there yet in any view. Circles: the corners found now.</p>
<h2>Views</h2>
<p><progress id="bar" max="20" value="0"></progress> <span id="count">none yet</span></p>
<p>The board was tilted: <span id="tilt-left">its left edge nearer</span>, <span id="tilt-right">its right edge nearer</span>,
<span id="tilt-up">its upper edge nearer</span>, <span id="tilt-down">its lower edge nearer</span>.</p>
<div id="verdict" hidden><h2 id="verdict-title"></h2><pre id="verdict-text"></pre></div>
<div class="pictures">
<div><h2>Rejected</h2><table><thead><tr><th>view</th><th>reason</th></tr></thead><tbody id="rejected"></tbody></table></div>
<div><h2>Taken</h2><table><thead><tr><th>view</th><th>corners, left</th><th>right</th></tr></thead><tbody id="taken"></tbody></table></div>
</div>
<script src="/page.js"></script>
</body>
</html>
)html";

const char* const kLivePageScript = R"js('use strict';
const byId = (id) => document.getElementById(id);
let shown = -1;

function drawCells(side, state) {
  const svg = byId('cells-' + side);
  svg.setAttribute('viewBox', `0 0 ${state.columns} ${state.rows}`);
  svg.replaceChildren(...state[side].coverage.flatMap((corners, i) => {
    if (corners > 0) return [];
    const cell = document.createElementNS('http://www.w3.org/2000/svg', 'rect');
    const place = { x: i % state.columns, y: Math.floor(i / state.columns), width: 1, height: 1 };
    for (const [name, value] of Object.entries(place)) cell.setAttribute(name, value);
    cell.setAttribute('fill', '#d22');
    cell.setAttribute('fill-opacity', '0.22');
    return [cell];
  }));
  byId('caption-' + side).textContent = `${side}: ${state[side].corners} corners now; ` +
    `${Math.round(100 * state[side].covered)} % of the picture covered by the views taken`;
}

function fillTable(id, rows) {
  byId(id).replaceChildren(...rows.map((cells) => {
    const row = document.createElement('tr');
    row.append(...cells.map((text) => {
      const cell = document.createElement('td');
      cell.textContent = text;
      return cell;
    }));
    return row;
  }));
}

function show(state) {
  byId('board').textContent = state.board;
  byId('now').textContent = state.stage === 'solving' ? 'solving the rig' :
    state.stage === 'done' ? 'done' : state.advice || 'waiting for the cameras';
  byId('next').textContent = state.stage !== 'views' ? '' :
    state.next ? 'next: ' + state.next : 'there are enough views';
  byId('bar').max = state.enough_views;
  byId('bar').value = state.views.length;
  byId('count').textContent = `${state.views.length} taken (${state.enough_views} are enough if they cover the whole image), ` +
    `${state.rejected.length} rejected, ${Math.round(state.seconds)} s`;
  for (const [side, seen] of Object.entries(state.tilts))
    byId('tilt-' + side).className = seen ? 'yes' : 'no';
  for (const side of ['left', 'right']) {
    drawCells(side, state);
    if (state.has_pictures) byId('picture-' + side).src = `/${side}.jpg?${state.number}`;
  }
  fillTable('taken', state.views.map((view) => [view.name, view.left_corners, view.right_corners]).reverse());
  fillTable('rejected', state.rejected.map((view) => [view.name, view.reason]).reverse());
  if (state.stage === 'done') {
    byId('verdict').hidden = false;
    byId('verdict-title').textContent = state.passed ? 'The calibration passes' : 'The calibration failed';
    byId('verdict-title').className = state.passed ? 'yes' : 'failed';
    byId('verdict-text').textContent = state.result;
  }
}

async function poll() {
  let stage = '';
  try {
    const state = await (await fetch('/state.json', { cache: 'no-store' })).json();
    stage = state.stage;
    if (state.number !== shown) show(state);
    shown = state.number;
  } catch (error) {
    byId('now').textContent = 'the program has ended';
    byId('next').textContent = '';
  }
  if (stage !== 'done') setTimeout(poll, 200);
}
poll();
)js";

}  // namespace cartvo
