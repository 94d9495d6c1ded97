// The solid in three dimensions, by WebGL: triangles of its STL file, shaded, with its sharp edges.

const SHARP = Math.cos(Math.PI / 7); // of the angle at which two triangles meet in an edge
const VERTEX = `
attribute vec3 place; attribute vec3 normal;
uniform mat3 turned; uniform vec4 window; uniform vec3 middle;
varying vec3 seen;
void main() {
  vec3 at = turned * (place - middle);
  seen = turned * normal;
  gl_Position = vec4(at.x * window.x, at.y * window.y, window.w - at.z * window.z, 1.0);
}`;
const FRAGMENT = `
precision mediump float;
uniform vec3 color; uniform float flat_;
varying vec3 seen;
void main() {
  vec3 n = normalize(seen);
  float light = 0.35 + 0.65 * max(dot(n, normalize(vec3(0.35, 0.5, 0.8))), 0.0);
  gl_FragColor = vec4(color * mix(light, 1.0, flat_), 1.0);
}`;

function singles(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

// Normals of corners, smooth but across sharp edges, and both ends of each sharp edge.
function shaded(places) {
  const count = places.length / 9;
  const flat = new Float32Array(count * 3);
  const around = new Map();
  const edges = new Map();
  const key = (k) => `${places[k]},${places[k + 1]},${places[k + 2]}`;
  for (let t = 0; t < count; t++) {
    const [a, b, c] = [9 * t, 9 * t + 3, 9 * t + 6];
    const [u, v] = [b, c].map((k) => [0, 1, 2].map((i) => places[k + i] - places[a + i]));
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const long = Math.hypot(...n) || 1;
    n.forEach((each, i) => { flat[3 * t + i] = each / long; });
    const keys = [a, b, c].map(key);
    keys.forEach((each, i) => {
      if (!around.has(each)) around.set(each, []);
      around.get(each).push([t, long]);
      const other = keys[(i + 1) % 3];
      const edge = each < other ? `${each};${other}` : `${other};${each}`;
      if (!edges.has(edge)) edges.set(edge, [[a, b, c][i], [b, c, a][i]]);
      edges.get(edge).push(t);
    });
  }
  const dot = (s, t) => flat[3 * s] * flat[3 * t] + flat[3 * s + 1] * flat[3 * t + 1] + flat[3 * s + 2] * flat[3 * t + 2];
  const normals = new Float32Array(places.length);
  for (let k = 0; k < places.length; k += 3) {
    const own = Math.floor(k / 9);
    const sum = [0, 0, 0];
    for (const [t, long] of around.get(key(k))) if (dot(own, t) > SHARP) for (let i = 0; i < 3; i++) sum[i] += long * flat[3 * t + i];
    const long = Math.hypot(...sum) || 1;
    for (let i = 0; i < 3; i++) normals[k + i] = sum[i] / long;
  }
  const lines = [];
  for (const [a, b, s, t] of edges.values()) if (t === undefined || dot(s, t) < SHARP) for (const k of [a, b]) lines.push(places[k], places[k + 1], places[k + 2]);
  return [normals, new Float32Array(lines)];
}

function program(gl) {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  return made;
}

function solid(holder, found) {
  const canvas = holder.querySelector("canvas");
  const gl = canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true });
  if (!gl) {
    canvas.replaceWith("This browser has no WebGL, so the solid is not drawn.");
    return;
  }
  const places = singles(found.places);
  const [normals, lines] = shaded(places);
  const ends = [0, 1, 2].map((i) => {
    let [low, high] = [Infinity, -Infinity];
    for (let k = i; k < places.length; k += 3) [low, high] = [Math.min(low, places[k]), Math.max(high, places[k])];
    return [low, high];
  });
  const reach = 0.5 * Math.hypot(...ends.map(([low, high]) => high - low));
  const made = program(gl);
  gl.useProgram(made);
  const at = (name) => gl.getUniformLocation(made, name);
  const buffers = [places, normals, lines].map((values) => {
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    return buffer;
  });
  const [place, normal] = ["place", "normal"].map((name) => gl.getAttribLocation(made, name));
  gl.enableVertexAttribArray(place);
  gl.enable(gl.DEPTH_TEST);
  gl.uniform3fv(at("middle"), ends.map(([low, high]) => 0.5 * (low + high)));
  const first = [-30, 55, 1.25];
  let [yaw, pitch, zoom] = first;
  const draw = () => {
    const [a, b] = [yaw, pitch].map((each) => (each * Math.PI) / 180);
    const [c, s, d, p] = [Math.cos(a), Math.sin(a), Math.cos(b), Math.sin(b)];
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    // about z by yaw, then back from the viewer by pitch, which shows the near side; by columns
    gl.uniformMatrix3fv(at("turned"), false, [c, s * d, -s * p, -s, c * d, -c * p, 0, p, d]);
    const wide = canvas.height / canvas.width;
    const scale = (0.95 * zoom) / reach;
    gl.uniform4f(at("window"), scale * wide, scale, 0.4 / reach, 0);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    gl.uniform3f(at("color"), 0.78, 0.83, 0.88);
    gl.uniform1f(at("flat_"), 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffers[0]);
    gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
    gl.enableVertexAttribArray(normal);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffers[1]);
    gl.vertexAttribPointer(normal, 3, gl.FLOAT, false, 0, 0);
    gl.drawArrays(gl.TRIANGLES, 0, places.length / 3);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.uniform3f(at("color"), 0.07, 0.21, 0.36);
    gl.uniform1f(at("flat_"), 1);
    gl.disableVertexAttribArray(normal);
    gl.vertexAttrib3f(normal, 0, 0, 1);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffers[2]);
    gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
    gl.drawArrays(gl.LINES, 0, lines.length / 3);
    canvas.dataset.view = `${yaw} ${pitch} ${zoom}`;
  };
  const look = (across, up, closer = 1) => {
    yaw = (yaw + across) % 360;
    pitch = Math.min(Math.max(pitch - up, 0), 180);
    zoom = Math.min(Math.max(zoom * closer, 0.5), 20);
    draw();
  };
  const ways = { left: [-15, 0], right: [15, 0], up: [0, 15], down: [0, -15], closer: [0, 0, 1.25], farther: [0, 0, 0.8] };
  for (const button of holder.querySelectorAll("button")) {
    button.addEventListener("click", () => {
      if (button.value === "back") [yaw, pitch, zoom] = first;
      look(...(ways[button.value] ?? [0, 0]));
    });
  }
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => {
    if (event.buttons) look(0.5 * event.movementX, 0.5 * event.movementY);
  });
  draw();
}
