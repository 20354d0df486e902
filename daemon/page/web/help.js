// Shows the troubleshooting page, at the entry that the address names.
import { render } from '/troubleshooting.js';

const answer = await fetch('/troubleshooting.md');
render(await answer.text(), document.querySelector('main'));

function showEntry() {
  document.querySelector('.chosen')?.classList.remove('chosen');
  const entry = document.getElementById(location.hash.slice(1));
  entry?.classList.add('chosen');
  entry?.scrollIntoView({ block: 'center' });
}
addEventListener('hashchange', showEntry);
showEntry();
