// The status page: asks the server for frames ten times a second and shows them.
import { LoginNeeded, post, readFrame, readJson } from '/connection.js';
import { Model } from '/model.js';
import { drawLegend, PictureView } from '/pictures.js';
import { drawHistogram, drawLines, drawPlan } from '/plots.js';
import { ReplayControls } from '/replay.js';
import { byId, cameraRows, clockRows, motionRows, number, programRows, recordingText, sentences, setItems, setRows, setText, stageRows } from '/tables.js';

const kFramePeriod = 100, kPlotPeriod = 200, kHealthPeriod = 1000, kRetryPeriod = 1000, kHistoryPeriod = 10_000, kStale = 1500; // ms
const kDegrees = 180 / Math.PI;
const kStagePairs = 100; // ten seconds

const picture = new PictureView(byId('picture'));
let about = null, model = null, replay = null, health = null, stages = [];
let seen = 0, reasons = '', lastPictureAt = 0, lastSequence = null, healthAt = -Infinity, plotsAt = -Infinity, historyAt = -Infinity;

const pause = (duration) => new Promise((resolve) => setTimeout(resolve, duration));

/** Reads what the server is; starts anew if it was restarted, and reloads the page if its version is another one. */
async function connect() {
  const answer = await readJson('/about.json');
  if (answer.login === 'needed') throw new LoginNeeded();
  const content = answer.content;
  if (about && about.content.version !== content.version) location.reload();
  const isNew = about?.content.start !== content.start;
  about = answer;
  byId('login').hidden = true;
  byId('content').hidden = false;
  setText(byId('rig'), `${content.title} · ${content.mode}`);
  byId('show-login').hidden = about.control !== 'with_token';
  if (isNew) {
    model = new Model(content.sample);
    seen = 0;
    lastSequence = null;
    stages = [];
  }
  await readHistory();
  if (content.mode === 'replay' && !replay) replay = new ReplayControls(showStored);
  byId('recording-section').hidden = content.mode === 'replay';
}

async function readHistory() {
  historyAt = performance.now();
  model.setHistory(await readJson('/history.json'));
}

async function showPictures(frame) {
  if (!frame.json.pictures || frame.json.pictures.sequence === lastSequence) return;
  lastSequence = frame.json.pictures.sequence;
  lastPictureAt = performance.now();
  picture.show(frame.json.pictures, await createImageBitmap(frame.jpeg));
  stages = [...stages, frame.json.pictures.stages_ms].slice(-kStagePairs);
  byId('row').max = frame.json.pictures.height - 1;
  const text = picture.text();
  setText(byId('picture-text'), text);
}

async function updateFrame() {
  const frame = await readFrame(`/frame?seen=${seen}`);
  if (frame) {
    seen = frame.json.number;
    reasons = frame.json.reasons;
    if (!model.add(frame.json.samples) && performance.now() - historyAt > kHistoryPeriod) await readHistory();
    if (replay?.chosen == null) await showPictures(frame);
  }
  const isStale = about.content.mode === 'live' && performance.now() - lastPictureAt > kStale;
  byId('pictures').classList.toggle('stale', isStale);
  if (isStale && lastSequence !== null) setText(byId('picture-text'), `No new pair for ${number((performance.now() - lastPictureAt) / 1000, 0)} s. The pictures are the last ones.`);
}

/** Shows a pair of a replay that was processed before. */
async function showStored(pair) {
  if (pair === null) {
    seen = 0; // the newest frame is sent again
    model.chosen = null;
    return;
  }
  const frame = await readFrame(`/frame?pair=${pair}`).catch(() => null);
  if (!frame || replay.chosen !== pair) return;
  model.chosen = frame.json.samples.at(-1);
  await showPictures(frame);
}

async function updateHealth() {
  health = await readJson('/health.json');
  byId('verdict').className = health.healthy ? 'good' : 'bad';
  setText(byId('verdict'), health.line.replace(/^./, (letter) => letter.toUpperCase()));
  setItems(byId('sentences'), sentences(health, reasons));
  setRows(byId('clocks'), clockRows(health));
  setRows(byId('cameras'), cameraRows(health));
  setRows(byId('program'), programRows(health));
  if (replay) return replay.show(health.replay);
  setText(byId('recording'), recordingText(health.recording));
  byId('record').hidden = about.control !== 'yes' || !(health.recording.possible || health.recording.on);
  setText(byId('record'), health.recording.on ? 'Stop recording' : 'Start recording');
}

function drawPlots() {
  setRows(byId('motion'), motionRows(model));
  setRows(byId('stages'), stageRows(stages));
  drawPlan(byId('plan'), model);
  drawLines(byId('speed'), [model.series('speed', 'stddev_speed')], 0.5);
  drawLines(byId('rates'), ['yaw_rate', 'pitch_rate', 'roll_rate'].map((name) => model.series(name, `stddev_${name}`, kDegrees)), 2);
  const isLive = about.content.mode === 'live';
  const values = model.samples.map((sample) => model.value(sample, isLive ? 'latency_ms' : 'process_ms')).filter((value) => value !== null);
  const latency = drawHistogram(byId('latency'), values);
  setText(byId('latency-text'), `${isLive ? 'Latency, last packet to publication' : 'Processing time'}, last minute: median ${number(latency.median, 1, 'ms')}, ` +
    `99th percentile ${number(latency.p99, 1, 'ms')}, ${latency.count} pairs.`);
}

function showLogin() {
  if (!byId('login').hidden) return;
  byId('content').hidden = true;
  byId('login').hidden = false;
  byId('token').focus();
}

async function update() {
  if (!about) await connect();
  await updateFrame();
  const now = performance.now();
  if (now - healthAt > kHealthPeriod) {
    healthAt = now;
    await updateHealth();
  }
  if (now - plotsAt > kPlotPeriod) {
    plotsAt = now;
    drawPlots();
  }
  setText(byId('connection'), 'Connected');
}

async function run() {
  for (;;) {
    const begin = performance.now();
    try {
      if (!document.hidden) await update();
      await pause(Math.max(kFramePeriod - (performance.now() - begin), 10));
    } catch (error) {
      if (error instanceof LoginNeeded) {
        setText(byId('connection'), 'The token is needed');
        showLogin();
      } else {
        console.warn(error);
        setText(byId('connection'), 'Connection lost: trying again every second');
        byId('pictures').classList.add('stale');
      }
      await pause(kRetryPeriod);
      await connect().catch(() => {});
    }
  }
}

function setUpPictures() {
  for (const radio of document.querySelectorAll('input[name=view]')) {
    radio.addEventListener('change', () => {
      picture.view = radio.value;
      byId('row-label').hidden = radio.value !== 'epipolar';
      picture.draw();
    });
  }
  const showLegend = () => {
    const legend = picture.legend();
    byId('legend').hidden = !legend;
    setText(byId('legend-low'), legend?.low ?? '');
    setText(byId('legend-high'), legend?.high ?? '');
  };
  byId('colour').addEventListener('change', () => {
    picture.colour = byId('colour').value;
    showLegend();
    picture.draw();
  });
  const setRow = (row) => {
    picture.row = row;
    picture.draw();
  };
  byId('row').addEventListener('input', () => setRow(Number(byId('row').value)));
  byId('picture').addEventListener('click', (event) => {
    if (picture.view !== 'epipolar' || !picture.frame) return;
    setRow(Math.round(picture.frame.height * event.offsetY / byId('picture').clientHeight));
    byId('row').value = picture.row;
  });
  drawLegend(byId('legend-scale'));
  showLegend();
}

function setUpForms() {
  byId('login-form').addEventListener('submit', async (event) => {
    event.preventDefault();
    const refused = await post('/login', byId('token').value).catch(() => 'the server does not answer');
    setText(byId('login-result'), refused);
    if (refused) return;
    byId('token').value = '';
    await connect().catch(() => {});
  });
  byId('show-login').addEventListener('click', () => {
    byId('login').hidden = false;
    byId('token').focus();
  });
  byId('record').addEventListener('click', async () => {
    const action = health?.recording.on ? 'recording/stop' : 'recording/start';
    setText(byId('record-result'), await post('/control', action).catch(() => 'the server does not answer'));
    healthAt = -Infinity;
  });
}

setUpPictures();
setUpForms();
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { plotsAt = -Infinity; });
run();
