// Plots of a report as inline SVG, drawn anew at each width.
'use strict';

const floeCharts = (() => {
  const names = 'http://www.w3.org/2000/svg';  // of SVG's elements; nothing is loaded from it
  const all = [];

  function node(parent, kind, attributes = {}, text = '') {
    const made = document.createElementNS(names, kind);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== '') made.textContent = text;
    parent.append(made);
    return made;
  }

  function element(parent, kind, className = '', text = '') {
    const made = document.createElement(kind);
    if (className) made.className = className;
    if (text !== '') made.textContent = text;
    parent.append(made);
    return made;
  }

  function stepOf(span, most) {
    const rough = span / most, size = 10 ** Math.floor(Math.log10(rough));
    return [1, 2, 5, 10].map(k => k * size).find(step => step >= rough * 0.999);
  }

  function ticksOf(low, high, log, most) {
    const found = [];
    if (log) {
      const first = Math.floor(Math.log10(low) - 1e-9), last = Math.floor(Math.log10(high) + 1e-9);
      const decades = Math.log10(high / low), every = Math.max(1, Math.round(decades / most));
      for (const heads of 3 * decades <= most ? [[1, 2, 5]] : [[1], [1, 3], [1, 2, 5]]) {
        found.length = 0;
        for (let power = first; power <= last; power += every) {
          for (const head of heads) {
            const value = Number(`${head}e${power}`);
            if (value >= low * 0.9999 && value <= high * 1.0001) found.push(value);
          }
        }
        if (found.length > 1) return found;
      }
      return ticksOf(low, high, false, most);
    }
    const step = stepOf(high - low, most);
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) {
      found.push(k * step);
    }
    return found;
  }

  // 1.5e-7 and 120000 with a power of ten, others plain.
  function label(value) {
    if (value === 0) return '0';
    const size = Math.abs(value);
    if (size >= 1e5 || size < 1e-3) {
      const power = Math.floor(Math.log10(size) + 1e-9), head = value / 10 ** power;
      const digits = String(power).replace('-', '\u2212').split('').map(
        c => '\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079'[c] ||
          '\u207b').join('');
      const start = Math.abs(head - 1) < 1e-6 ? '' : `${Number(head.toPrecision(3))}\u00b7`;
      return `${start}10${digits}`.replace('-', '\u2212');
    }
    return String(Number(value.toPrecision(6))).replace('-', '\u2212');
  }

  function rangeOf(series, axis, log) {
    let low = Infinity, high = -Infinity;
    for (const one of series) {
      for (const value of one[axis]) {
        if (value === null || log && !(value > 0)) continue;
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    return low <= high ? [low, high] : log ? [1, 10] : [0, 1];
  }

  function widened([low, high], log, zero) {
    if (log) {
      const more = low < high ? (high / low) ** 0.04 : 2;
      return [low / more, high * more];
    }
    if (zero) [low, high] = [Math.min(0, low), Math.max(0, high)];
    if (low === high) [low, high] = [low - 0.5, high + 0.5];
    const room = 0.05 * (high - low);
    return [low < 0 || !zero ? low - room : low, high > 0 || !zero ? high + room : high];
  }

  function scaleOf([low, high], [from, to], log) {
    const f = log ? Math.log10 : value => value;
    const a = f(low), b = f(high);
    return value => from + (f(value) - a) / (b - a) * (to - from);
  }

  function pathOf(one, x, y, spec) {
    let text = '', pen = 'M';
    for (let k = 0; k < one.x.length; ++k) {
      const bad = one.y[k] === null || spec.logX && !(one.x[k] > 0) || spec.logY && !(one.y[k] > 0);
      if (bad) { pen = 'M'; continue; }
      const px = x(one.x[k]).toFixed(1), py = y(one.y[k]).toFixed(1);
      text += one.step && pen === 'L' ? `H${px}V${py}` : `${pen}${px} ${py}`;
      pen = 'L';
    }
    return text;
  }

  function drawSeries(plot, one, x, y, spec) {
    if (one.points) {
      one.x.forEach((value, k) => node(plot, 'circle', {
        cx: x(value).toFixed(1), cy: y(one.y[k]).toFixed(1), r: one.size || 3.5, fill: one.colour,
        stroke: '#fff', 'stroke-width': 0.8}));
      return;
    }
    node(plot, 'path', {d: pathOf(one, x, y, spec), fill: 'none', stroke: one.colour,
                        'stroke-width': one.width || 1.4, 'stroke-linejoin': 'round',
                        'stroke-dasharray': one.dash || 'none', opacity: one.opacity || 1});
  }

  function drawAxes(svg, spec, box, x, y, ranges) {  // before what the plot shows
    const [left, top, right, bottom] = box;
    const most = Math.max(2, Math.floor((right - left) / 58));
    for (const value of ticksOf(...ranges[0], spec.logX, most)) {
      const at = x(value).toFixed(1);
      node(svg, 'line', {x1: at, x2: at, y1: top, y2: bottom, class: 'grid'});
      node(svg, 'text', {x: at, y: bottom + 16, class: 'tick', 'text-anchor': 'middle'},
           spec.tickX ? spec.tickX(value) : label(value));
    }
    for (const value of ticksOf(...ranges[1], spec.logY, Math.floor((bottom - top) / 38))) {
      const at = y(value).toFixed(1);
      node(svg, 'line', {x1: left, x2: right, y1: at, y2: at, class: 'grid'});
      node(svg, 'text', {x: left - 6, y: Number(at) + 4, class: 'tick', 'text-anchor': 'end'},
           label(value));
    }
    node(svg, 'line', {x1: left, x2: right, y1: bottom, y2: bottom, class: 'axis'});
    node(svg, 'text', {x: (left + right) / 2, y: bottom + 34, class: 'label',
                       'text-anchor': 'middle'}, spec.labelX);
    node(svg, 'text', {x: 4, y: 13, class: 'label'}, spec.labelY);
  }

  function nearest(values, wanted) {
    let best = 0;
    for (let k = 1; k < values.length; ++k) {
      if (Math.abs(values[k] - wanted) < Math.abs(values[best] - wanted)) best = k;
    }
    return best;
  }

  function readout(spec, value) {
    const words = [];
    for (const one of spec.series) {
      if (one.silent || !one.x.length) continue;
      const k = nearest(one.x, value);
      if (one.y[k] !== null) words.push(`${one.name} ${label(Number(one.y[k].toPrecision(4)))}`);
    }
    return `${label(Number(value.toPrecision(4)))} ${spec.unitX}: ${words.join(', ')}`;
  }

  function listen(chart, svg, said, box, inverse) {
    svg.addEventListener('pointermove', event => {
      const at = event.clientX - svg.getBoundingClientRect().left;
      if (at < box[0] || at > box[2]) return;
      said.textContent = readout(chart.spec, inverse(at));
    });
    svg.addEventListener('pointerleave', () => { said.textContent = '\u00a0'; });
  }

  function draw(chart) {
    const {spec, holder} = chart;
    const width = Math.max(240, holder.clientWidth), height = spec.height || 270;
    if (chart.drawn === width) return;
    chart.drawn = width;
    holder.replaceChildren();
    const svg = node(holder, 'svg', {width, height, viewBox: `0 0 ${width} ${height}`,
                                     role: 'img', 'aria-label': spec.title});
    const box = [58, 24, width - 12, height - 42];
    const ranges = [spec.rangeX || rangeOf(spec.series, 'x', spec.logX),
                    widened(spec.rangeY || rangeOf(spec.series, 'y', spec.logY), spec.logY,
                            spec.zero !== false)];
    if (ranges[0][0] === ranges[0][1] || spec.series.some(one => one.points) && !spec.time) {
      ranges[0] = widened(ranges[0], spec.logX, false);
    }
    const x = scaleOf(ranges[0], [box[0], box[2]], spec.logX);
    const y = scaleOf(ranges[1], [box[3], box[1]], spec.logY);
    drawAxes(svg, spec, box, x, y, ranges);
    const clip = `clip${all.indexOf(chart)}`;
    node(node(svg, 'clipPath', {id: clip}), 'rect', {
      x: box[0], y: box[1] - 4, width: box[2] - box[0] + 4, height: box[3] - box[1] + 8});
    const plot = node(svg, 'g', {'clip-path': `url(#${clip})`});
    for (const one of spec.series) drawSeries(plot, one, x, y, spec);
    chart.cursor = node(svg, 'line', {y1: box[1], y2: box[3], class: 'cursor',
                                      visibility: 'hidden'});
    chart.x = x;
    const f = spec.logX ? Math.log10 : v => v, g = spec.logX ? v => 10 ** v : v => v;
    listen(chart, svg, chart.said, box, at => g(
      f(ranges[0][0]) + (at - box[0]) / (box[2] - box[0]) * (f(ranges[0][1]) - f(ranges[0][0]))));
  }

  function legend(parent, series) {
    const shown = series.filter(one => one.name && !one.silent);
    if (shown.length < 2) return;
    const line = element(parent, 'p', 'legend');
    for (const one of shown) {
      const entry = element(line, 'span', 'entry');
      const mark = element(entry, 'i', one.points ? 'dot' : one.dash ? 'line dashed' : 'line');
      mark.style.setProperty('--colour', one.colour);
      entry.append(one.name);
    }
  }

  // spec: {title, labelX, labelY, unitX, logX, logY, rangeX, zero, time, series: [{name, colour, x,
  // y, points, step, dash, silent}]}
  function chart(parent, spec) {
    const figure = element(parent, 'figure', 'chart');
    element(figure, 'figcaption', '', spec.title);
    legend(figure, spec.series);
    const holder = element(figure, 'div', 'holder');
    const made = {spec, holder, said: element(figure, 'p', 'said', '\u00a0'), drawn: 0};
    all.push(made);
    draw(made);
    new ResizeObserver(() => draw(made)).observe(holder);
    return made;
  }

  // A line at this time in all plots over time.
  function setTime(time) {
    for (const {spec, cursor, x} of all) {
      if (!spec.time || !cursor) continue;
      cursor.setAttribute('visibility', 'visible');
      cursor.setAttribute('x1', x(time));
      cursor.setAttribute('x2', x(time));
    }
  }

  // From white over orange to a dark red.
  function heat(share) {
    const stops = [[255, 250, 235], [253, 204, 138], [239, 101, 72], [127, 0, 0]];
    const at = Math.min(2.999, Math.max(0, share) * 3), k = Math.floor(at), f = at - k;
    return `rgb(${stops[k].map((c, i) => Math.round(c + f * (stops[k + 1][i] - c)))})`;
  }

  function drawMap(made) {
    const {spec, holder} = made;
    const width = Math.max(240, holder.clientWidth), height = 300;
    if (made.drawn === width) return;
    made.drawn = width;
    holder.replaceChildren();
    const svg = node(holder, 'svg', {width, height, viewBox: `0 0 ${width} ${height}`,
                                     role: 'img', 'aria-label': spec.title});
    const box = [58, 24, width - 78, height - 42], {edgesX, edgesY, values} = spec;
    const ranges = [[edgesX[0], edgesX.at(-1)], [edgesY[0], edgesY.at(-1)]];
    const x = scaleOf(ranges[0], [box[0], box[2]]), y = scaleOf(ranges[1], [box[3], box[1]]);
    const largest = Math.max(...values.flat());
    drawAxes(svg, spec, box, x, y, ranges);
    values.forEach((row, j) => row.forEach((value, i) => {
      if (value === null) return;
      const cell = node(svg, 'rect', {
        x: x(edgesX[i]), y: y(edgesY[j + 1]), width: x(edgesX[i + 1]) - x(edgesX[i]) + 0.3,
        height: y(edgesY[j]) - y(edgesY[j + 1]) + 0.3, fill: heat(Math.sqrt(value / largest))});
      cell.addEventListener('pointermove', () => {
        made.said.textContent = `${label(Number(value.toPrecision(3)))} ${spec.unit} at ` +
          `${label(Number(((edgesX[i] + edgesX[i + 1]) / 2).toPrecision(3)))} ${spec.unitX}, ` +
          `${label(Number(((edgesY[j] + edgesY[j + 1]) / 2).toPrecision(3)))} m`;
      });
    }));
    if (ranges[1][0] < 0 && ranges[1][1] > 0) {
      node(svg, 'line', {x1: box[0], x2: box[2], y1: y(0), y2: y(0), class: 'water'});
      node(svg, 'text', {x: box[2] - 4, y: y(0) - 4, class: 'tick water-word',
                         'text-anchor': 'end'}, 'still water');
    }
    drawScale(svg, width - 62, box, largest, spec.unit);
  }

  function drawScale(svg, left, box, largest, unit) {
    const steps = 40, size = (box[3] - box[1]) / steps;
    for (let k = 0; k < steps; ++k) {
      node(svg, 'rect', {x: left, y: box[3] - (k + 1) * size, width: 12, height: size + 0.3,
                         fill: heat((k + 0.5) / steps)});
    }
    for (const share of [0, 0.25, 0.5, 0.75, 1]) {  // colours go with the root
      node(svg, 'text', {x: left + 16, y: box[3] - share * (box[3] - box[1]) + 4, class: 'tick'},
           label(Number((share * share * largest).toPrecision(2))));
    }
    node(svg, 'text', {x: left, y: 13, class: 'label'}, unit);
  }

  function map(parent, spec) {
    const figure = element(parent, 'figure', 'chart');
    element(figure, 'figcaption', '', spec.title);
    const holder = element(figure, 'div', 'holder');
    const made = {spec, holder, said: element(figure, 'p', 'said', '\u00a0'), drawn: 0};
    drawMap(made);
    new ResizeObserver(() => drawMap(made)).observe(holder);
  }

  return {chart, map, setTime, element, label};
})();
