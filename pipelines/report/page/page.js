// Readings on charts: the pointer (or a finger) shows the values of all lines at its place.
(function () {
  'use strict';
  const LEFT = 62, RIGHT = 706, TOP = 12, BOTTOM = 256;
  const SVG = 'http' + '://www.w3.org/2000/svg';

  function pointsOf(path) {
    return path.getAttribute('d').split(/[ML]/).filter(Boolean).map(p => p.split(' ').map(Number));
  }
  function element(name, attributes, text) {
    const e = document.createElementNS(SVG, name);
    for (const key in attributes) e.setAttribute(key, attributes[key]);
    if (text !== undefined) e.textContent = text;
    return e;
  }
  function format(v) {
    return Math.abs(v) >= 1e5 || (v !== 0 && Math.abs(v) < 1e-3) ? v.toExponential(2) : String(+v.toPrecision(4));
  }

  for (const chart of document.querySelectorAll('svg.chart')) {
    const [x0, x1] = chart.dataset.x.split(' ').map(Number);
    const [y0, y1] = chart.dataset.y.split(' ').map(Number);
    const log = chart.dataset.log === '1';
    const lines = [...chart.querySelectorAll('path.s')].map(p => ({name: p.dataset.name, points: pointsOf(p)}));
    const hover = chart.querySelector('.hover');
    const clear = () => hover.replaceChildren();
    chart.addEventListener('pointerleave', clear);
    chart.addEventListener('pointermove', event => {
      const box = chart.getBoundingClientRect();
      const px = (event.clientX - box.left) / box.width * 720;
      clear();
      if (px < LEFT || px > RIGHT) return;
      hover.append(element('line', {class: 'cursor', x1: px, x2: px, y1: TOP, y2: BOTTOM}));
      const x = x0 + (px - LEFT) / (RIGHT - LEFT) * (x1 - x0);
      const texts = ['at ' + format(x)];
      for (const line of lines) {
        let best = null;
        for (const p of line.points) if (!best || Math.abs(p[0] - px) < Math.abs(best[0] - px)) best = p;
        if (!best) continue;
        const v = y0 + (BOTTOM - best[1]) / (BOTTOM - TOP) * (y1 - y0);
        texts.push((lines.length > 1 ? line.name + ' ' : '') + format(log ? Math.pow(10, v) : v));
      }
      const right = px < (LEFT + RIGHT) / 2;
      texts.forEach((text, i) => hover.append(element('text', {
        class: 'reading', x: right ? px + 8 : px - 8, y: TOP + 14 + 15 * i, 'text-anchor': right ? 'start' : 'end'
      }, text)));
    });
  }
})();
