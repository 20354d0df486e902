// The two pictures with their landmarks: side by side, one over the other, and with epipolar lines.

// Colour scale "viridis" of matplotlib (CC0), readable with colour blindness and in grey.
const kScale = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];

function scaleColour(share) {
  const at = Math.min(Math.max(share, 0), 1) * (kScale.length - 1);
  const low = Math.min(Math.floor(at), kScale.length - 2), part = at - low;
  return `rgb(${kScale[low].map((value, i) => Math.round(value + part * (kScale[low + 1][i] - value))).join(' ')})`;
}

// Landmark: [left x, left y, right x, right y, weight, age, inverse depth].
const kLegends = {
  weight: { low: '0', high: '1', share: (landmark) => landmark[4] },
  age: { low: '1 pair', high: '64 pairs', share: (landmark) => Math.log2(Math.max(landmark[5], 1)) / 6 },
  depth: { low: 'far', high: '2 m', share: (landmark) => (landmark[6] === null ? null : Math.sqrt(Math.max(landmark[6], 0) / 0.5)) },
};

export class PictureView {
  constructor(canvas) {
    this.canvas = canvas;
    this.view = 'both';
    this.colour = 'weight';
    this.row = null;
    this.frame = null;
    this.ages = [0, 0];
  }

  /** Ages of each camera's newest picture, s; 0: new, null: none yet. */
  setAges(ages) {
    const shown = ages.map((age) => (age === null ? null : Math.floor(age)));
    if (shown.every((age, side) => age === this.ages[side])) return;
    this.ages = shown;
    const names = ['left', 'right'].map((name, side) => this.sideText(name, side));
    this.canvas.setAttribute('aria-label', `Pictures of both cameras with landmarks: ${names.join('; ')}`);
    this.draw();
  }

  /** `pictures`: of a frame's JSON. `bitmap`: both pictures, the left above the right. */
  show(pictures, bitmap) {
    this.frame?.bitmap.close();
    this.frame = { landmarks: [], still: [], ...pictures, bitmap };
    this.draw();
  }

  draw() {
    if (!this.frame) return;
    const { width, height } = this.frame;
    const columns = this.view === 'overlay' ? 1 : 2;
    const zoom = Math.min(2, Math.max(1, Math.ceil(this.canvas.clientWidth * devicePixelRatio / (columns * width))));
    if (this.canvas.width !== zoom * columns * width || this.canvas.height !== zoom * height) {
      this.canvas.width = zoom * columns * width;
      this.canvas.height = zoom * height;
    }
    const context = this.canvas.getContext('2d');
    context.setTransform(zoom, 0, 0, zoom, 0, 0);
    const at = [[0, 0], [columns === 2 ? width : 0, 0]];
    this.drawPicture(context, 0, at[0], 1);
    this.drawPicture(context, 1, at[1], this.view === 'overlay' ? 0.5 : 1);
    if (this.view === 'epipolar') this.drawEpipolarLines(context);
    this.drawStillRegions(context);
    this.drawLandmarks(context, at);
    if (this.view === 'overlay') this.drawName(context, 'left over right', at[0]);
    else ['left', 'right'].forEach((name, side) => this.drawSide(context, name, side, at[side]));
  }

  /** The name of a picture; darkens one that is not new and says how old it is. */
  drawSide(context, name, side, [x, y]) {
    if (this.ages[side] !== 0) {
      context.fillStyle = 'rgb(0 0 0 / 65%)';
      context.fillRect(x, y, this.frame.width, this.frame.height);
    }
    this.drawName(context, this.sideText(name, side), [x, y]);
  }

  sideText(name, side) {
    const age = this.ages[side];
    if (age === 0) return name;
    return `${name}: ${age === null ? 'no picture yet' : `no picture for ${age} s`}`;
  }

  /** Names a picture in its upper left corner, 13 px high on the screen. */
  drawName(context, name, [x, y]) {
    const size = 13 * this.canvas.width / this.canvas.clientWidth / context.getTransform().a;
    context.font = `${size}px system-ui, sans-serif`;
    context.fillStyle = 'rgb(0 0 0 / 60%)';
    context.fillRect(x, y, context.measureText(name).width + size, 1.5 * size);
    context.fillStyle = '#fff';
    context.fillText(name, x + size / 2, y + 1.1 * size);
  }

  drawPicture(context, side, [x, y], alpha) {
    const { bitmap, width, height } = this.frame;
    context.globalAlpha = alpha;
    context.drawImage(bitmap, 0, side * height, width, height, x, y, width, height);
    context.globalAlpha = 1;
  }

  /** px of the canvas, of a landmark in one picture; null without an observation there. */
  position(landmark, side, [x, y]) {
    if (landmark[2 * side] === null) return null;
    const toCanvas = (pixel) => (pixel + 0.5) / this.frame.scale - 0.5;
    return [x + toCanvas(landmark[2 * side]), y + toCanvas(landmark[2 * side + 1])];
  }

  /** Dashed outlines of the parts of the left picture that stand still, on black so that they show on any picture. */
  drawStillRegions(context) {
    for (const region of this.frame.still) {
      const [x, y, width, height] = region.map((pixel) => pixel / this.frame.scale);
      for (const [colour, dash] of [['#000', []], ['#ffd400', [6, 4]]]) {
        context.strokeStyle = colour;
        context.lineWidth = 2;
        context.setLineDash(dash);
        context.strokeRect(x, y, width, height);
      }
      context.setLineDash([]);
    }
  }

  drawLandmarks(context, at) {
    const legend = kLegends[this.colour];
    if (!legend) return;
    const radius = Math.max(1.3 * this.canvas.width / this.canvas.clientWidth / context.getTransform().a, Math.min(this.frame.width / 260, 3));
    for (const landmark of this.frame.landmarks) {
      const share = legend.share(landmark);
      context.fillStyle = share === null ? '#fff' : scaleColour(share);
      context.strokeStyle = '#000';
      context.lineWidth = 0.6;
      for (const side of this.view === 'overlay' ? [0] : [0, 1]) {
        const place = this.position(landmark, side, at[side]);
        if (!place) continue;
        context.beginPath();
        context.arc(place[0], place[1], radius, 0, 2 * Math.PI);
        context.fill();
        context.stroke();
      }
      if (this.view === 'overlay') this.drawDisparity(context, landmark, at);
    }
  }

  drawDisparity(context, landmark, at) {
    const left = this.position(landmark, 0, at[0]), right = this.position(landmark, 1, at[1]);
    if (!right) return;
    context.strokeStyle = context.fillStyle;
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(...left);
    context.lineTo(...right);
    context.stroke();
  }

  /** Rows of rectified pictures are epipolar lines: a point of the left picture lies on the same row in the right one. */
  drawEpipolarLines(context) {
    const { width, height } = this.frame;
    context.strokeStyle = 'rgb(255 255 255 / 35%)';
    context.lineWidth = 0.8;
    for (let y = height / 12; y < height; y += height / 12) {
      context.beginPath();
      context.moveTo(0, y);
      context.lineTo(2 * width, y);
      context.stroke();
    }
    if (this.row === null) return;
    context.strokeStyle = '#ffd400';
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(0, this.row);
    context.lineTo(2 * width, this.row);
    context.stroke();
  }

  legend() {
    return kLegends[this.colour] ?? null;
  }

  /** The picture as a sentence. */
  text(isStanding) {
    if (!this.frame) return 'No pictures yet';
    if (this.frame.sequence === null) return 'No pair: each camera\'s own pictures, not rectified.';
    if (this.ages.some((age) => age !== 0)) return `Pair ${this.frame.sequence}, the last one.`;
    const landmarks = this.frame.landmarks;
    if (isStanding && landmarks.length === 0) return `Pair ${this.frame.sequence}: standstill. Landmarks are estimated, and drawn, while the cart moves.`;
    const inStereo = landmarks.filter((landmark) => landmark[2] !== null);
    const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
    const parts = [`Pair ${this.frame.sequence}: ${landmarks.length} landmarks, ${inStereo.length} also in the right picture`];
    if (landmarks.length > 0) {
      parts.push(`median weight ${median(landmarks.map((landmark) => landmark[4])).toFixed(2)}`);
      parts.push(`median age ${median(landmarks.map((landmark) => landmark[5]))} pairs`);
    }
    const depths = landmarks.filter((landmark) => landmark[6] > 0).map((landmark) => 1 / landmark[6]);
    if (depths.length > 0) parts.push(`median depth ${median(depths).toFixed(1)} m`);
    if (inStereo.length > 0) {
      const rows = inStereo.map((landmark) => Math.abs(landmark[1] - landmark[3]));
      parts.push(`median difference of the rows ${median(rows).toFixed(2)} px`);
    }
    const still = this.frame.still.length;
    if (still > 0) parts.push(`${still} ${still === 1 ? 'part' : 'parts'} of the left picture not used because the view stands still there`);
    return parts.join(', ') + '.';
  }
}

export function drawLegend(canvas) {
  const context = canvas.getContext('2d');
  for (let x = 0; x < canvas.width; ++x) {
    context.fillStyle = scaleColour(x / (canvas.width - 1));
    context.fillRect(x, 0, 1, canvas.height);
  }
}
