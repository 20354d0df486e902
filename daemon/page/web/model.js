// The last minute of samples and the path, as the server sends them.

const kSpan = 60e6; // us

export class Model {
  constructor(fields) {
    this.index = Object.fromEntries(fields.map((name, i) => [name, i]));
    this.reset();
  }

  reset() {
    this.samples = [];
    this.path = [];
    this.chosen = null; // a sample that is shown instead of the newest
  }

  get shown() {
    return this.chosen ?? this.newest;
  }

  value(sample, name) {
    return sample[this.index[name]];
  }

  get newest() {
    return this.samples.at(-1);
  }

  setHistory(history) {
    this.samples = history.samples;
    this.path = history.path;
  }

  /** Adds samples that are newer; returns false if some between were missed. */
  add(samples) {
    const last = this.newest ? this.value(this.newest, 'sequence') : -Infinity;
    const added = samples.filter((sample) => this.value(sample, 'sequence') > last);
    const isComplete = added.length === 0 || !this.newest || this.value(added[0], 'sequence') === last + 1;
    for (const sample of added) {
      this.samples.push(sample);
      if (this.value(sample, 'valid')) this.addToPath(sample);
    }
    const begin = this.newest ? this.value(this.newest, 'utime_us') - kSpan : 0;
    let old = 0;
    while (old < this.samples.length && this.value(this.samples[old], 'utime_us') < begin) ++old;
    this.samples.splice(0, old);
    return isComplete;
  }

  addToPath(sample) {
    const last = this.path.at(-1);
    const distance = last && this.value(last, 'epoch') === this.value(sample, 'epoch')
      ? Math.hypot(this.value(last, 'x') - this.value(sample, 'x'), this.value(last, 'y') - this.value(sample, 'y'))
      : Infinity;
    if (distance > 0.1) this.path.push(sample);
    if (this.path.length > 4000) this.path = this.path.filter((_, i) => i % 2 === 0);
  }

  /** [seconds before the newest, value, stddev or null] of the valid samples; null where there is a gap. */
  series(name, stddev, factor = 1) {
    if (!this.newest) return [];
    const end = this.value(this.newest, 'utime_us');
    return this.samples.map((sample) => {
      const value = this.value(sample, name);
      if (value === null) return null;
      const deviation = stddev ? this.value(sample, stddev) : null;
      return [(this.value(sample, 'utime_us') - end) / 1e6, factor * value, deviation === null ? null : factor * deviation];
    });
  }
}
