// Buttons and slider of a replay. The slider shows pairs that were processed before, as they were then.
import { post } from '/connection.js';
import { byId, setText } from '/tables.js';

export class ReplayControls {
  constructor(onChosen) {
    this.chosen = null; // pair; null: the newest
    this.state = null;
    byId('replay').hidden = false;
    byId('replay-run').addEventListener('click', () => post('/control', this.state?.state === 'running' ? 'replay/pause' : 'replay/run'));
    byId('replay-step').addEventListener('click', () => {
      this.choose(null);
      post('/control', 'replay/step');
    });
    byId('replay-newest').addEventListener('click', () => this.choose(null));
    byId('pair').addEventListener('input', () => this.choose(Number(byId('pair').value)));
    this.onChosen = onChosen;
  }

  choose(pair) {
    this.chosen = pair;
    this.show(this.state);
    this.onChosen(pair);
  }

  show(state) {
    if (!state) return;
    this.state = state;
    const names = { running: 'Pause', paused: 'Continue', ended: 'Ended' };
    setText(byId('replay-run'), names[state.state]);
    byId('replay-run').disabled = state.state === 'ended';
    byId('replay-step').disabled = state.state === 'ended';
    const slider = byId('pair');
    slider.min = state.first;
    slider.max = state.last;
    if (this.chosen === null) slider.value = state.last;
    const of = state.total > 0 ? ` of ${state.total}` : '';
    const stored = this.chosen === null ? '' : ', as it was processed';
    setText(byId('pair-text'), `${slider.value}${of}${stored}; processed up to ${state.last}`);
  }
}
