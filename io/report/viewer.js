"use strict";
// The body that turns: in the shape of a mode, or still, with a place marked on it.
const start = (viewer, data) => {
  const marked = viewer.dataset.marked === undefined ? null : JSON.parse(viewer.dataset.marked);
  const find = (name) => viewer.querySelector(name);
  const stage = find(".stage"), back = find(".back"), front = find(".front");
  const message = find(".message"), controls = find(".controls");
  const { bytes } = Page;
  const compile = (gl, kind, source) => {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    return shader;
  };

  const gl = back.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true });
  if (!gl) {
    message.textContent = "This browser shows no WebGL here, so the body is not drawn.";
    controls.hidden = true;
    return;
  }

  // Lengths are in halves of the body's diagonal. The largest movement is `amplitude`.
  const vertexSource = `#version 300 es
    in vec3 point; in vec3 movement;
    uniform mat3 turn; uniform vec2 zoom; uniform vec2 shift; uniform float amplitude; uniform float swing;
    uniform vec3 axis; uniform float largest; uniform float lift;
    out vec3 seen; out float value;
    void main() {
      seen = turn * (point + amplitude * swing * movement);
      value = dot(axis, movement) / largest;
      gl_Position = vec4(seen.xy * zoom + shift, -seen.z * 0.3 - lift, 1.0);
    }`;
  const fragmentSource = `#version 300 es
    precision highp float;
    in vec3 seen; in float value;
    uniform sampler2D colours; uniform float swing; uniform bool lines; uniform bool edges; uniform bool plain;
    out vec4 colour;
    void main() {
      if (edges) { colour = vec4(0.30, 0.31, 0.34, 1.0); return; }
      vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
      float light = 0.58 + 0.42 * max(dot(normal, normalize(vec3(-0.35, 0.55, 0.76))), 0.0);
      vec3 base = plain ? vec3(0.93) : texture(colours, vec2(0.5 + 0.5 * value * swing, 0.5)).rgb;
      float change = fwidth(value);
      float line = change > 1e-4 ? 1.0 - smoothstep(0.9, 1.7, abs(value) / change) : 0.0;
      colour = vec4(mix(base * light, vec3(0.0), lines && !plain ? line : 0.0), 1.0);
    }`;
  const program = gl.createProgram();
  gl.attachShader(program, compile(gl, gl.VERTEX_SHADER, vertexSource));
  gl.attachShader(program, compile(gl, gl.FRAGMENT_SHADER, fragmentSource));
  gl.linkProgram(program);
  gl.useProgram(program);
  const uniform = (name) => gl.getUniformLocation(program, name);
  const at = Object.fromEntries(["turn", "zoom", "shift", "amplitude", "swing", "axis", "largest", "lift", "lines",
    "edges", "plain"].map((name) => [name, uniform(name)]));

  const buffer = (target, content) => {
    const made = gl.createBuffer();
    gl.bindBuffer(target, made);
    gl.bufferData(target, content, gl.STATIC_DRAW);
    return made;
  };
  const attribute = (name, made) => {
    const place = gl.getAttribLocation(program, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, made);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 3, gl.SHORT, true, 0, 0);
  };
  const points = new Int16Array(bytes(data.points));
  const triangles = new Uint16Array(bytes(data.triangles)), outline = new Uint16Array(bytes(data.outline));
  attribute("point", buffer(gl.ARRAY_BUFFER, points));
  const triangleBuffer = buffer(gl.ELEMENT_ARRAY_BUFFER, triangles);
  const outlineBuffer = buffer(gl.ELEMENT_ARRAY_BUFFER, outline);
  const movementBuffer = gl.createBuffer();

  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB, data.colours.length / 3, 1, 0, gl.RGB, gl.UNSIGNED_BYTE,
    new Uint8Array(data.colours));
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  const quarter = (i) => `rgb(${data.colours.slice(3 * i, 3 * i + 3).join(",")})`;
  const colourCount = data.colours.length / 3;
  if (!marked) find(".bar").style.background = `linear-gradient(to right, ${[0, 1, 2, 3, 4, 5, 6, 7, 8]
    .map((i) => quarter(Math.round(i * (colourCount - 1) / 8))).join(",")})`;

  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const state = { shape: 0, playing: !still && !marked, phase: 0, amplitude: 0.12, lines: true, names: true, zoom: 1,
    yaw: data.yaw, pitch: data.pitch };
  let movement = null, places = [], extent = [1, 1], waiting = false, last = 0;

  // The component that gives the colour has 16 bits, the other two have 8 (see report.cpp).
  const unpacked = (shape) => {
    const main = new Int16Array(bytes(shape.main)), sides = new Int8Array(bytes(shape.sides));
    const result = new Int16Array(3 * main.length), others = [0, 1, 2].filter((k) => k !== shape.axis);
    for (let v = 0; v < main.length; ++v) {
      result[3 * v + shape.axis] = main[v];
      others.forEach((k, i) => { result[3 * v + k] = 258 * sides[2 * v + i]; });
    }
    return result;
  };
  const multiply = (a, b) => [0, 1, 2].map((i) => [0, 1, 2].map((j) => a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j]));
  const turned = () => {  // rows: right, up, towards the eye
    const [cy, sy, cp, sp] = [Math.cos(state.yaw), Math.sin(state.yaw), Math.cos(state.pitch), Math.sin(state.pitch)];
    return multiply([[cy, sy, 0], [-sy * sp, cy * sp, cp], [sy * cp, -cy * cp, sp]], data.frame);
  };
  const seen = (turn, vertex, swing) => {
    const place = [0, 1, 2].map((k) => (points[3 * vertex + k] +
      (movement ? state.amplitude * swing * movement[3 * vertex + k] : 0)) / 32767);
    return turn.map((row) => row[0] * place[0] + row[1] * place[1] + row[2] * place[2]);
  };
  // Half the size of the body at rest as it was seen at first, so that turning does not change the scale.
  const measure = () => {
    const turn = turned();
    extent = [0, 0];
    for (let v = 0; v < points.length / 3; ++v) {
      const place = seen(turn, v, 0);
      extent = [Math.max(extent[0], Math.abs(place[0])), Math.max(extent[1], Math.abs(place[1]))];
    }
  };

  const show = (index) => {
    const count = data.shapes.length;
    if (!count || marked) return;
    state.shape = (index + count) % count;
    const shape = data.shapes[state.shape];
    movement = unpacked(shape);
    gl.bindBuffer(gl.ARRAY_BUFFER, movementBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, movement, gl.STATIC_DRAW);
    attribute("movement", movementBuffer);
    let largest = 1;
    for (let i = shape.axis; i < movement.length; i += 3) largest = Math.max(largest, Math.abs(movement[i]));
    gl.uniform1f(at.largest, largest / 32767);
    gl.uniform3f(at.axis, ...[0, 1, 2].map((k) => (k === shape.axis ? 1 : 0)));
    find(".label").textContent = shape.label;
    find(".axis").textContent = "displacement along " + "xyz"[shape.axis];
    for (const row of document.querySelectorAll("tr[data-shape]")) {
      row.classList.toggle("shown", Number(row.dataset.shape) === state.shape);
    }
    redraw();
  };

  const scales = () => {
    const [width, height] = [stage.clientWidth, stage.clientHeight];
    const pixels = state.zoom * 0.86 * Math.min(width / 2 / extent[0], height / 2 / (extent[1] + 0.6 * state.amplitude));
    return { width, height, pixels };
  };
  // Glyphs first, those of sensors last; then the names, one label for those that share a place.
  const layer = { sensor: 2, actuator: 1, cause: 3 };
  // Where a place is marked, only what is marked has a name; a cause is shown there alone.
  const is_marked = (marker) => Boolean(marked) && marked.includes(marker.name);
  const shown = (marker) => (marked ? is_marked(marker) : marker.kind !== "cause");
  const order = data.markers.map((_, i) => i)
    .sort((a, b) => (layer[data.markers[a].kind] || 0) - (layer[data.markers[b].kind] || 0));
  const glyph = (pen, kind, [x, y]) => {
    pen.beginPath();
    if (kind === "sensor") pen.arc(x, y, 4.5, 0, 7);
    else if (kind === "actuator") { pen.moveTo(x, y - 8); pen.lineTo(x + 7, y + 5); pen.lineTo(x - 7, y + 5); pen.closePath(); }
    else if (kind === "cause") {
      for (let k = 0; k < 10; ++k) {
        const [r, angle] = [k % 2 ? 4.5 : 11, Math.PI * (k / 5 - 0.5)];
        pen.lineTo(x + r * Math.cos(angle), y + r * Math.sin(angle));
      }
      pen.closePath();
    } else pen.rect(x - 4.5, y - 4.5, 9, 9);
    pen.fillStyle = { sensor: "#ffd61a", actuator: "#1a7342", cause: "#e0301e" }[kind] || "#8c9199";
    pen.strokeStyle = kind === "actuator" || kind === "cause" ? "#fff" : "#1d2126";
    pen.lineWidth = 1;
    pen.fill();
    pen.stroke();
  };
  const ring = (pen, [x, y]) => {
    pen.beginPath();
    pen.arc(x, y, 16, 0, 7);
    pen.lineWidth = 3;
    pen.strokeStyle = "#e0301e";
    pen.stroke();
  };
  const labels = () => {
    const found = [];
    data.markers.forEach((marker, i) => {
      if (!(marker.kind in layer) || !shown(marker)) return;  // attachments tell their names under the mouse
      const [x, y] = places[i];
      const same = found.find((label) => Math.hypot(label.x - x, label.y - y) < 9);
      if (same) same.names.push(marker.name);
      else found.push({ x, y, names: [marker.name] });
    });
    return found;
  };
  const short = (text, most) => (text.length > most ? text.slice(0, most - 1) + "\u2026" : text);
  const drawMarkers = (turn, swing, { width, height, pixels }) => {
    const ratio = front.width / width, pen = front.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    places = data.markers.map((_, i) => {
      const place = seen(turn, data.markerVertex[i], swing);
      return [width / 2 + pixels * place[0], height / 2 - pixels * place[1]];
    });
    for (const i of order) {
      if (!marked && data.markers[i].kind === "cause") continue;
      glyph(pen, data.markers[i].kind, places[i]);
      if (is_marked(data.markers[i])) ring(pen, places[i]);
    }
    if (!state.names) return;
    pen.font = "12px system-ui, Arial, sans-serif";
    for (const { x, y, names } of labels()) {
      const text = short(names.slice(0, 3).join(", "), 30) + (names.length > 3 ? ", \u2026" : "");
      const left = Math.min(x + (marked ? 20 : 8), width - 4 - pen.measureText(text).width);
      pen.lineWidth = 3;
      pen.strokeStyle = Page.colours().back;
      pen.strokeText(text, left, y - 7);
      pen.fillStyle = Page.colours().ink;
      pen.fillText(text, left, y - 7);
    }
  };
  const draw = () => {
    const ratio = Math.min(devicePixelRatio || 1, 2), scale = scales(), { width, height, pixels } = scale;
    for (const canvas of [back, front]) {
      const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
      if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    }
    const turn = turned(), swing = Math.cos(state.phase);
    gl.viewport(0, 0, back.width, back.height);
    const back3 = [1, 3, 5].map((k) => parseInt(Page.colours().back.slice(k, k + 2), 16) / 255);
    gl.clearColor(...back3, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.uniformMatrix3fv(at.turn, true, turn.flat());
    gl.uniform2f(at.zoom, 2 * pixels / width, 2 * pixels / height);
    gl.uniform2f(at.shift, 0, 0);
    gl.uniform1f(at.amplitude, movement ? state.amplitude : 0);
    gl.uniform1f(at.swing, swing);
    gl.uniform1i(at.lines, state.lines ? 1 : 0);
    gl.uniform1i(at.plain, movement ? 0 : 1);
    gl.uniform1i(at.edges, 0);
    gl.uniform1f(at.lift, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, triangleBuffer);
    gl.drawElements(gl.TRIANGLES, triangles.length, gl.UNSIGNED_SHORT, 0);
    gl.uniform1i(at.edges, 1);
    gl.uniform1f(at.lift, 0.002);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, outlineBuffer);
    gl.drawElements(gl.LINES, outline.length, gl.UNSIGNED_SHORT, 0);
    drawMarkers(turn, swing, scale);
  };
  const tick = (now) => {
    waiting = false;
    const moves = state.playing && (movement || marked) && !document.hidden;
    if (moves && marked) state.yaw += Math.min(now - last, 100) * 0.0004;
    else if (moves) state.phase += Math.min(now - last, 100) * 0.0026;
    last = now;
    draw();
    if (moves) redraw();
  };
  const redraw = () => {
    if (!waiting) { waiting = true; requestAnimationFrame(tick); }
  };

  const play = find(".play");
  const setPlaying = (on) => {
    state.playing = on;
    play.textContent = on ? "Pause" : marked ? "Turn" : "Play";
    if (!on) state.phase = 0;
    redraw();
  };
  play.onclick = () => setPlaying(!state.playing);
  if (!marked) {
    find(".previous").onclick = () => show(state.shape - 1);
    find(".next").onclick = () => show(state.shape + 1);
    find(".amplitude").oninput = (event) => { state.amplitude = Number(event.target.value) / 100; redraw(); };
    find(".lines").onchange = (event) => { state.lines = event.target.checked; redraw(); };
    find(".names").onchange = (event) => { state.names = event.target.checked; redraw(); };
  }
  find(".reset").onclick = () => { Object.assign(state, { yaw: data.yaw, pitch: data.pitch, zoom: 1 }); redraw(); };
  const fingers = new Map();
  back.onpointerdown = (event) => { back.setPointerCapture(event.pointerId); fingers.set(event.pointerId, event); };
  back.onpointerup = back.onpointercancel = (event) => fingers.delete(event.pointerId);
  back.onpointermove = (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) {
      const near = ([x, y]) => Math.hypot(event.offsetX - x, event.offsetY - y) < 9;
      back.title = data.markers.filter((_, i) => places[i] && near(places[i]))
        .map((marker) => `${marker.kind} ${marker.name}`).join(", ");
      return;
    }
    if (fingers.size === 1) {
      state.yaw -= (event.clientX - before.clientX) * 0.008;
      state.pitch = Math.max(-1.57, Math.min(1.57, state.pitch + (event.clientY - before.clientY) * 0.008));
    } else {
      const other = [...fingers.values()].find((finger) => finger.pointerId !== event.pointerId);
      const gap = (finger) => Math.hypot(finger.clientX - other.clientX, finger.clientY - other.clientY) + 1;
      state.zoom = Math.max(0.3, Math.min(20, state.zoom * gap(event) / gap(before)));
    }
    fingers.set(event.pointerId, event);
    redraw();
  };
  back.addEventListener("wheel", (event) => {
    event.preventDefault();
    state.zoom = Math.max(0.3, Math.min(20, state.zoom * Math.exp(-event.deltaY * 0.0012)));
    redraw();
  }, { passive: false });
  back.onkeydown = (event) => {
    const turn = { ArrowLeft: () => show(state.shape - 1), ArrowRight: () => show(state.shape + 1),
      " ": () => setPlaying(!state.playing) }[event.key];
    if (turn) { event.preventDefault(); turn(); }
  };
  for (const row of marked ? [] : document.querySelectorAll("tr[data-shape]")) {
    row.tabIndex = 0;
    row.onclick = () => show(Number(row.dataset.shape));
    row.onkeydown = (event) => { if (event.key === "Enter") row.onclick(); };
  }
  new ResizeObserver(redraw).observe(stage);

  message.hidden = true;
  measure();
  setPlaying(state.playing);
  show(0);
  draw();

  // Both layers on one picture, for PNG and for paper.
  const picture = () => {
    draw();
    const sheet = Page.make("canvas");
    [sheet.width, sheet.height] = [back.width, back.height];
    const pen = sheet.getContext("2d");
    for (const layerCanvas of [back, front]) pen.drawImage(layerCanvas, 0, 0);
    return sheet;
  };
  controls.append(Page.button("PNG", "save this view as PNG", () =>
    picture().toBlob((blob) => Page.save(marked ? "place" : find(".label").textContent, "png", blob))));
  Page.dark.addEventListener("change", redraw);
  // Paper has the marked place, or the first shapes.
  const sheet = find(".sheet");
  const image = (label) => Page.make("figure", {}, Page.make("img", { src: picture().toDataURL(), alt: label }),
    Page.make("figcaption", {}, label));
  addEventListener("beforeprint", () => {
    const { shape, phase } = state;
    state.phase = 0;
    const shapes = marked ? [] : data.shapes.slice(0, Number(viewer.dataset.paper));
    sheet.replaceChildren(...(marked ? [image(marked.join(", "))] : shapes.map((one, k) => { show(k); return image(one.label); })));
    state.phase = phase;
    show(shape);
  });
  addEventListener("afterprint", () => sheet.replaceChildren());
};
{
  const data = document.getElementById("viewer-data");
  const parsed = data && JSON.parse(data.textContent);
  if (parsed) for (const viewer of document.querySelectorAll(".viewer")) start(viewer, parsed);
}
