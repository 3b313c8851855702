// Builds the page of a report from its data.
'use strict';

(() => {
  const report = JSON.parse(document.getElementById('data').textContent);
  const {chart, map, setTime, element, label} = floeCharts;
  const page = document.getElementById('page');
  const short = (value, digits = 4) => (
    value === null || value === undefined ? '\u2013' : label(Number(value.toPrecision(digits))));
  window.floe = {report, ready: false, view: null};

  function newtons(value) {
    if (value === null || value === undefined) return '\u2013';
    for (const [size, unit] of [[1e6, 'MN'], [1e3, 'kN']]) {
      if (Math.abs(value) >= size) return `${short(value / size)} ${unit}`;
    }
    return `${short(value)} N`;
  }

  function kilograms(value) {
    return value >= 1000 ? `${short(value / 1000)} t` : `${short(value)} kg`;
  }

  function section(id, title) {
    const made = element(page, 'section');
    made.id = id;
    element(made, 'h2', '', title);
    sections.push([id, title]);
    return made;
  }
  const sections = [];

  function table(parent, rows, {head = null, numbers = [], className = ''} = {}) {
    const made = element(element(parent, 'div', 'scroll'), 'table', className);
    const kind = k => (numbers.includes(k) ? 'number' : '');
    if (head) {
      const row = element(element(made, 'thead'), 'tr');
      head.forEach((word, k) => element(row, 'th', kind(k), word));
    }
    const body = element(made, 'tbody');
    for (const cells of rows) {
      const row = element(body, 'tr');
      cells.forEach((cell, k) => {
        const made = element(row, !head && k === 0 ? 'th' : 'td', kind(k));
        if (cell instanceof Node) made.append(cell);
        else made.textContent = cell;
      });
    }
    return made;
  }

  function headline(parent, entries) {
    const line = element(parent, 'div', 'headline');
    for (const [value, words] of entries) {
      const box = element(line, 'div');
      element(box, 'b', '', value);
      element(box, 'span', '', words);
    }
  }

  function header() {
    const made = element(page, 'header');
    element(made, 'h1', '', report.title);
    element(made, 'p', 'soft', report.kind === 'run' ? 'report of a run of floe' :
      `report of an ensemble of ${report.runs.rows.length} runs of floe`);
    return element(page, 'nav');
  }

  // -- loads ----------------------------------------------------------------------------------
  function statisticsOf(one) {
    const s = one.statement, {peaks, trend} = s;
    const band = s.mean_band ? ` (95 % band ${newtons(s.mean_band[0])} to ` +
      `${newtons(s.mean_band[1])})` : '';
    const rows = [
      ['component', s.component], ['filter', s.filter],
      ['record', `${s.seconds.length > 1 ? `${s.seconds.length} of ` : ''}` +
        `${[...new Set(s.seconds.map(v => short(v)))].slice(0, 3).join(', ')} s after ` +
        `${short(s.start)} s of start-up, rows every ${short(s.interval, 3)} s`],
      ['mean', newtons(s.mean) + band], ['deviation in time', newtons(s.deviation)],
      ['largest, filtered', newtons(Math.max(...s.largest_of_runs))],
      ['largest over a row', `${newtons(s.largest_of_an_interval)} (unfiltered)`],
      ['largest of a step', `${newtons(s.largest_of_a_step)} (norm of the force, unfiltered)`],
      ['blocks', `${s.maxima.length} of ${short(s.block)} s${s.block_is_run ?
        ': the whole run, which is shorter than the block asked for' : ''}`],
      ['separate peaks', peaks.number ? `${peaks.number} above the mean, ` +
        `${newtons(peaks.mean_height)} on average` + (peaks.mean_spacing ?
        `, ${short(peaks.mean_spacing, 3)} s apart` : '') : 'none'],
      ['trend', trend ? `${short(100 * trend.slope, 2)} % of the mean a second, p ` +
        `${short(trend.p, 2)} (Mann-Kendall, ${trend.blocks} blocks)` +
        `${trend.p < 0.05 ? ': not stationary' : ''}` :
        'unknown: the record is too short for 4 independent blocks']];
    return rows;
  }

  function gumbelOf(parent, law) {
    if (!law) {
      element(parent, 'p', 'soft', 'No law of maxima: it needs at least two that differ. One run ' +
        'is one draw; an ensemble of seeds gives the law.');
      return;
    }
    element(parent, 'h3', '', 'Gumbel\u2019s law of the maxima');
    element(parent, 'p', law.p < 0.05 || law.weak ? 'warning' : 'soft',
            `Anderson-Darling ${short(law.anderson_darling, 3)}, p ${short(law.p, 2)}` +
            `${law.p < 0.05 ? ': the law does not fit' : ''}` +
            `${law.weak ? '; weak: fewer than 10 maxima' : ''}`);
    table(parent, law.levels.map(row => [
      row.yearly ? `${row.yearly} a year` : `1 in ${short(1 / row.probability)} blocks`,
      ...['moments', 'likelihood'].flatMap(m => [
        newtons(row[m][0]), `${newtons(row[m][1])} to ${newtons(row[m][2])}`])]),
      {head: ['exceeded in', 'L-moments', 'band', 'likelihood', 'band'], numbers: [1, 2, 3, 4]});
  }

  function loadSections(one) {
    const axis = `load [${one.unit}]`, s = one.statement;
    const made = section(`load-${one.name}`, `Load on ${one.name}`);
    headline(made, [
      [newtons(s.mean), 'mean'], [newtons(Math.max(...s.largest_of_runs)), 'largest, filtered'],
      [newtons(s.largest_of_a_step), 'largest of a step, unfiltered'],
      [s.peaks.mean_spacing ? `${short(s.peaks.mean_spacing, 3)} s` : '\u2013',
       'between peaks, on average']]);
    const time = {labelX: 'time [s]', unitX: 's', time: true};
    chart(made, {...time, title: `Load on ${one.name}, ${s.component}`, labelY: axis, height: 320,
                 series: one.course});
    const pair = element(made, 'div', 'pair');
    chart(pair, {...time, title: 'Components, filtered', labelY: `force [${one.unit}]`,
                 series: one.components});
    chart(pair, {...time, title: 'Running mean, unfiltered: it settles if the load is stationary',
                 labelY: axis, series: one.running});
    chart(pair, {title: 'Spectrum (Welch, unfiltered)', labelX: 'frequency [Hz]', unitX: 'Hz',
                 labelY: `density [${one.unit}\u00b2/Hz]`, logX: true, logY: true,
                 series: one.spectrum});
    iceCharts(pair, one);
    element(made, 'h3', '', 'Statistics');
    table(made, statisticsOf(one), {className: 'facts'});
    gumbelOf(made, s.gumbel);
  }

  function iceCharts(parent, one) {
    if (one.map) {
      const what = one.map.plane ? 'along the plane [m]' :
        'angle from where the ice comes [degrees]';
      const figure = element(parent, 'div');
      map(figure, {title: `Where the force on ${one.name} acts: mean pressure`, labelX: what,
                   labelY: 'height above still water [m]', unit: 'kPa',
                   unitX: one.map.plane ? 'm' : 'degrees', ...one.map});
      element(figure, 'p', 'soft', 'The resultant of all contacts at each row, where its line of ' +
        'action enters the surface; force over all rows and over the area of the cell. Contacts ' +
        'at several places count where their resultant acts. ' +
        `${short(100 * one.map.share, 3)} % of the impulse is on the map.`);
    }
    const {ice} = one;
    if (ice.missing) return;
    const {area, pressure, law} = ice.pressure_area;
    if (area.length > 2) {
      const series = [{x: area, y: pressure.map(p => p / 1000), name: 'frames', points: true,
                       colour: '#22577a', size: 3}];
      if (law) {
        const ends = [Math.min(...area), Math.max(...area)];
        const name = `${short(law.c / 1000, 3)} kPa (A/m\u00b2)^${short(-law.m, 2)}`;
        series.push({x: ends, y: ends.map(a => law.c / 1000 * a ** -law.m), name,
                     colour: '#c1440e'});
      }
      chart(parent, {title: 'Pressure against contact area, at the frames', unitX: 'm\u00b2',
                     labelX: 'contact area [m\u00b2]', labelY: 'pressure [kPa]', logX: true,
                     logY: true, series});
    }
    if (ice.profile) profileChart(parent, ice.profile);
  }

  function profileChart(parent, profile) {
    const line = (key, name, colour, dash) => (
      {x: profile.distance, y: profile[key], name, colour, dash});
    chart(parent, {title: 'The pile at the end, mean and extreme', labelX:
      'distance from the waterline [m]', unitX: 'm', labelY: 'height [m]', series: [
      line('top', 'mean top', '#22577a'), line('bottom', 'mean bottom', '#4c956c'),
      line('highest', 'highest', '#22577a', '3 3'), line('deepest', 'deepest', '#4c956c', '3 3')]});
  }

  // -- energies, fragments --------------------------------------------------------------------
  function energySection(energies) {
    const made = section('energy', 'Energy ledger');
    chart(made, {title: 'Energies since the start', labelX: 'time [s]', unitX: 's', time: true,
                 labelY: `energy [${energies.unit}]`, height: 300, series: energies.course});
    if (energies.error !== null) {
      element(made, 'p', 'soft', `What is put in less what is stored and lost leaves at most ` +
        `${short(energies.error / energies.size, 3)} ${energies.unit}, ` +
        `${short(100 * energies.error_share, 2)} % of the largest term.`);
    } else {
      element(made, 'p', 'soft', 'Statics keep no account of the work that is put in.');
    }
    table(made, energies.rows.map(row => [
      row.name, row.kind, short(row.end / energies.size)]),
      {head: ['energy', 'kind', `since the start [${energies.unit}]`], numbers: [2]});
  }

  function fragmentSection(fragments) {
    const made = section('fragments', 'Fragments');
    headline(made, [[String(fragments.number), 'fragments'], [String(fragments.broken),
      'beams broken'], [String(fragments.single), 'single bodies'],
      [fragments.largest.length ? kilograms(fragments.largest[0][1]) : '\u2013', 'the heaviest']]);
    const pair = element(made, 'div', 'pair');
    chart(pair, {title: 'Breaks', labelX: 'time [s]', unitX: 's', time: true, labelY: 'number',
                 series: fragments.course});
    if (fragments.sizes.length) {
      chart(pair, {title: 'Fragments of at least this mass', labelX: 'mass [kg]', unitX: 'kg',
                   labelY: 'number', logX: true, logY: true, series: fragments.sizes});
    }
    table(made, fragments.largest.map(([bodies, mass], k) => [
      String(k + 1), String(bodies), kilograms(mass)]),
      {head: ['the heaviest', 'bodies', 'mass'], numbers: [1, 2]});
  }

  // -- scene ----------------------------------------------------------------------------------
  function control(parent, kind, attributes, text = '') {
    const made = element(parent, kind, '', text);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    return made;
  }

  function choice(parent, words, options) {
    const made = element(element(parent, 'label', '', words), 'select');
    for (const [value, text] of options) control(made, 'option', {value}, text);
    return made;
  }

  function makeControls(made, view) {
    const first = element(made, 'div', 'controls');
    const play = control(first, 'button', {id: 'play', class: 'main'}, 'Play');
    const last = view.scene.times.length - 1;
    const slider = control(first, 'input', {
      id: 'time', type: 'range', min: 0, max: last, step: 'any', value: 0,
      'aria-label': 'time'});
    const clock = control(first, 'span', {id: 'clock'});
    const second = element(made, 'div', 'controls');
    const speed = choice(second, 'speed', [0.2, 0.5, 1, 2, 5].map(
      k => [k * view.speed, `${label(Number((k * view.speed).toPrecision(2)))} s per second`]));
    speed.value = view.speed;
    const colour = choice(second, 'colour', [
      ['height', 'height'], ['fragment', 'fragment'], ['speed', 'speed']]);
    colour.id = 'colour';
    for (const what of ['cracks', 'arrows', 'water', 'obstacles', 'edges']) {
      if (!view.objectsOf(what).length) continue;
      const box = control(element(second, 'label'), 'input', {type: 'checkbox', checked: ''});
      box.parentElement.append(what);
      box.addEventListener('change', () => view.show(what, box.checked));
    }
    control(second, 'button', {id: 'back'}, 'Reset view').addEventListener(
      'click', () => view.controls.reset());
    play.addEventListener('click', () => (view.playing ? view.pause() : view.play()));
    slider.addEventListener('input', () => { view.pause(); view.setFrame(Number(slider.value)); });
    speed.addEventListener('change', () => { view.speed = Number(speed.value); });
    const key = control(made, 'div', {id: 'key'});
    colour.addEventListener('change', () => {
      view.setColour(colour.value);
      showKey(key, view);
    });
    showKey(key, view);
    view.listeners.push(() => {
      play.textContent = view.playing ? 'Pause' : 'Play';
      slider.value = view.frame;
      clock.textContent = `${view.time.toFixed(2)} s`;
      setTime(view.time);
    });
  }

  function showKey(key, view) {
    key.replaceChildren();
    const entry = (colour, words) => {
      const made = element(key, 'span', 'entry');
      element(made, 'i').style.setProperty('--colour', colour);
      made.append(words);
    };
    const ramp = (colours, low, high) => {
      const made = element(key, 'span', 'entry', low);
      element(made, 'i', 'ramp').style.setProperty(
        '--ramp', `linear-gradient(90deg, ${colours.join(',')})`);
      made.append(high);
    };
    if (view.colour === 'height') {
      ramp(['#0d294d', '#33739e', '#9ec7e0', '#dbebf5', '#f7faff', '#fff2d6'],
           `3 m below ${view.scene.water ? 'still water' : 'z = 0'}`, '3 m above');
    } else if (view.colour === 'speed') {
      ramp(['#e6f0f7', '#80bfe0', '#facc5c', '#d63d1f'], '0',
           `${short(view.fastest, 3)} m/s and more`);
    } else {
      entry('#ccdbe8', 'the heaviest fragment');
      element(key, 'span', '', 'other colours: other fragments, lone bodies too');
    }
    if (view.cracks) entry('#c7211a', 'cracks');
    if (view.arrows) {
      const kinds = view.scene.arrows.map(one => one.kind);
      if (kinds.includes('obstacle')) entry('#0f9e38', 'force of the ice on an obstacle');
      if (kinds.includes('boundary')) entry('#7340bf', 'force of a boundary on the ice');
      element(key, 'span', '', `1 m of an arrow: ${newtons(view.newtonsPerMetre)}`);
    }
  }

  function showPicked(panel, view) {
    const found = view.numbersOf(view.selected);
    panel.hidden = !found;
    if (!found) return;
    panel.replaceChildren();
    element(panel, 'b', '', `body ${found.body}`);
    const speed = Math.hypot(...found.velocity);
    const vector = (values, digits) => values.map(v => v.toFixed(digits)).join(', ');
    table(panel, [
      ['mass', kilograms(found.mass)], ['at', `${vector(found.place, 2)} m`],
      ['velocity', `${vector(found.velocity, 3)} m/s`], ['speed', `${short(speed, 3)} m/s`],
      ['turned', `${found.turn.toFixed(1)}\u00b0 from rest`],
      ['fragment', `${found.fragment} of ${found.fragments}: ${found.fragmentBodies} ` +
        `bod${found.fragmentBodies > 1 ? 'ies' : 'y'}, ${kilograms(found.fragmentMass)}`],
      ['frame', `${short(found.time)} s`]]);
  }

  function sceneNotes(made, scene) {
    const seen = scene.bodies < scene.of_bodies ? `The ${scene.bodies.toLocaleString('en')} of ` +
      `${scene.of_bodies.toLocaleString('en')} bodies nearest to the obstacles. ` : '';
    element(made, 'p', 'soft', `Drag to turn, wheel or two fingers to zoom (after a click into ` +
      `the scene), right button or two fingers to move, click a body for its numbers. ${seen}` +
      (scene.life ? `Ice joins and leaves: in all frames together ${scene.of_bodies.toLocaleString(
        'en')} bodies exist, each from its first frame to its last. ` : '') +
      `${scene.times.length} of ${scene.of_frames} frames; centres are right to ` +
      `${short(500 * scene.step)} mm, rotations to ${short(500 * scene.turn_step)} mrad about ` +
      'each axis; between frames they are interpolated. Velocities are differences of places ' +
      'from the frame before to the one after.');
    const rate = control(made, 'p', {id: 'rate', class: 'soft'}, 'Rate: not measured yet.');
    return rate;
  }

  async function sceneSection(made) {
    const stage = element(made, 'div', 'stage');
    const holder = control(stage, 'div', {id: 'window'});
    const panel = control(stage, 'div', {id: 'picked', hidden: ''});
    try {
      const scene = await floeScene.unpackScene(report.scene);
      const view = new FloeView(holder, scene);
      window.floe.view = view;
      makeControls(made, view);
      const rate = sceneNotes(made, report.scene);
      const say = () => {
        const triangles = view.triangles.toLocaleString('en');
        const drawn = `${view.calls} draw calls, ${triangles} triangles a frame`;
        rate.textContent = view.rate ? `Rate seen here: ${short(view.rate, 2)} frames a second; ` +
          `${drawn}.` : `Rate: play or turn to measure it; ${drawn}.`;
      };
      view.onRate = say;
      view.listeners.push(() => showPicked(panel, view));
      view.setFrame(0);
      requestAnimationFrame(() => requestAnimationFrame(say));
    } catch (error) {
      holder.textContent = `The scene cannot be drawn here: ${error.message}`;
      window.floe.error = String(error);
    }
    window.floe.ready = true;
  }

  // -- ensembles ------------------------------------------------------------------------------
  function groupSection(group, number) {
    const made = section(`group-${number}`, group.title);
    const s = group.statement, all = `${s.runs.length} runs`;
    headline(made, [[all, 'draws of one law'], [newtons(s.mean), 'mean'],
                    [newtons(Math.max(...s.largest_of_runs)), 'largest, filtered'],
                    [newtons(s.largest_of_a_step), 'largest of a step, unfiltered']]);
    const pair = element(made, 'div', 'pair');
    chart(pair, {title: `Maxima of ${short(s.block)} s and how often they are exceeded`, labelX:
      `largest load of a block [${group.unit}]`, unitX: group.unit, labelY:
      'probability of exceedance', logY: true, series: group.exceedance});
    chart(pair, {title: 'Filtered loads of the runs', labelX: 'time [s]', unitX: 's', labelY:
      `load [${group.unit}]`, series: group.courses});
    chart(pair, {title: 'Spectrum, mean over the runs (Welch, unfiltered)', labelX:
      'frequency [Hz]', unitX: 'Hz', labelY: `density [${group.unit}\u00b2/Hz]`, logX: true,
                 logY: true, series: group.spectrum});
    element(made, 'h3', '', 'Statistics');
    table(made, statisticsOf(group), {className: 'facts'});
    gumbelOf(made, s.gumbel);
  }

  function runsSection(runs) {
    const made = section('runs', 'Runs');
    for (const line of runs.left_out) element(made, 'p', 'warning', `left out: ${line}`);
    table(made, runs.rows.map(row => {
      const [name, link, ...cells] = row;
      if (!link) return [name, ...cells];
      const to = element(document.createDocumentFragment(), 'a', '', name);
      to.href = link;
      return [to, ...cells];
    }), {head: runs.head, numbers: runs.numbers});
    if (!runs.rows.some(row => row[1])) {
      element(made, 'p', 'soft', 'Runs have no report of their own (floe report FOLDER --runs ' +
        'writes them).');
    }
  }

  // -- the page -------------------------------------------------------------------------------
  async function build() {
    const nav = header();
    const facts = section('run', 'What was run');
    for (const line of report.warnings) element(facts, 'p', 'warning', line);
    table(facts, report.facts, {className: 'facts'});
    let place = null;
    if (report.kind === 'run') {
      if (report.scene) place = section('scene', 'The scene');
      report.loads.forEach(loadSections);
      if (report.no_loads) {
        const words = `No statistics of loads: ${report.no_loads}.`;
        element(section('load', 'Load'), 'p', 'soft', words);
      }
      if (report.reactions.series.length) {
        chart(section('reactions', 'Forces of boundaries'), {
          title: 'Forces on boundaries at the rows', labelX: 'time [s]', unitX: 's', time: true,
          labelY: `force [${report.reactions.unit}]`, series: report.reactions.series});
      }
      if (report.energies) energySection(report.energies);
      if (report.fragments) fragmentSection(report.fragments);
    } else {
      report.groups.forEach(groupSection);
      runsSection(report.runs);
    }
    for (const [id, title] of sections) control(nav, 'a', {href: `#${id}`}, title);
    if (place) await sceneSection(place);
    else window.floe.ready = true;
  }

  build();
})();
