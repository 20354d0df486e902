// check_page.mjs URL TOKEN PICTURES: checks cartvod's status page in Chromium. Asks for what has to happen outside with lines
// "do: WHAT" and waits for a line of input. Fails with the step that failed.
import assert from 'node:assert/strict';
import { mkdirSync } from 'node:fs';
import { createInterface } from 'node:readline';
import { chromium } from 'playwright-core';

const [url, token, pictures] = process.argv.slice(2);
const kPatience = 120_000; // ms, on a busy computer
mkdirSync(pictures, { recursive: true });

const answers = createInterface({ input: process.stdin })[Symbol.asyncIterator]();
async function ask(what) {
  console.log(`do: ${what}`);
  await answers.next();
}

const browser = await chromium.launch({ executablePath: process.env.CARTVO_CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox'] });

async function open(options) {
  const page = await (await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options })).newPage();
  page.setDefaultTimeout(kPatience);
  const problems = [];
  page.on('pageerror', (error) => problems.push(error.message));
  page.on('console', (message) => message.type() === 'error' && problems.push(message.text()));
  page.on('request', (request) => {
    const target = new URL(request.url());
    if (target.protocol !== 'data:' && target.protocol !== 'blob:' && target.origin !== new URL(url).origin) problems.push(`asks ${request.url()}`);
  });
  await page.goto(url);
  return { page, problems };
}

/** Waits until the function is true in the page. */
const until = (page, what, argument) => page.waitForFunction(what, argument, { timeout: kPatience });
const text = (page, id) => page.locator(`#${id}`).innerText();
const sequence = async (page) => Number((await text(page, 'picture-text')).match(/^Pair (\d+)/)?.[1]);
const isValid = () => ['DRIVING', 'STANDSTILL'].includes(document.getElementById('word').textContent);
const bothDeliver = () => !document.getElementById('picture').getAttribute('aria-label').includes('no picture');

/** Whether the canvas shows more than one colour. */
const showsSomething = (id) => {
  const canvas = document.getElementById(id);
  const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  const colours = new Set();
  for (let i = 0; i < pixels.length; i += 404) colours.add(`${pixels[i]} ${pixels[i + 1]} ${pixels[i + 2]} ${pixels[i + 3] > 0}`);
  return colours.size > 5;
};

async function checkLoadsAndUpdates(page) {
  await until(page, isValid);
  await page.locator('#details').evaluate((details) => { details.open = true; });
  await until(page, () => /^-?\d+\.\d\d$/.test(document.getElementById('speed-now').textContent));
  for (const side of ['left', 'right']) await until(page, (id) => /^\d+\.\d Hz ✓$/.test(document.getElementById(id).textContent), `${side}-state`);
  await until(page, () => /^Pair \d+: \d+ landmarks, \d+ also in the right picture/.test(document.getElementById('picture-text').textContent));
  for (const id of ['picture', 'plan', 'speed', 'rates', 'latency']) await until(page, showsSomething, id);
  const first = await sequence(page);
  await until(page, (before) => Number(document.getElementById('picture-text').textContent.match(/^Pair (\d+)/)?.[1]) > before + 10, first);
  await until(page, () => /median \d+\.\d ms, 99th percentile \d+\.\d ms, \d+ pairs/.test(document.getElementById('latency-text').textContent));
  for (const id of ['motion', 'clocks', 'stages', 'cameras', 'program']) assert.ok(await page.locator(`#${id} tr`).count() >= 5, id);
}

async function checkKeyboard(page) {
  await page.keyboard.press('Tab');
  assert.equal(await page.evaluate(() => document.activeElement.className), 'skip', 'the first stop skips to the pictures');
  await page.keyboard.press('Enter');
  await page.keyboard.press('Tab');
  assert.equal(await page.evaluate(() => document.activeElement.parentElement.id), 'view');
  await page.keyboard.press('Enter');
  await page.keyboard.press('Tab');
  assert.equal(await page.evaluate(() => document.activeElement.value), 'both');
  await page.keyboard.press('ArrowDown');
  assert.ok(await page.locator('input[value=overlay]').isChecked());
  await until(page, showsSomething, 'picture');
  await page.locator('#pictures').screenshot({ path: `${pictures}/overlay.png` });
  await page.keyboard.press('ArrowDown');
  await page.locator('#row').fill('90');
  await page.locator('#colour').selectOption('depth');
  await page.locator('#pictures').screenshot({ path: `${pictures}/epipolar.png` });
  await page.locator('input[value=both]').check();
}

/** Controls and pictures that have no name in Chromium's accessibility tree, hidden parts of the page included. */
async function checkNames(page) {
  // The page hides and shows parts with each update: until all are counted, an observer shows them again at once.
  const shown = await page.evaluateHandle(() => {
    const elements = new Set();
    const show = () => document.querySelectorAll('[hidden]:not(input)').forEach((element) => { elements.add(element); element.hidden = false; });
    const observer = new MutationObserver(show);
    observer.observe(document.body, { attributes: true, attributeFilter: ['hidden'], childList: true, subtree: true });
    show();
    return { elements, observer };
  });
  const session = await page.context().newCDPSession(page);
  const { nodes } = await session.send('Accessibility.getFullAXTree');
  const roles = ['button', 'textbox', 'radio', 'combobox', 'slider', 'image', 'img', 'link', 'table'];
  const named = nodes.filter((node) => !node.ignored && roles.includes(node.role.value));
  assert.deepEqual(named.filter((node) => !node.name?.value.trim()).map((node) => node.role.value), [], 'all controls and pictures have names');
  const count = await page.evaluate(() => document.querySelectorAll('button, input:not([hidden]), select, canvas[role=img], a, table').length);
  await shown.evaluate(({ elements, observer }) => { observer.disconnect(); elements.forEach((element) => { element.hidden = true; }); });
  assert.equal(named.length, count, named.map((node) => `${node.role.value} ${node.name.value}`).join(', '));
  const mute = await page.evaluate(() => [...document.querySelectorAll('canvas, img')]
    .filter((element) => element.getAttribute('role') !== 'img' && !element.closest('[aria-hidden=true]')).map((element) => element.outerHTML));
  assert.deepEqual(mute, [], 'a screen reader sees all pictures');
  const headings = await page.evaluate(() => [...document.querySelectorAll('h1, h2')].filter((e) => e.offsetParent !== null).map((e) => e.textContent));
  assert.ok(headings.length >= 7, headings.join());
  assert.ok(await page.locator('[aria-live=polite], [role=status]').count() >= 3);
}

/** A part that stands still is outlined in the left picture and told in the sentence. The cameras of this test show none. */
async function checkStillRegions(page) {
  const { left, right, sentence } = await page.evaluate(async () => {
    const { PictureView } = await import('/pictures.js');
    const canvas = document.body.appendChild(document.createElement('canvas'));
    const view = new PictureView(canvas);
    const bitmap = await createImageBitmap(new ImageData(320, 400));
    view.show({ width: 320, height: 200, scale: 2, sequence: 1, landmarks: [], still: [[100, 60, 200, 80]] }, bitmap);
    const zoom = canvas.width / 640;
    const yellow = (x, y, width, height) => {
      const pixels = canvas.getContext('2d').getImageData(zoom * x, zoom * y, zoom * width, zoom * height).data;
      let count = 0;
      for (let i = 0; i < pixels.length; i += 4) if (pixels[i] > 200 && pixels[i + 1] > 150 && pixels[i + 2] < 60) ++count;
      return count;
    };
    const found = { left: yellow(49, 30, 2, 40), right: yellow(320, 0, 320, 200), sentence: view.text() };
    canvas.remove();
    return found;
  });
  assert.ok(left > 20, `${left} px of the outline's left edge`);
  assert.equal(right, 0);
  assert.match(sentence, /1 part of the left picture not used because the view stands still there/);
}

/** Contrast by WCAG 2 of all text with what is behind it, and of the colours that scripts use, below the least for its kind. */
const lowContrasts = () => {
  const kText = 4.5, kGraphics = 3;
  const parse = (colour) => colour.match(/[\d.]+/g).map(Number);
  const linear = (value) => (value / 255 <= 0.04045 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4);
  const luminance = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  const contrast = (one, other) => {
    const [low, high] = [luminance(one), luminance(other)].sort((a, b) => a - b);
    return (high + 0.05) / (low + 0.05);
  };
  const behind = (element) => {
    const colour = parse(getComputedStyle(element).backgroundColor);
    return (colour[3] ?? 1) > 0 ? colour : behind(element.parentElement);
  };
  const low = [];
  const check = (what, front, back, least) => {
    const found = contrast(front, back);
    if (!(found >= least)) low.push(`${what}: ${found.toFixed(2)}`);
  };
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  let checked = 0;
  while (texts.nextNode()) {
    const element = texts.currentNode.parentElement;
    if (!texts.currentNode.textContent.trim() || element.closest('noscript')) continue;
    ++checked;
    check(texts.currentNode.textContent, parse(getComputedStyle(element).color), behind(element), kText);
  }
  if (checked < 50) low.push(`only ${checked} texts`);
  const probe = document.body.appendChild(document.createElement('i'));
  const colour = (name) => {
    probe.style.color = `var(${name})`;
    return parse(getComputedStyle(probe).color);
  };
  for (const back of ['--back', '--panel']) {
    for (const name of ['--text', '--dim', '--accent']) check(`${name} on ${back}`, colour(name), colour(back), kText);
    for (const name of ['--s1', '--s2', '--s3', '--dim']) check(`${name} on ${back}`, colour(name), colour(back), kGraphics);
  }
  for (const back of ['--warning', '--fault']) check(`--text on ${back}`, colour('--text'), colour(back), kText);
  probe.remove();
  const bar = document.getElementById('bar'), chip = document.getElementById('left-chip');
  const shown = [bar.className, chip.className];
  chip.className = 'chip away';
  check('the chip of a camera that is away', parse(getComputedStyle(chip).color), behind(chip), kText);
  for (const level of ['good', 'still', 'bad', 'unknown']) {
    bar.className = level;
    check(`the bar, ${level}`, parse(getComputedStyle(bar).color), behind(bar), kText);
  }
  [bar.className, chip.className] = shown;
  return low;
};

async function checkContrast(page) {
  assert.deepEqual(await page.evaluate(lowContrasts), []);
}

async function checkRecording(page) {
  assert.match(await text(page, 'recording'), /^Not recording/);
  assert.ok(!(await page.locator('#record').isVisible()), 'without the token there is no button');
  await page.getByText('Log in to start and stop recordings').click();
  await page.locator('#token').fill('a-wrong-token-here');
  await page.keyboard.press('Enter');
  await page.getByText('this is not the token').waitFor();
  await page.locator('#token').fill(token);
  await page.keyboard.press('Enter');
  await page.getByRole('button', { name: 'Start recording' }).click();
  await until(page, () => /^Recording to .*: \d\d+ pictures/.test(document.getElementById('recording').textContent));
  await page.getByRole('button', { name: 'Stop recording' }).click();
  await until(page, () => /^Not recording\. The last recording is /.test(document.getElementById('recording').textContent));
}

/** The remedy comes from the troubleshooting page, and its link leads to the entry. */
async function checkHelp(page) {
  await until(page, () => document.getElementById('remedy').textContent !== '');
  const help = await page.context().newPage();
  await help.goto(await page.locator('#help').evaluate((link) => link.href));
  await help.locator('.chosen').waitFor();
  assert.match(await help.locator('h1').innerText(), /^Troubleshooting$/);
  assert.ok(await help.locator('h2').count() >= 7);
  await help.close();
}

async function checkLostCameras(page) {
  await ask('stop cameras');
  await until(page, () => document.getElementById('word').textContent === 'NO CAMERA');
  await until(page, () => /camera(s)? (connecting|stalled)/.test(document.getElementById('cause').textContent));
  for (const side of ['left', 'right']) await until(page, (id) => document.getElementById(id).textContent.endsWith('✗'), `${side}-state`);
  await until(page, () => document.getElementById('speed-now').textContent === '–');
  await until(page, () => document.getElementById('picture').getAttribute('aria-label').includes('left: no picture for'));
  await checkHelp(page);
  await page.screenshot({ path: `${pictures}/lost-cameras.png`, fullPage: true });
  await ask('start cameras');
  await until(page, isValid);
  await until(page, bothDeliver);
}

async function checkRestart(page) {
  await ask('stop cartvod');
  await until(page, () => document.getElementById('connection').textContent.startsWith('Connection lost'));
  assert.equal(await text(page, 'word'), 'NO CONNECTION');
  await ask('start cartvod');
  await until(page, () => document.getElementById('connection').textContent === 'Connected');
  await until(page, isValid);
  await until(page, () => !document.body.classList.contains('stale') && document.getElementById('picture').getAttribute('aria-label'));
  await checkLoadsAndUpdates(page);
}

async function checkOtherScreens() {
  for (const [name, options] of [
    ['dark', { colorScheme: 'dark', reducedMotion: 'reduce' }],
    ['phone', { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true, deviceScaleFactor: 2 }],
  ]) {
    const { page, problems } = await open(options);
    await checkLoadsAndUpdates(page);
    await checkContrast(page);
    const [width, shown] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
    assert.ok(width <= shown, `${name}: ${width} px wide, but the screen has ${shown}`);
    await page.screenshot({ path: `${pictures}/${name}.png`, fullPage: true });
    assert.deepEqual(problems, [], name);
    await page.context().close();
  }
}

const { page, problems } = await open({});
async function step(name, check) {
  await check(page).catch(async (error) => {
    await page.screenshot({ path: `${pictures}/failed.png`, fullPage: true });
    throw new Error(`${name}: ${error.message}\n${await page.locator('body').innerText()}\n${problems.join('\n')}`);
  });
  console.log(`${name}: in order`);
}
await step('loads and updates', checkLoadsAndUpdates);
await step('keyboard', checkKeyboard);
await step('names for screen readers', checkNames);
await step('contrast', checkContrast);
await step('still regions', checkStillRegions);
await page.screenshot({ path: `${pictures}/light.png`, fullPage: true });
await step('other screens', checkOtherScreens);
assert.deepEqual(problems, []);
await step('recording', checkRecording);
await step('lost cameras', checkLostCameras);
await step('restart', checkRestart);
await browser.close();
process.exit(0);
