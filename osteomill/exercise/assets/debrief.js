// Shows a debriefing page's data: the bone in 3D, the course on a common time axis, and small curves.
(function () {
  "use strict";
  const { data: D, floats, el, showBone } = window.Osteomill;

  function svg(tag, attributes, text) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [key, value] of Object.entries(attributes || {})) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    return element;
  }

  // Curves.

  function ticks(low, high, count) {
    const raw = (high - low) / count, power = Math.pow(10, Math.floor(Math.log10(raw)));
    const step = [1, 2, 5, 10].map(n => n * power).find(n => n >= raw) || 10 * power;
    const all = [];
    for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; ++n) all.push(Number((n * step).toPrecision(12)));
    return all;
  }
  // Draws the minimum and maximum of each pixel, so that every spike is kept.
  function outline(times, values, x, y, wide) {
    let path = "", pixel = -1, low = 0, high = 0, open = false;
    const flush = () => {
      if (pixel < 0) return;
      path += (open ? "L" : "M") + pixel + " " + y(low).toFixed(1) + (high !== low ? "L" + pixel + " " + y(high).toFixed(1) : "");
      open = true;
      pixel = -1;
    };
    for (let n = 0; n < times.length; ++n) {
      const value = values[n], at = Math.round(x(times[n]) * 2) / 2;
      if (!isFinite(value)) { flush(); open = false; continue; }
      if (at !== pixel) { flush(); pixel = at; low = high = value; }
      if (value < low) low = value;
      if (value > high) high = value;
    }
    flush();
    return path;
  }

  document.querySelectorAll("#people tbody tr").forEach((row, person) => {
    const wide = 220, high = 64, curves = D.curves[person].filter(c => c.time.length);
    if (!curves.length) return;
    const end = Math.max(1e-3, ...curves.map(c => c.time[c.time.length - 1] - c.time[0]));
    const box = svg("svg", { class: "curve", width: wide, height: high, role: "img", "aria-label": "target removed over time, one curve per attempt" });
    const y = v => high - 12 - (high - 18) * Math.min(v, 100) / 100;
    for (const v of [0, 100]) {
      box.append(svg("line", { x1: 30, x2: wide - 4, y1: y(v), y2: y(v), stroke: "#ddd" }));
      box.append(svg("text", { x: 27, y: y(v) + 3, "font-size": 9, "text-anchor": "end", fill: "#555" }, v + " %"));
    }
    box.append(svg("text", { x: wide - 4, y: high - 2, "font-size": 9, "text-anchor": "end", fill: "#555" }, clock(end)));
    curves.forEach((c, n) => box.append(svg("path", {
      d: outline(c.time, c.target, t => 30 + (wide - 34) * (t - c.time[0]) / end, y, wide), fill: "none",
      stroke: n === curves.length - 1 ? "#1f5fa8" : "#aab4c0", "stroke-width": n === curves.length - 1 ? 2 : 1 })));
    row.lastElementChild.append(box);
  });

  function clock(seconds) {
    return seconds < 120 ? seconds.toFixed(1) + " s" : Math.floor(seconds / 60) + ":" + ("0" + Math.floor(seconds % 60)).slice(-2) + " min";
  }

  if (!D.samples) return;
  const unpacked = columns => columns ? Object.fromEntries(Object.entries(columns).map(([key, value]) => [key, floats(value)])) : null;
  // Samples, views, and the original attempt's samples from the branch point on.
  const S = unpacked(D.samples), V = unpacked(D.views), F = D.first ? unpacked(D.first.samples) : null;
  const count = S.time.length, begin = S.time[0], end = S.time[count - 1];

  // State: displayed time, selected mark, and listeners.
  let time = begin, moved = false, chosen = -1;
  const listeners = [];
  function sampleAt(t) {
    let low = 0, high = count - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (S.time[middle] <= t) low = middle; else high = middle;
    }
    return S.time[high] <= t ? high : low;
  }
  function setTime(t) {
    moved = moved || t !== begin;
    time = Math.min(Math.max(t, begin), end);
    for (const listener of listeners) listener();
  }

  // The course.

  const courseHere = document.getElementById("course").appendChild(el("div"));
  function drawCourse() {
    courseHere.textContent = "";
    const wide = Math.max(300, courseHere.clientWidth), left = 48, right = 12, gap = 22;
    const last = F ? Math.max(end, F.time[F.time.length - 1]) : end, span = Math.max(last - begin, 1e-6);
    const x = t => left + (wide - left - right) * (t - begin) / span;
    // Removal rate over the last second.
    function rateOf(samples) {
      const rate = new Float32Array(samples.time.length);
      for (let n = 0, first = 0, sum = 0; n < rate.length; ++n) {
        sum += samples.removed[n];
        while (samples.time[n] - samples.time[first] > 1) sum -= samples.removed[first++];
        rate[n] = Math.max(0, sum) / Math.max(Math.min(1, samples.time[n] - samples.time[0]), 0.1);
      }
      return rate;
    }
    const farthest = beyond => values => values.reduce((m, v) => isFinite(v) && beyond(v, m) ? v : m, 0);
    const most = farthest((v, m) => v > m), least = farthest((v, m) => v < m);
    const P = D.progress, G = D.first ? D.first.progress : null;
    // This attempt's line, on top of the original's.
    const lines = (own, first, colour, thick) => [
      ...(F ? [{ ...first, colour: "#9aa3ad", wide: 1.2 }] : []), { ...own, colour, wide: thick }];
    const sampled = (key, colour) => lines({ time: S.time, values: S[key] }, F && { time: F.time, values: F[key] }, colour, 1);
    const topOf = (lines, atLeast) => Math.max(atLeast, ...lines.map(line => most(line.values)));
    const target = lines({ time: P.time, values: P.target }, G && { time: G.time, values: G.target }, "#146c2e", 2);
    const outside = lines({ time: P.time, values: P.outside }, G && { time: G.time, values: G.outside }, "#c2410c", 2);
    const rates = lines({ time: S.time, values: rateOf(S) }, F && { time: F.time, values: rateOf(F) }, "#6b3fa0", 1);
    const force = sampled("force", "#333"), distance = sampled("distance", "#1f5fa8");
    const rows = [
      { name: "target removed, %", high: 110, low: 0, top: 100, lines: [
        ...D.experts.map(e => ({ time: e.time.map(t => t - e.time[0] + begin), values: e.target, colour: "#b9a26a", wide: 1 })), ...target] },
      { name: "removed outside, mm³", high: 70, low: 0, top: topOf(outside, 0.5), kind: "outside", lines: outside },
      { name: "force, N", high: 80, low: 0, top: topOf(force, 0.5), lines: force },
      { name: "distance to the nearest structure, mm", high: 80, low: Math.min(...distance.map(line => least(line.values))), top: Math.min(20, topOf(distance, 1)), kind: "contact", skip: !D.structures, warn: true,
        lines: distance },
      { name: "removal rate over a second, mm³/s", high: 70, low: 0, top: topOf(rates, 0.5), lines: rates },
    ].filter(row => !row.skip);
    const high = rows.reduce((sum, row) => sum + row.high + gap, 0) + 40;
    const box = svg("svg", { class: "course", width: wide, height: high, viewBox: "0 0 " + wide + " " + high, role: "img", "aria-label": "The course of the attempt over time" });
    let y0 = 18;
    for (const row of rows) {
      const y = v => y0 + row.high - row.high * (Math.min(Math.max(v, row.low), row.top) - row.low) / (row.top - row.low);
      box.append(svg("text", { x: left, y: y0 - 5, fill: "#222" }, row.name + (row === rows[0] ? (F ? "; the original in grey" : "") + (D.experts.length ? "; experts' in brown" : "") : "")));
      for (const v of ticks(row.low, row.top, row.high / 28)) {
        box.append(svg("line", { x1: left, x2: wide - right, y1: y(v), y2: y(v), stroke: "#e2e2e2" }));
        box.append(svg("text", { x: left - 5, y: y(v) + 4, "text-anchor": "end", fill: "#555" }, v));
      }
      if (row.warn && D.warn_mm > 0 && D.warn_mm < row.top)
        box.append(svg("line", { x1: left, x2: wide - right, y1: y(D.warn_mm), y2: y(D.warn_mm), stroke: "#d9a400", "stroke-dasharray": "5 3" }));
      for (const line of row.lines)
        box.append(svg("path", { d: outline(line.time, line.values, x, y, wide), fill: "none", stroke: line.colour, "stroke-width": line.wide, "stroke-linejoin": "round" }));
      D.marks.forEach((mark, n) => {
        if (mark.kind !== row.kind) return;
        const at = x(mark.time), base = y0 + row.high;
        const sign = svg("path", { d: "M" + at + " " + (base - 9) + "l6 9h-12z", fill: mark.kind === "contact" ? "#c0107c" : "#e8590c", stroke: "#fff", style: "cursor:pointer" });
        sign.append(svg("title", {}, mark.title));
        sign.addEventListener("pointerdown", event => { event.stopPropagation(); choose(n); });
        box.append(sign);
      });
      y0 += row.high + gap;
    }
    const bottom = y0 - gap;
    const upright = (t, text, dash, level) => {
      const at = x(t);
      if (!(t >= begin && t <= last)) return;
      box.append(svg("line", { x1: at, x2: at, y1: 18, y2: bottom, stroke: "#777", "stroke-dasharray": dash }));
      const turn = at > wide - 110;
      box.append(svg("text", { x: at + (turn ? -4 : 4), y: 30 + 13 * level, "text-anchor": turn ? "end" : "start", fill: "#444" }, text));
    };
    D.steps.forEach((step, n) => { if (step.done_s !== null) upright(step.done_s, "step " + (n + 1) + " done", "6 3", n % 3); });
    D.burrs.slice(1).forEach((burr, n) => upright(burr.time, burr.text, "2 3", 3 + n % 3));
    D.marks.forEach(mark => { if (mark.kind === "parting") upright(mark.time, "branch point", "1 0", 0); });
    const inMinutes = span > 180;
    for (const t of ticks(begin / (inMinutes ? 60 : 1), last / (inMinutes ? 60 : 1), wide / 90)) {
      const at = x(t * (inMinutes ? 60 : 1));
      box.append(svg("line", { x1: at, x2: at, y1: bottom, y2: bottom + 4, stroke: "#555" }));
      box.append(svg("text", { x: at, y: bottom + 16, "text-anchor": "middle", fill: "#333" }, t));
    }
    box.append(svg("text", { x: wide - right, y: bottom + 31, "text-anchor": "end", fill: "#333" }, inMinutes ? "time, min" : "time, s"));
    const cursor = svg("line", { id: "cursor", y1: 14, y2: bottom, stroke: "#d00", "stroke-width": 1.5, "pointer-events": "none" });
    box.append(cursor);
    const move = () => { cursor.setAttribute("x1", x(time)); cursor.setAttribute("x2", x(time)); };
    listeners[0] = move;
    move();
    const seek = event => {
      const frame = box.getBoundingClientRect();
      setTime(begin + span * ((event.clientX - frame.left) * wide / frame.width - left) / (wide - left - right));
    };
    box.addEventListener("pointerdown", event => { seek(event); box.setPointerCapture(event.pointerId); });
    box.addEventListener("pointermove", event => { if (event.buttons & 1) seek(event); });
    courseHere.append(box);
  }
  listeners.push(() => {});
  drawCourse();
  let drawnWide = courseHere.clientWidth;
  addEventListener("resize", () => {
    if (courseHere.clientWidth === drawnWide) return;
    drawnWide = courseHere.clientWidth;
    drawCourse();
  });

  // Marks: a card for the selected one, and the list of all.

  const boneHere = document.getElementById("bone");
  const card = el("div", { id: "card", class: "card", hidden: true, "aria-live": "polite" });
  const symbols = { contact: "◆", outside: "▲", parting: "●" };
  const list = el("ul", { class: "marks", "aria-label": "Contacts and removals outside the target" });
  D.marks.forEach((mark, n) => list.append(el("li", {}, el("button", { type: "button", "aria-pressed": "false", onclick: () => choose(n) },
    symbols[mark.kind] + " " + mark.title))));
  function choose(n) {
    chosen = n;
    const mark = D.marks[n];
    list.querySelectorAll("button").forEach((button, k) => {
      button.setAttribute("aria-pressed", String(k === n));
      if (k === n) list.scrollTop = button.offsetTop - list.offsetTop - list.clientHeight / 2;
    });
    card.textContent = "";
    card.hidden = false;
    const facts = el("dl");
    for (const [name, value] of mark.facts) facts.append(el("dt", {}, name), el("dd", {}, value));
    card.append(el("h3", {}, mark.title), facts);
    card.append(el("input", { readonly: true, value: mark.command, "aria-label": "Command that opens the window at this moment", onfocus: event => event.target.select() }));
    setTime(mark.time);
  }

  // Playing.

  let playing = false, speed = 1, before = 0, recorded = false;
  const playButton = el("button", { type: "button", id: "play", onclick: () => play(!playing) }, "Play");
  const slider = el("input", { type: "range", id: "time", min: begin, max: end, step: "any", value: begin, "aria-label": "Time", oninput: () => setTime(Number(slider.value)) });
  const reading = el("output", { id: "reading" });
  const speeds = el("select", { id: "speed", "aria-label": "Speed", onchange: () => { speed = Number(speeds.value); } });
  for (const s of [0.1, 0.25, 0.5, 1, 2, 4, 8, 16, 32]) speeds.append(el("option", { value: s, selected: s === 1 }, s + " ×"));
  const cameras = el("select", { id: "camera", "aria-label": "Camera", onchange: () => { recorded = cameras.value === "recorded"; setTime(time); } },
    el("option", { value: "own" }, "my own view"), el("option", { value: "recorded", disabled: !V }, V ? "recorded view" : "recorded view (none)"));
  function play(on) {
    playing = on;
    playButton.textContent = on ? "Pause" : "Play";
    if (!on) return;
    if (time >= end) setTime(begin);
    before = performance.now();
    requestAnimationFrame(advance);
  }
  function advance(now) {
    if (!playing) return;
    setTime(time + speed * Math.max(0, now - before) / 1000);
    before = now;
    if (time >= end) play(false); else requestAnimationFrame(advance);
  }
  listeners.push(() => {
    const n = sampleAt(time);
    slider.value = time;
    reading.textContent = (time - 0).toFixed(2) + " s · " + S.force[n].toFixed(2) + " N" +
      (isFinite(S.distance[n]) ? " · " + S.distance[n].toFixed(2) + " mm away" : "");
  });

  // The bone.

  const playBar = el("div", { class: "bar" }, playButton, speeds, cameras, slider, reading);
  const still = boneHere.querySelector("figure");
  for (const part of [playBar, card]) boneHere.insertBefore(part, still);
  if (!D.marks.some(mark => mark.kind !== "parting")) boneHere.append(el("p", {}, "No contact with a structure, and nothing removed outside the target."));
  if (D.marks.length) boneHere.append(list);
  if (D.unlisted) boneHere.append(el("p", {}, D.unlisted));
  const view = showBone(boneHere, playBar);
  if (!view) {
    setTime(begin);
    return;
  }
  if (still) still.hidden = true;
  const { scene, camera, draw } = view;

  // The path, the tool and the marks.
  const path = new THREE.BufferGeometry();
  path.setAttribute("position", new THREE.BufferAttribute(S.place, 3));
  const whole = new THREE.Line(path, new THREE.LineBasicMaterial({ color: 0x5577aa, transparent: true, opacity: 0.35 }));
  const doneGeometry = new THREE.BufferGeometry();
  doneGeometry.setAttribute("position", path.getAttribute("position"));
  const done = new THREE.Line(doneGeometry, new THREE.LineBasicMaterial({ color: 0x1040a0 }));
  done.visible = whole.visible = false;
  const tool = new THREE.Group();
  const burr = new THREE.Mesh(new THREE.SphereBufferGeometry(1, 32, 20), new THREE.MeshPhongMaterial({ color: 0x9aa4ad, shininess: 60, transparent: true, opacity: 0.8 }));
  const shaft = new THREE.Mesh(new THREE.CylinderBufferGeometry(1, 1, 1, 20).translate(0, 0.5, 0), burr.material);
  tool.add(burr, shaft);
  for (const part of [burr, shaft]) part.renderOrder = 5;
  for (const line of [whole, done]) line.frustumCulled = false;
  scene.add(whole, done, tool);

  const shapes = { contact: [[32, 4], [60, 32], [32, 60], [4, 32]], outside: [[32, 6], [60, 56], [4, 56]], parting: Array.from({ length: 24 }, (_, n) => [32 + 24 * Math.cos(n * Math.PI / 12), 32 + 24 * Math.sin(n * Math.PI / 12)]) };
  function disc(fill, kind) {
    const canvas = el("canvas", { width: 64, height: 64 }), pen = canvas.getContext("2d");
    pen.fillStyle = fill;
    pen.strokeStyle = "#fff";
    pen.lineWidth = 6;
    pen.beginPath();
    for (const [a, b] of shapes[kind]) pen.lineTo(a, b);
    pen.closePath();
    pen.fill();
    pen.stroke();
    return new THREE.CanvasTexture(canvas);
  }
  const signs = [["contact", "#c0107c"], ["outside", "#e8590c"], ["parting", "#222"]].map(([kind, colour]) => {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(D.marks.filter(m => m.kind === kind).flatMap(m => m.place), 3));
    const points = new THREE.Points(geometry, new THREE.PointsMaterial({ size: 16, sizeAttenuation: false, map: disc(colour, kind), transparent: true, alphaTest: 0.2, depthTest: false }));
    points.renderOrder = 9;
    points.frustumCulled = false;
    scene.add(points);
    return points;
  });
  const ring = new THREE.Points(new THREE.BufferGeometry(), new THREE.PointsMaterial({ size: 30, sizeAttenuation: false, depthTest: false, transparent: true, alphaTest: 0.2,
    map: (() => { const c = el("canvas", { width: 64, height: 64 }), p = c.getContext("2d"); p.lineWidth = 8; p.strokeStyle = "#111"; p.beginPath(); p.arc(32, 32, 26, 0, 7); p.stroke(); return new THREE.CanvasTexture(c); })() }));
  ring.geometry.setAttribute("position", new THREE.Float32BufferAttribute([0, 0, 0], 3));
  ring.frustumCulled = false;
  ring.renderOrder = 10;
  ring.visible = false;
  scene.add(ring);
  view.bar.append(el("label", {}, el("input", { type: "checkbox", checked: true, onchange: event => { for (const s of signs) s.visible = event.target.checked; draw(); } }), "marks: ◆ contact, ▲ removed outside" + (F ? ", ● branch point" : "")),
    el("label", {}, el("input", { type: "checkbox", id: "path", onchange: event => { done.visible = whole.visible = event.target.checked; draw(); } }), "the burr's path"));

  view.place = () => {
    const n = sampleAt(time);
    tool.visible = moved && isFinite(S.place[3 * n]);
    if (tool.visible) {
      const next = Math.min(n + 1, count - 1), share = next > n ? Math.min(1, (time - S.time[n]) / (S.time[next] - S.time[n])) : 0;
      const at = new THREE.Vector3().fromArray(S.place, 3 * n);
      if (isFinite(S.place[3 * next])) at.lerp(new THREE.Vector3().fromArray(S.place, 3 * next), share);
      if (chosen >= 0 && Math.abs(time - D.marks[chosen].time) < 1e-6) at.set(...D.marks[chosen].place);
      tool.position.copy(at);
      burr.scale.setScalar(S.radius[n]);
      shaft.scale.set(0.5 * S.radius[n], 25, 0.5 * S.radius[n]);
      tool.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), new THREE.Vector3().fromArray(S.shaft, 3 * n).normalize());
    }
    doneGeometry.setDrawRange(0, n + 1);
    ring.visible = chosen >= 0 && signs[0].visible;
    if (chosen >= 0) {
      ring.geometry.getAttribute("position").setXYZ(0, ...D.marks[chosen].place);
      ring.geometry.getAttribute("position").needsUpdate = true;
    }
    if (!recorded || !V || !isFinite(V.eye[3 * n])) return false;
    camera.position.fromArray(V.eye, 3 * n);
    camera.quaternion.fromArray(V.turn, 4 * n);
    camera.fov = V.fov[n];
    return true;
  };
  listeners.push(draw);

  // A press without a drag selects the nearest mark.
  function pixelOf(mark) {
    const p = new THREE.Vector3(...mark.place).project(camera);
    return [(p.x + 1) / 2 * view.frame.clientWidth, (1 - p.y) / 2 * view.frame.clientHeight, p.z];
  }
  let pressed = null;
  view.canvas.addEventListener("pointerdown", event => { pressed = [event.clientX, event.clientY]; });
  view.canvas.addEventListener("pointerup", event => {
    if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 6 || !signs[0].visible) return;
    const frame = view.canvas.getBoundingClientRect(), reach = event.pointerType === "touch" ? 26 : 14;
    let best = -1, nearest = reach;
    D.marks.forEach((mark, n) => {
      const [px, py, depth] = pixelOf(mark);
      const away = Math.hypot(px - (event.clientX - frame.left), py - (event.clientY - frame.top));
      if (depth < 1 && away < nearest) { nearest = away; best = n; }
    });
    if (best >= 0) choose(best);
  });
  Object.assign(window.osteomillPage, { pixelOf: n => pixelOf(D.marks[n]), time: () => time, played: () => [time, before], marks: D.marks });
  setTime(begin);
})();
