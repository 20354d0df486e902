// docs/troubleshooting.md, which the server sends as text: the remedy of a cause, and the whole as a page.

export const slug = (text) => text.toLowerCase().replaceAll(/[^a-z0-9]+/g, '-').replaceAll(/^-|-$/g, '');

const plain = (markdown) => markdown.replaceAll(/\[([^\]]*)\]\([^)]*\)/g, '$1').replaceAll(/[`*]/g, '');

/** Entries {section, label, text} of the lists: "- *label*: text". */
function entriesOf(markdown) {
  const entries = [];
  let section = '';
  for (const line of markdown.split('\n')) {
    if (line.startsWith('## ')) section = line.slice(3);
    const entry = line.match(/^- (.*?\*): (.*)$/);
    if (entry) entries.push({ section, label: plain(entry[1]), text: plain(entry[2]) });
    else if (/^ +\S/.test(line) && entries.length > 0) entries.at(-1).text += ` ${plain(line.trim())}`;
  }
  return entries;
}

/** Whether the cause contains a message that the label quotes: "begin ... end". */
function isQuoted(label, cause) {
  return [...label.matchAll(/"([^"]+)"/g)].some(([, quoted]) => {
    let at = 0;
    return quoted.split(/\.\.\.|…/).map((part) => part.trim()).filter((part) => part !== '').every((part) => {
      const found = cause.indexOf(part, at);
      at = found + part.length;
      return found >= 0;
    });
  });
}

export class Troubleshooting {
  constructor(markdown) {
    this.entries = entriesOf(markdown);
  }

  /** {cause, remedy, link} of a cause, which may hold its remedy after a semicolon, and of its topic. */
  find(cause, topic) {
    const [said, ...own] = cause.split('; ');
    const entry = this.entries.find((one) => isQuoted(one.label, cause)) ?? this.entries.find((one) => topic && one.label.includes(topic));
    const section = this.entries.find((one) => slug(one.section) === slug(topic))?.section ?? '';
    return { cause: said, remedy: own.join('; ') || entry?.text || '', link: `/help.html#${slug(entry?.label ?? section)}` };
  }
}

/** Appends text with `code`, *emphasis* and [links](of this page only) as elements. */
function appendInline(parent, text) {
  for (const part of text.split(/(`[^`]*`|\*[^*]+\*|\[[^\]]*\]\([^)]*\))/)) {
    const link = part.match(/^\[([^\]]*)\]\((#[^)]*)\)$/);
    const name = link ? 'a' : { '`': 'code', '*': 'em' }[part[0]];
    if (!name || (part.length < 2)) {
      parent.append(plain(part));
      continue;
    }
    const element = parent.appendChild(document.createElement(name));
    if (link) [, element.textContent, element.href] = link;
    else if (name === 'code') element.textContent = part.slice(1, -1);
    else appendInline(element, part.slice(1, -1));
  }
}

/** Shows the text as headings, lists, code and paragraphs. */
export function render(markdown, parent) {
  let list = null, code = null;
  const add = (name, text, id = '') => {
    const element = (name === 'li' ? list : parent).appendChild(document.createElement(name));
    appendInline(element, text);
    if (id) element.id = slug(id);
    return element;
  };
  for (const line of markdown.split('\n')) {
    if (line.startsWith('```')) code = code ? null : add('pre', '');
    else if (code) code.textContent += `${line}\n`;
    else if (/^ +\S/.test(line) && list) appendInline(list.lastChild, ` ${line.trim()}`);
    else if (line.startsWith('- ')) {
      list ??= parent.appendChild(document.createElement('ul'));
      add('li', line.slice(2), plain(line.match(/^- (.*?\*): /)?.[1] ?? ''));
    } else {
      list = null;
      const heading = line.match(/^(##?) (.*)$/);
      if (heading) add(heading[1] === '#' ? 'h1' : 'h2', heading[2], heading[2]);
      else if (line.trim()) add('p', line);
    }
  }
}
