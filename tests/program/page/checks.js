// Runs in a page, does what a reader does, and tells what it saw to the frame around it.
(async () => {
  const found = {};
  const rest = () => new Promise(done => setTimeout(done, 50));
  const by = id => document.getElementById(id);
  const describe = element => `${element.tagName} ${element.id} ${element.className.baseVal ?? element.className} ${element.textContent.slice(0, 40)}`;
  try {
    await rest();
    // what a link points to is there, and is opened where it was folded away
    const links = [...document.querySelectorAll('a[href^="#"]')];
    found.links = links.length;
    found.lost = links.filter(link => !by(decodeURIComponent(link.hash.slice(1)))).map(link => link.hash);
    found.outside = [...document.querySelectorAll('[src], link[href]')].filter(e => e.id !== 'checks').map(describe);
    const line = document.querySelector('article h4 a');
    if (line) {
      const target = by(decodeURIComponent(line.hash.slice(1)));
      found.folded = !target.closest('details').open;
      line.click();
      await rest();
      found.opened = target.closest('details').open;
      found.line = target.textContent;
    }
    document.querySelectorAll('details').forEach(details => { details.open = true; });
    await rest();

    // nothing is wider than the screen, but for what scrolls by itself
    found.inner = innerWidth;
    found.scroll = document.documentElement.scrollWidth;
    const scrolls = element => {
      for (let at = element; at && at !== document.documentElement; at = at.parentElement) {
        if (['auto', 'scroll'].includes(getComputedStyle(at).overflowX) && at !== document.body) return true;
      }
      return false;
    };
    found.wide = [...document.body.querySelectorAll('*')].filter(element => {
      const box = element.getBoundingClientRect();
      return box.width > 0 && box.right > innerWidth + 1 && !scrolls(element);
    }).slice(0, 5).map(describe);

    // nothing is cut: what hides its overflow has none, neither a text with dots at its end nor a label at the edge of a picture
    const hides = value => ['hidden', 'clip'].includes(value);
    found.cut = [...document.body.querySelectorAll('*')].filter(element => {
      if (element.closest('svg') || !element.clientWidth || !element.textContent.trim()) return false;
      const style = getComputedStyle(element);
      return hides(style.overflowX) && element.scrollWidth > element.clientWidth + 1
        || hides(style.overflowY) && element.scrollHeight > element.clientHeight + 4
        || style.textOverflow !== 'clip' && element.scrollWidth > element.clientWidth;
    }).concat([...document.querySelectorAll('svg text')].filter(text => {
      const [own, around] = [text.getBoundingClientRect(), text.ownerSVGElement.getBoundingClientRect()];
      return own.width > 0 && (own.left < around.left - 1 || own.right > around.right + 1 || own.bottom > around.bottom + 2);
    })).slice(0, 5).map(element => `${describe(element)} ${element.closest('svg')?.getAttribute('aria-label') ?? ''}`);
    // what scrolls by itself shows that there is more: its shadows scroll with it
    found.scrolling = [...document.body.querySelectorAll('*')].filter(element =>
      element.clientWidth && ['auto', 'scroll'].includes(getComputedStyle(element).overflowX) && element.scrollWidth > element.clientWidth + 1);
    found.unmarked = found.scrolling
      .filter(element => !getComputedStyle(element).backgroundAttachment.includes('local')).slice(0, 5).map(describe);
    found.scrolling = found.scrolling.map(describe);

    // labels of pictures in pixels of the screen
    found.pictures = document.querySelectorAll('svg').length;
    found.untitled = [...document.querySelectorAll('svg')].filter(svg => !svg.getAttribute('aria-label') || !svg.closest('figure')).map(describe);
    let least = Infinity;
    for (const text of document.querySelectorAll('svg text')) {
      const size = parseFloat(getComputedStyle(text).fontSize) * Math.hypot(text.getScreenCTM().a, text.getScreenCTM().b);
      if (size < least) { least = size; found.smallest = describe(text); }
    }
    found.label = least;
    found.hover = [...document.querySelectorAll('svg title')].filter(title => /\d/.test(title.textContent)).length;

    // contrast of every text with what is behind it, by WCAG 2
    const parse = colour => {
      const [r, g, b, a = 1] = colour.match(/-?[\d.]+(e-?\d+)?/g).map(Number);
      return colour.startsWith('color(') ? [r, g, b, a] : [r / 255, g / 255, b / 255, a];
    };
    const over = (top, below) => [0, 1, 2].map(i => top[i] * top[3] + below[i] * (1 - top[3])).concat(1);
    const light = ([r, g, b]) => {
      const [x, y, z] = [r, g, b].map(c => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
      return 0.2126 * x + 0.7152 * y + 0.0722 * z;
    };
    const behind = element => {
      const layers = [];
      for (let at = element; at; at = at.parentElement) {
        const layer = parse(getComputedStyle(at).backgroundColor);
        layers.push(layer);
        if (layer[3] === 1) break;
      }
      return layers.reverse().reduce((below, layer) => over(layer, below), [1, 1, 1, 1]);
    };
    let texts = 0;
    found.contrast = Infinity;
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node; (node = walker.nextNode());) {
      const element = node.parentElement;
      if (!node.data.trim() || ['SCRIPT', 'STYLE', 'title', 'OPTION'].includes(element.tagName)) continue;
      const style = getComputedStyle(element);
      if (!element.getClientRects().length || style.visibility === 'hidden') continue;
      const background = behind(element);
      const colour = over(parse(element.closest('svg') ? style.fill : style.color), background);
      const [a, b] = [light(colour), light(background)].sort((x, y) => y - x);
      const contrast = (a + 0.05) / (b + 0.05);
      texts++;
      if (contrast < found.contrast) { found.contrast = contrast; found.faintest = describe(element); }
    }
    found.texts = texts;
    found.paper = light(behind(document.body));

    // sorting and filtering
    const form = by('filter');
    if (form) {
      const entries = [...document.querySelectorAll('article')];
      const seen = () => entries.filter(entry => entry.getBoundingClientRect().height > 0);
      const choose = async (id, value) => {
        by(id).value = value;
        by(id).dispatchEvent(new Event('input', { bubbles: true }));
        await rest();
      };
      found.form = form.getBoundingClientRect().height > 0;
      found.claims = entries.length;
      found.tally = [...document.querySelectorAll('.tally li')].map(li => [li.dataset.w, Number(li.querySelector('b').textContent)]);
      found.words = [];
      for (const option of [...by('word').options].filter(option => option.value && option.value !== '!')) {
        await choose('word', option.value);
        found.words.push([option.value, seen().length, seen().every(entry => entry.dataset.w === option.value), by('shown').textContent]);
      }
      await choose('word', '');
      found.files = [];
      for (const option of [...by('file').options].filter(option => option.value)) {
        await choose('file', option.value);
        found.files.push([option.text, seen().length]);
      }
      await choose('file', '');
      found.searches = {};
      for (const text of window.searches ?? []) {
        await choose('text', text);
        found.searches[text] = seen().map(entry => entry.querySelector('h4').firstChild.data.trim());
      }
      await choose('text', '');
      await choose('sort', 'i');
      found.sorted = [...document.querySelectorAll('article')].map(entry => entry.querySelector('h4').firstChild.data.trim());
      await choose('sort', '');
      found.again = [...document.querySelectorAll('article')].every((entry, place) => entry === entries[place]);
      // a link to an entry that is filtered out shows it
      await choose('word', entries[0].dataset.w);
      const other = entries.find(entry => entry.dataset.w !== entries[0].dataset.w);
      if (other) {
        found.hidden = other.getBoundingClientRect().height === 0;
        location.hash = other.id;
        await rest();
        found.revealed = other.getBoundingClientRect().height > 0;
      }
    }
  } catch (error) {
    found.error = `${error} ${error.stack}`;
  }
  parent.postMessage(JSON.stringify(found), '*');
})();
