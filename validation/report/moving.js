"use strict";
const moving = () => {
  const $ = (id) => document.getElementById(id);
  if (!$("path-data")) return;
  const D = JSON.parse($("path-data").textContent), S = D.states, P = D.period, N = D.points, U = D.units;
  const INK = "#1d2733", SOFT = "#55616d", TOUCH = "#0b5fa5", NEW = "#c8410b", PALE = "#d5dbe1", MISSING = 65535;
  const decoded = ({ low, step, codes }) =>
    Array.from(new Uint16Array(Uint8Array.from(atob(codes), (c) => c.charCodeAt(0)).buffer), (c) => (c === MISSING ? null : low + c * step));
  const H = decoded(D.height), DISPLACEMENT = decoded(D.displacement), PRESSURE = decoded(D.pressure);
  const C = { separation: decoded(D.path.separation), fraction: decoded(D.path.fraction), open: decoded(D.path.open), load: decoded(D.path.load) };
  let total = 0, drawings = 0;
  const begins = S.map((s) => { const start = total; total += s.counts.reduce((sum, n) => sum + n, 0); return start; });
  const rows = [...document.querySelectorAll("#numbers tbody tr")], cell = (i, k) => rows[i].cells[k].textContent;
  const fixed = (v) => v.toFixed(1), words = (v) => String(+v.toPrecision(6)).replace("-", "−");
  const text = (x, y, s, more = "") => `<text x="${fixed(x)}" y="${fixed(y)}" ${more}>${s}</text>`;
  const path = (points, more) => (points.length ? `<path d="M${points.map((p) => fixed(p[0]) + "," + fixed(p[1])).join("L")}" ${more}/>` : "");
  const rect = (x, y, w, h, more) => `<rect x="${fixed(x)}" y="${fixed(y)}" width="${fixed(Math.max(w, 0))}" height="${fixed(Math.max(h, 0))}" ${more}/>`;

  function ticks(low, high, most) { // round numbers of a range
    const rough = (high - low) / Math.max(most, 1), ten = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].find((m) => m * ten >= rough) * ten, all = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) all.push(k * step);
    return all;
  }
  function frame(w, h, xr, yr, xname, yname, [left, right, above, below] = [46, 8, 18, 18]) { // axes, and places of numbers
    const x = (v) => left + ((v - xr[0]) / (xr[1] - xr[0])) * (w - left - right);
    const y = (v) => h - below - ((v - yr[0]) / (yr[1] - yr[0])) * (h - above - below);
    let axes = "";
    for (const v of ticks(...yr, (h - above - below) / 30)) axes += path([[left - 4, y(v)], [left, y(v)]], `stroke="${SOFT}"`) + text(left - 6, y(v) + 4, words(v), 'text-anchor="end"');
    for (const v of ticks(...xr, (w - left - right) / 62)) axes += path([[x(v), h - below], [x(v), h - below + 4]], `stroke="${SOFT}"`) + (xname ? text(x(v), h - below + 15, words(v), 'text-anchor="middle"') : "");
    axes += rect(left, above, w - left - right, h - above - below, `fill="none" stroke="${SOFT}"`) + text(2, above - 6, yname, 'class="strong"');
    if (xname) axes += text(w - right, h - below + 28, xname, 'text-anchor="end" class="strong"');
    return { x, y, axes, left, right: w - right, top: above, bottom: h - below };
  }

  // Patches within one period, and the parts of intervals that no other interval covers
  const within = (edges) => edges.flatMap(([a, b]) => [-P, 0, P].map((k) => [Math.max(a + k, 0), Math.min(b + k, P)])).filter(([a, b]) => b > a);
  const minus = (some, others) => others.reduce((left, [c, d]) => left.flatMap(([a, b]) => [[a, Math.min(b, c)], [Math.max(a, d), b]].filter(([p, q]) => q - p > 1e-6 * P)), some);
  const touching = (i) => (S[i].status === "complete_contact" ? [[0, P]] : within(S[i].edges));
  const lerp = (array, start, x) => { const k = Math.floor((x / P) * N), t = (x / P) * N - k; return array[start + (k % N)] * (1 - t) + array[start + ((k + 1) % N)] * t; };
  const span = (a, b) => [a, ...Array.from({ length: N + 1 }, (_, k) => (k * P) / N).filter((x) => x > a && x < b), b];
  const unlike = (some, others) => minus(some, others).filter(([a, b]) => b - a > 3e-3 * P || some.some(([c, d]) => a === c && b === d)); // not the small motion of an edge
  const jumped = (i) => i > 0 && S[i].jump === "after" && S[i - 1].jump === "before";
  const changed = (i) => (jumped(i) ? { gained: unlike(touching(i), touching(i - 1)), lost: unlike(touching(i - 1), touching(i)) } : { gained: [], lost: [] });

  function surface(i, w, h) {
    const s = S[i], [low, high] = D.range, room = high - low, f = frame(w, h, [0, P], [low - 0.12 * room, high + 0.08 * room], "", `height / ${U.height}`, [46, 8, 34, 16]);
    const { gained, lost } = changed(i), on = touching(i), id = `clip${drawings++}`, all = span(0, P), bar = f.bottom + 3, far = f.y(s.separation) < f.top, ground = (x) => [f.x(x), f.y(lerp(H, 0, x))];
    const box = (name, x, y, W, T, drawn) => `<clipPath id="${name}">${rect(x, y, W, T, "")}</clipPath><g clip-path="url(#${name})">${drawn}</g>`;
    function bodies(X, Y) { // both bodies, with contact and jump, in given scales
      const along = (x) => [X(x), Y(lerp(H, 0, x))], above = (k) => all.map((x) => [X(x), Math.max(Y(Math.max(S[k].separation + lerp(DISPLACEMENT, k * N, x), lerp(H, 0, x))), -2000)]);
      const now = above(i), corner = (y) => [[X(P), y], [X(0), y]], across = (v, more) => path([[X(0), Y(v)], [X(P), Y(v)]], more);
      let out = path([...corner(-3000), ...corner(3000).reverse()], 'fill="var(--gap)"') + path([...now, ...corner(-3000)], 'fill="var(--body)"');
      if (jumped(i)) { // the surface just before the jump, and the area that it swept
        const old = above(i - 1);
        out += path([...now, ...old.slice().reverse()], `fill="${NEW}" fill-opacity="0.3"`) + path(old, `fill="none" stroke="${NEW}" stroke-width="1.2" stroke-dasharray="5 3"`);
      }
      out += path(now, `fill="none" stroke="${INK}" stroke-width="1.4"`) + path([...all.map(along), ...corner(3000)], `fill="var(--rigid)" stroke="${INK}"`);
      for (const [a, b] of on) out += path(span(a, b).map(along), `fill="none" stroke="${TOUCH}" stroke-width="4.5"`);
      for (const [a, b] of gained) out += path(span(a, b).map(along), `fill="none" stroke="${NEW}" stroke-width="5"`);
      return out + across(s.separation, `stroke="${SOFT}" stroke-dasharray="1 4"`) + across(0, 'stroke="#fff" stroke-dasharray="1 4"');
    }
    let out = box(id, f.left, f.top, f.right - f.left, f.bottom - f.top, bodies(f.x, f.y));
    for (const [a, b] of on) out += rect(f.x(a), bar, Math.max(f.x(b) - f.x(a), 1.5), 8, `fill="${TOUCH}"`);
    for (const [a, b] of gained) out += rect(f.x(a), bar, Math.max(f.x(b) - f.x(a), 2.5), 8, `fill="${NEW}"`);
    for (const [a, b] of lost) out += rect(f.x(a), bar, Math.max(f.x(b) - f.x(a), 2.5), 8, `fill="#fff" stroke="${NEW}" stroke-width="1.5"`);
    out += f.axes + text(f.left + 6, f.top + 14, far ? `elastic body: ${cell(i, 2)} ${U.separation} up, above the figure ↑` : "elastic body") + text(f.left + 6, f.bottom - 6, "rigid profile", 'style="fill:#fff"');
    s.events.forEach((e, k) => { // an arrow with its name: down where contact is gained, up where it is lost
      if (e.x === null || k > 3) return;
      const place = ((e.x % P) + P) % P, x = f.x(place), end = f.y(lerp(H, 0, place)) - 5, half = 3.6 * e.short.length, head = e.way < 0 ? [f.top + 8, f.top + 1] : [end - 7, end];
      out += path([[x, f.top], [x, end]], `stroke="${NEW}" stroke-width="1.6"`);
      if (e.way) out += path([[x - 4, head[0]], [x, head[1]], [x + 4, head[0]]], `fill="none" stroke="${NEW}" stroke-width="2"`);
      if (k < 2) out += text(Math.min(Math.max(x, f.left + half + 76), f.right - half), f.top - 6 - 14 * k, e.short, `text-anchor="middle" class="halo strong" style="fill:${NEW};font-size:13px"`);
    });
    const widest = [...gained, ...lost].reduce((best, [p, q]) => (q - p > best[1] - best[0] ? [p, q] : best), [0, 0]), size = widest[1] - widest[0];
    if (size > 0 && size < 0.06 * P) { // a lens on the largest change, where it hides least of both surfaces
      const W = w > 500 ? 240 : 118, T = w > 500 ? 120 : 74, zoom = w > 500 ? 3 : 2.5, place = (widest[0] + widest[1]) / 2, cx = f.x(place), cy = f.y(lerp(H, 0, place)) - T / zoom / 8;
      const drawn = all.flatMap((x) => [ground(x), [f.x(x), f.y(s.separation + lerp(DISPLACEMENT, i * N, x))]]), around = [cx - W / zoom / 2, cy - T / zoom / 2, W / zoom, T / zoom];
      const hidden = ([x, y]) => drawn.filter((p) => p[0] > x && p[0] < x + W && p[1] > y && p[1] < y + T).length + (x < around[0] + around[2] && around[0] < x + W && y < around[1] + around[3] && around[1] < y + T ? 1e6 : 0);
      const corners = [f.bottom - T - 3, f.top + 3].flatMap((y) => [f.right - W - 3, f.left + 3].map((x) => [x, y])), [x, y] = corners.reduce((best, corner) => (hidden(corner) < hidden(best) ? corner : best));
      out += rect(...around, `fill="none" stroke="${INK}" stroke-dasharray="3 2"`);
      out += box(`${id}lens`, x, y, W, T, bodies((v) => x + W / 2 + zoom * (f.x(v) - cx), (v) => y + T / 2 + zoom * (f.y(v) - cy)));
      out += rect(x, y, W, T, `fill="none" stroke="${INK}" stroke-width="1.5"`) + text(x + 5, y + T - 6, `magnified ${zoom} ×`, 'class="halo strong"');
    }
    return { svg: out, times: ((f.y(0) - f.y(1)) / (f.x(1) - f.x(0))) * D.stretch };
  }

  function patches(k) { // of each patch: its edges, and positions and pressures between them
    const edges = S[k].status === "complete_contact" ? [[0, P]] : S[k].edges;
    let start = begins[k];
    return edges.map(([a, b], place) => {
      const n = S[k].counts[place], values = Array.from({ length: n }, (_, j) => [a + ((b - a) * (1 - Math.cos(((j + 0.5) * Math.PI) / n))) / 2, PRESSURE[start + j]]);
      start += n;
      return values;
    });
  }
  function pressure(i, w, h) {
    const whole = S[i].status === "complete_contact", range = D.pressures[whole ? "complete" : "partial"], [low] = range, f = frame(w, h, [0, P], range, `x / ${U.x}`, `pressure / ${U.pressure}`, [46, 8, 18, 30]), zero = f.y(0), id = `clip${drawings++}`;
    const shapes = (k) => patches(k).flatMap((values, place) => {
      const edge = low < 0 ? low : 0, [a, b] = S[k].status === "complete_contact" ? [0, P] : S[k].edges[place];
      const points = S[k].status === "complete_contact" ? values : [[a, edge], ...values, [b, edge]]; // adhesive edges: tension without bound
      return [0, -P].filter((shift) => b + shift > 0).map((shift) => points.map(([x, y]) => [f.x(x + shift), f.y(y)]));
    });
    let out = `<defs><clipPath id="${id}a">${rect(f.left, f.top, f.right - f.left, zero - f.top, "")}</clipPath><clipPath id="${id}b">${rect(f.left, zero, f.right - f.left, f.bottom - zero, "")}</clipPath><clipPath id="${id}">${rect(f.left, f.top, f.right - f.left, f.bottom - f.top, "")}</clipPath></defs>`;
    if (jumped(i)) for (const points of shapes(i - 1)) out += path(points, `fill="none" stroke="${NEW}" stroke-width="1.3" stroke-dasharray="4 3" clip-path="url(#${id})"`);
    for (const points of shapes(i)) {
      const closed = [[points[0][0], zero], ...points, [points[points.length - 1][0], zero]];
      out += path(closed, `fill="#9cc3e6" clip-path="url(#${id}a)"`) + (low < 0 ? path(closed, `fill="#f3b79b" clip-path="url(#${id}b)"`) : "") + path(points, `fill="none" stroke="${INK}" stroke-width="1.3" clip-path="url(#${id})"`);
    }
    out += f.axes + path([[f.left, zero], [f.right, zero]], `stroke="${SOFT}"`) + text(f.right - 4, f.top + 13, "compression", 'text-anchor="end" class="halo"');
    if (low < 0) out += text(f.right - 4, f.bottom - 5, whole ? "tension" : w > 500 ? "tension: without bound at the edges, axis cut here" : "tension, without bound: axis cut", 'text-anchor="end" class="halo"');
    if (!touching(i).length) out += text((f.left + f.right) / 2, (f.top + zero) / 2 + 4, "apart: no pressure", 'text-anchor="middle"');
    if (S[i].undetermined) out += text(f.left + 6, f.top + 13, w > 500 ? "mean pressure undetermined: drawn about zero" : "mean undetermined", 'class="halo"');
    return out;
  }

  const [nearest, farthest] = D.path.reach, pad = 0.07 * (farthest - nearest) || 0.07 * farthest || 1, reach = [nearest - pad, farthest + pad];
  function curve(key, name, i, w, h, marked = [i]) {
    const x = C.separation, y = C[key], inside = (k) => y[k] !== null && x[k] >= reach[0] && x[k] <= reach[1], real = y.filter((_, k) => inside(k));
    const low = Math.min(...real, 0), high = Math.max(...real, 0), room = 0.06 * (high - low) || 1, last = key === "load";
    const f = frame(w, h, reach, [low - (low < 0 ? room : 0), high + room], last ? `separation / ${U.separation}` : "", name, [46, 8, 18, last ? 30 : 8]), id = `clip${drawings++}`;
    const at = (k) => [f.x(x[k]), f.y(y[k])], strokes = { l: `stroke="${INK}" stroke-width="1.6"`, u: `stroke="${INK}" stroke-width="1.6" stroke-dasharray="6 3"`, j: `stroke="${NEW}" stroke-width="2" stroke-dasharray="2 2"` };
    let out = `<defs><clipPath id="${id}">${rect(f.left, f.top, f.right - f.left, f.bottom - f.top, "")}</clipPath></defs>` + (last ? path([[f.left, f.y(0)], [f.right, f.y(0)]], `stroke="${PALE}"`) : "") + `<g clip-path="url(#${id})">`;
    const joins = D.path.joins;
    for (let k = 1, run = [0]; k <= x.length; k++) {
      const kind = joins[k - 1], next = joins[k];
      if (k < x.length && next !== "n" && (run.length === 1 || next === kind) && y[k] !== null && y[k - 1] !== null) { run.push(k); continue; }
      if (run.length > 1) out += path(run.map(at), `fill="none" ${strokes[joins[run[1]]]}`);
      else if (y[run[0]] !== null && (next === "n" || next === undefined) && (kind === "n" || k === 1)) out += `<circle cx="${fixed(at(run[0])[0])}" cy="${fixed(at(run[0])[1])}" r="2.2" fill="${INK}"/>`;
      run = k < x.length && next !== "n" && run.length > 1 && y[k] !== null && y[k - 1] !== null ? [k - 1, k] : [k];
    }
    if (last && D.tension) out += path([[-5, 0], [5, 0], [0, 0], [0, -5], [0, 5]].map(([a, b]) => [f.x(D.tension[0]) + a, f.y(D.tension[1]) + b]), `fill="none" stroke="${NEW}" stroke-width="2"`);
    for (const k of marked.map((n) => S[n].place)) if (y[k] !== null) out += path([[at(k)[0], f.top], [at(k)[0], f.bottom]], 'stroke="#b6c0ca"') + `<circle cx="${fixed(at(k)[0])}" cy="${fixed(at(k)[1])}" r="5.5" fill="${joins[k] === "j" ? NEW : TOUCH}" stroke="#fff" stroke-width="1.5"/>`;
    out += "</g>" + f.axes;
    if (marked.length === 1 && C.separation[S[i].place] > reach[1]) out += text(f.right - 4, f.top + 13, "further apart →", 'text-anchor="end" class="halo"');
    return out;
  }
  const CURVES = $("load") ? [["fraction", "contact fraction"], ["open", `mean open gap / ${U.open}`], ["load", `mean pressure / ${U.load}`]] : [];
  const put = (id, h, svg, label) => { const e = $(id); e.setAttribute("height", h); e.style.height = h + "px"; e.innerHTML = svg; if (label) e.setAttribute("aria-label", label); };

  function marks() { // events over the slider: a tick each, and its name where there is room, first of all the current one
    const w = $("marks").clientWidth, some = S.some((s) => s.events.length), h = some ? 46 : 30, placed = [];
    const at = (k) => 10 + ((w - 20) * k) / Math.max(S.length - 1, 1), turn = S.findIndex((s) => s.branch === "unloading");
    let out = "", names = "";
    const events = S.flatMap((s, k) => (s.events.length ? [k] : []));
    for (const k of [...events.filter((k) => k === now), ...events.filter((k) => k !== now)]) {
      const name = [...new Set(S[k].events.map((e) => e.short))].slice(0, 2).join(" + "), half = name.length * 3.2 + 5, x = at(k), middle = Math.min(Math.max(x, half), w - half), color = k === now ? NEW : INK;
      out += path([[x, h - 13], [x, h]], `stroke="${color}" stroke-width="${k === now ? 3 : 1.3}"`);
      if (placed.some(([a, b]) => middle + half > a && middle - half < b)) continue;
      placed.push([middle - half, middle + half]);
      names += text(middle, h - 17, name, `text-anchor="middle" class="${k === now ? "strong" : ""}" style="fill:${color}" data-state="${k}"`);
    }
    if (turn > 0) out += text(10, 11, "loading →", `style="fill:${TOUCH}"`) + text(w - 10, 11, "→ unloading", `text-anchor="end" style="fill:${SOFT}"`) + rect(10, h - 3, at(turn - 0.5) - 10, 3, `fill="${TOUCH}"`) + rect(at(turn - 0.5), h - 3, w - 10 - at(turn - 0.5), 3, 'fill="#9aa5b0"');
    put("marks", h, out + names);
  }

  let now = 0, timer = 0;
  function show(i, speak = true) {
    now = Math.min(Math.max(i, 0), S.length - 1);
    const s = S[now], w = $("surface").clientWidth, tall = w > 500, side = CURVES.length ? $("load").clientWidth : 0, drawn = surface(now, w, tall ? 300 : 218);
    document.querySelectorAll("#now dd[data-of]").forEach((e) => { e.innerHTML = `${cell(now, e.dataset.of)} <small>${/\d/.test(cell(now, e.dataset.of)) ? e.dataset.unit : ""}</small>`; });
    $("which").innerHTML = `${now + 1} <small>of ${S.length}, ${s.branch}</small>`;
    const event = cell(now, 7), summary = `State ${now + 1} of ${S.length}, ${s.branch}: separation ${cell(now, 2)} ${U.separation}, mean pressure ${cell(now, 3)} ${U.load}, contact fraction ${cell(now, 4)}, contacts: ${cell(now, 6)}`;
    $("event").className = s.events.length || s.jump ? "on" : "";
    $("event").setAttribute("aria-live", speak && !timer ? "polite" : "off");
    $("event").textContent = event || "No event since the state before.";
    put("surface", tall ? 300 : 218, drawn.svg, `Surfaces. ${summary}. ${event}`);
    put("pressure", tall ? 150 : 116, pressure(now, w, tall ? 150 : 116), `Pressure on the contacts: ${cell(now, 6)}`);
    for (const [key, name] of CURVES) put(key, key === "load" ? 168 : 141, curve(key, name, now, side, key === "load" ? 168 : 141), `${name} against separation, the current state marked`);
    $("scale").textContent = `Heights are drawn ${words(+drawn.times.toPrecision(2))} times larger than lengths.`;
    $("slide").value = now;
    $("slide").setAttribute("aria-valuetext", summary + (event ? ". " + event : ""));
    rows.forEach((r, k) => (k === now ? r.setAttribute("aria-current", "true") : r.removeAttribute("aria-current")));
    const box = $("numbers"), r = rows[now], head = box.querySelector("thead").offsetHeight;
    if (r.offsetTop < box.scrollTop + head || r.offsetTop + r.offsetHeight > box.scrollTop + box.clientHeight) box.scrollTop = r.offsetTop - head - r.offsetHeight;
    marks();
  }
  const jump = (way) => { for (let k = now + way; k >= 0 && k < S.length; k += way) if (S[k].events.length) return show(k); };
  function stop() { clearTimeout(timer); timer = 0; $("play").textContent = "▶ Play"; }
  function step() { show(now + 1); timer = now < S.length - 1 ? setTimeout(step, S[now].events.length || S[now].jump ? 1100 : 170) : 0; if (!timer) stop(); }
  function play() { if (timer) return stop(); if (now === S.length - 1) show(0); $("play").textContent = "❚❚ Pause"; timer = setTimeout(step, 300); }
  $("play").onclick = play;
  $("back").onclick = () => { stop(); jump(-1); };
  $("next").onclick = () => { stop(); jump(1); };
  $("slide").oninput = (e) => { stop(); show(+e.target.value); };
  $("marks").onclick = (e) => { if (e.target.dataset.state) { stop(); show(+e.target.dataset.state); } };
  rows.forEach((r, k) => { r.onclick = () => { stop(); show(k); }; });
  if (S.length === 1) $("controls").hidden = true;
  document.querySelectorAll("#back, #next").forEach((button) => { button.disabled = !S.some((s, k) => k && s.events.length); });
  document.addEventListener("keydown", (e) => { // of the slider wherever the reader is, but not in a box that scrolls or takes text
    const way = { ArrowLeft: -1, ArrowRight: 1 }[e.key], slider = e.target === $("slide");
    if (!way || e.ctrlKey || e.altKey || e.metaKey || (!slider && e.target.closest("input, pre, .wide, #numbers"))) return;
    stop();
    if (e.shiftKey) jump(way); else show(now + way);
    e.preventDefault();
  });

  // On paper: the largest contact, both sides of the largest jump, and the curves
  const most = S.reduce((best, s, k) => (s.edges.length && C.fraction[s.place] > C.fraction[S[best].place] ? k : best), 0), jumps = S.flatMap((_, k) => (jumped(k) ? [k] : []));
  const swept = (k) => Math.abs(C.fraction[S[k].place] - C.fraction[S[k - 1].place]), widest = jumps.reduce((best, k) => (best === 0 || swept(k) > swept(best) ? k : best), 0);
  const printed = [...new Set([most, ...(widest ? [widest - 1, widest] : []), S.length - 1])].sort((a, b) => a - b);
  $("paper").innerHTML = printed.map((k) => `<figure><figcaption><b>State ${k + 1}, ${S[k].branch}</b>: separation ${cell(k, 2)} ${U.separation}, mean pressure ${cell(k, 3)} ${U.load}, contact fraction ${cell(k, 4)}. ${cell(k, 7)}</figcaption><svg viewBox="0 0 700 200">${surface(k, 700, 200).svg}</svg><svg viewBox="0 0 700 110">${pressure(k, 700, 110)}</svg></figure>`).join("") + `<div class="trio">${CURVES.map(([key, name]) => `<svg viewBox="0 0 240 168">${curve(key, name, 0, 240, key === "load" ? 168 : 146, printed)}</svg>`).join("")}</div>`;
  addEventListener("resize", () => show(now, false));
  show(Math.max(S.findIndex((s) => s.target), 0), false); // the first answer, not surfaces that are apart
};
moving();
