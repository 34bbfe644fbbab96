(() => {
  const by = id => document.getElementById(id);
  const form = by('filter'), list = by('list'), shown = by('shown');
  if (!form) return;
  const entries = [...list.querySelectorAll('article')], heads = [...list.querySelectorAll('h3')];
  const order = [...list.children], texts = new Map();
  for (const entry of entries) entry.dataset.w ??= 'proved';
  // an entry is of the file under whose name it stands
  let of = '';
  for (const each of order) each.dataset.f = of = each.dataset.f ?? of;
  // what an entry says, and how its file says it
  const text = entry => {
    if (!texts.has(entry)) {
      const link = entry.querySelector('h4 a');
      let line = link && by(decodeURIComponent(link.hash.slice(1))), words = entry.textContent;
      for (let first = true; line && (first || !line.id); line = line.nextElementSibling, first = false) words += ' ' + line.textContent;
      texts.set(entry, words.toLowerCase());
    }
    return texts.get(entry);
  };
  const name = entry => entry.querySelector('h4').firstChild.data;
  const filter = () => {
    const [word, file, wanted] = ['word', 'file', 'text'].map(id => by(id).value.toLowerCase());
    const counts = new Map();
    let all = 0;
    for (const entry of entries) {
      const said = entry.dataset.w;
      const fits = (!word || (word === '!' ? entry.classList.contains('bad') : said === word))
        && (!file || entry.dataset.f === file) && (!wanted || text(entry).includes(wanted));
      entry.hidden = !fits;
      if (fits) { all++; counts.set(said, (counts.get(said) || 0) + 1); }
    }
    const sorted = by('sort').value !== '';
    for (const head of heads) head.hidden = sorted || !entries.some(e => !e.hidden && e.dataset.f === head.dataset.f);
    const each = [...counts].map(([said, count]) => count + ' ' + said).join(', ');
    shown.textContent = all + ' of ' + entries.length + ' claims' + (each ? ': ' + each : '');
  };
  const sort = () => {
    const key = by('sort').value;
    const value = { w: e => e.dataset.w + ' ' + name(e), i: name }[key];
    const compare = (a, b) => value(a).localeCompare(value(b), 'en', { numeric: true });
    list.append(...(key ? [...heads, ...entries.slice().sort(compare)] : order));
    filter();
  };
  // a place that is folded away or filtered out is shown when something points to it
  const reveal = () => {
    const target = location.hash && by(decodeURIComponent(location.hash.slice(1)));
    if (!target) return;
    if (target.hidden) { form.reset(); sort(); }
    let closed = false;
    for (let at = target; at; at = at.parentElement) if (at.tagName === 'DETAILS' && !at.open) closed = at.open = true;
    if (closed) target.scrollIntoView();
  };
  form.addEventListener('submit', event => event.preventDefault());
  form.addEventListener('input', event => event.target.id === 'sort' ? sort() : filter());
  addEventListener('hashchange', reveal);
  form.hidden = false;
  form.reset();
  filter();
  reveal();
})();
