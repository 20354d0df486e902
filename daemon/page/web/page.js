// The status page: asks the server for frames ten times a second and shows them.
import { isMissing, showCameras, showLight, showMotion } from '/bar.js';
import { LoginNeeded, post, readFrame, readJson, readText } from '/connection.js';
import { Model } from '/model.js';
import { drawLegend, PictureView } from '/pictures.js';
import { drawHistogram, drawLines, drawPlan } from '/plots.js';
import { ReplayControls } from '/replay.js';
import { byId, cameraRows, clockRows, motionRows, number, programRows, recordingText, sentences, setItems, setRows, setText, stageRows } from '/tables.js';
import { Troubleshooting } from '/troubleshooting.js';

const kFramePeriod = 100, kPlotPeriod = 200, kHealthPeriod = 1000, kRetryPeriod = 1000, kHistoryPeriod = 10_000; // ms
const kNoConnection = { state: 'no_connection', cause: 'cartvod, or the network between it and this browser, does not answer', topic: 'no messages' };
const kDegrees = 180 / Math.PI;
const kStagePairs = 100; // ten seconds

const picture = new PictureView(byId('picture'));
let about = null, model = null, replay = null, health = null, help = null, light = kNoConnection, stages = [];
let seen = 0, ages = [0, 0], lastPicture = null, healthAt = -Infinity, plotsAt = -Infinity, historyAt = -Infinity;

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
  help ??= new Troubleshooting(await readText('/troubleshooting.md'));
  byId('show-login').hidden = about.control !== 'with_token';
  if (isNew) {
    model = new Model(content.sample);
    seen = 0;
    lastPicture = null;
    stages = [];
  }
  await readHistory();
  if (content.mode === 'replay' && !replay) replay = new ReplayControls(showStored);
  byId('recording-section').hidden = content.mode === 'replay';
  byId('chips').hidden = content.mode === 'replay';
  setText(byId('latency-name'), content.mode === 'replay' ? 'Processing' : 'Latency');
}

async function readHistory() {
  historyAt = performance.now();
  model.setHistory(await readJson('/history.json'));
}

async function showPictures({ json, jpeg }) {
  light = json.light;
  showLight(light, help);
  ages = json.frame_ages_s ?? [0, 0];
  picture.setAges(ages.map((age) => (isMissing(age) ? age : 0)));
  if (json.pictures?.width > 0 && json.picture_number !== lastPicture) {
    lastPicture = json.picture_number;
    picture.show(json.pictures, await createImageBitmap(jpeg));
    if (json.pictures.stages_ms) stages = [...stages, json.pictures.stages_ms].slice(-kStagePairs);
    byId('row').max = json.pictures.height - 1;
  }
  setText(byId('picture-text'), picture.text(light.state === 'standstill'));
}

async function updateFrame() {
  const frame = await readFrame(`/frame?seen=${seen}`);
  if (frame) {
    seen = frame.json.number;
    if (!model.add(frame.json.samples) && performance.now() - historyAt > kHistoryPeriod) await readHistory();
    if (replay?.chosen == null) await showPictures(frame);
  }
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
  if (replay?.chosen == null) light = health.light;
  showLight(light, help);
  showCameras(health, ages);
  setText(byId('latency-now'), number(replay ? health.process_ms : health.latency_p50_ms, 0));
  setItems(byId('sentences'), sentences(health, light.cause));
  setRows(byId('clocks'), clockRows(health));
  setRows(byId('cameras'), cameraRows(health));
  setRows(byId('program'), programRows(health));
  if (replay) return replay.show(health.replay);
  setText(byId('recording'), recordingText(health.recording));
  byId('record').hidden = about.control !== 'yes' || !(health.recording.possible || health.recording.on);
  setText(byId('record'), health.recording.on ? 'Stop recording' : 'Start recording');
}

function drawPlots() {
  showMotion(model, light);
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
  document.body.classList.remove('stale');
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
        showLight(kNoConnection, help);
        document.body.classList.add('stale');
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
