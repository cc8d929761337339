// The view: camera, lights and ground, names over the picture, and the legend of the arrows.
"use strict";

const FIELD = 34;  // of view [degrees]
const DIRECTION = [0.72, -1, 0.5];  // of the camera, from the robot
const BEFORE = [1, -0.35, 0.45];  // the same before robots side by side
const AIR = 1.1;  // room around the robot when the whole view is shown
const GAP = 0.2;  // between robots side by side, over the width of the widest
const BAR = 76;  // width of a bar of the legend at most [pixels]

class Stage {
  constructor(element, figures) {
    this.element = element;
    this.figures = figures;
    this.scene = new THREE.Scene();
    this.lights();
    for (const figure of figures) this.scene.add(figure.place);
    this.labels = [];
    this.changed = true;
    try {
      this.renderer = new THREE.WebGLRenderer({ antialias: true, powerPreference: "low-power" });
    } catch (error) {
      this.renderer = null;
      trouble("3-D needs WebGL, which this browser lacks; numbers and curves still work.");
    }
    this.camera = new THREE.PerspectiveCamera(FIELD, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    if (!this.renderer) return;
    element.prepend(this.renderer.domElement);
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.controls = new THREE.OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => { this.changed = true; });
    this.controls.addEventListener("start", () => { this.turned = true; });  // by a hand: no longer the whole view
  }

  lights() {
    const sky = new THREE.HemisphereLight(0xffffff, 0x9aa0a8, 1.5), sun = new THREE.DirectionalLight(0xffffff, 2.1);
    const back = new THREE.DirectionalLight(0xdfe8ff, 0.7);
    sky.position.set(0, 0, 1);
    sun.position.set(1.2, -1.6, 2.4);
    back.position.set(-1.5, 1.2, 0.8);
    this.scene.add(sky, sun, back);
  }

  // Measure the robots over their motions, or as they stand; the first time also furnish them in sizes that suit.
  measure() {
    this.boxes = this.figures.map(extent);
    if (!this.size) {
      this.size = Math.max(...this.boxes.map(([low, high]) => Math.hypot(...minus(high, low)) / 2), 1e-3);
      for (const figure of this.figures) figure.furnish(this.size);
    }
    this.setApart(this.apart ?? true);
  }

  // Robots side by side, or in one place.
  setApart(apart) {
    this.apart = apart;
    const gap = GAP * Math.max(...this.boxes.map(([low, high]) => high[1] - low[1])) + 0.1 * this.size;
    let next = 0;
    this.figures.forEach((figure, k) => {
      const [low, high] = this.boxes[k], first = next;
      if (apart && k > 0) next -= low[1];
      figure.place.position.set(0, apart ? next : 0, 0);
      next = apart ? next + high[1] + gap : first;
    });
    const corners = this.boxes.map((box, k) => box.map((corner) => plus(corner, this.figures[k].place.position.toArray())));
    this.low = [0, 1, 2].map((i) => Math.min(...corners.map(([low]) => low[i])));
    this.high = [0, 1, 2].map((i) => Math.max(...corners.map(([, high]) => high[i])));
    this.ground();
    this.changed = true;
  }

  ground() {
    if (this.grid) this.scene.remove(this.grid);
    this.cell = roundedUp(this.size / 4);
    const height = Math.min(...this.figures.map((figure) => figure.robot.base.translation[2]));
    const middle = times(plus(this.low, this.high), 0.5), half = Math.hypot(...minus(this.high, this.low)) / 2 + 1.2 * this.size;
    this.grid = groundGrid(middle, half, this.cell, height, dark() ? [0x343a41, 0x474e57] : [0xdfe3e8, 0xc6ccd3]);
    this.scene.add(this.grid);
  }

  colors() {
    this.scene.background = new THREE.Color(dark() ? 0x24282d : 0xf6f7f9);
    if (this.boxes) this.ground();
    this.changed = true;
  }

  // Turn the camera so that all is seen: so far away that no corner of the box leaves the picture.
  whole() {
    this.turned = false;
    this.measure();
    const middle = times(plus(this.low, this.high), 0.5), from = this.figures.length > 1 && this.apart ? BEFORE : DIRECTION;
    const toward = times(from, 1 / Math.hypot(...from));
    const right = times([-toward[1], toward[0], 0], 1 / Math.hypot(toward[0], toward[1])), up = cross(toward, right);
    const slope = Math.tan((Math.PI / 360) * FIELD), corners = [0, 1, 2, 3, 4, 5, 6, 7].map((c) =>
      minus([0, 1, 2].map((i) => (c & (1 << i) ? this.high : this.low)[i]), middle));
    const distances = corners.map((corner) =>
      dot(corner, toward) + Math.max(Math.abs(dot(corner, right)) / this.camera.aspect, Math.abs(dot(corner, up))) / slope);
    const distance = Math.max(AIR * Math.max(...distances), 2 * this.size);
    this.camera.position.set(...plus(middle, times(toward, distance)));
    this.camera.near = distance / 200;
    this.camera.far = 40 * distance;
    this.camera.updateProjectionMatrix();
    this.controls?.target.set(...middle);
    this.controls?.update();
    this.changed = true;
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (!width || !height) return;
    this.renderer?.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (!this.turned) this.whole();
    this.changed = true;
  }

  // Names of the robots below them, where there are several; at the joints where asked for.
  setNames(ofJoints) {
    const place = document.getElementById("labels");
    place.replaceChildren();
    const label = (text, figure, body, kind) => {
      const element = document.createElement("span");
      element.textContent = text;
      element.className = kind;
      place.append(element);
      return { element, figure, body };
    };
    this.labels = this.figures.flatMap((figure) => [
      ...(this.figures.length > 1 && this.apart ? [label(figure.name, figure, 0, "robot")] : []),
      ...(ofJoints ? figure.robot.joints.map((joint, j) => label(joint.name, figure, j + 1, "joint")) : []),
    ]);
    this.changed = true;
  }

  draw() {
    this.changed = false;
    if (!this.renderer) return;
    this.renderer.render(this.scene, this.camera);
    const { clientWidth: width, clientHeight: height } = this.element, point = new THREE.Vector3();
    for (const { element, figure, body } of this.labels) {
      point.set(...figure.shown.bodies[body].translation).add(figure.place.position).project(this.camera);
      element.hidden = point.z > 1;
      element.style.left = `${((point.x + 1) / 2) * width}px`;
      element.style.top = `${((1 - point.y) / 2) * height}px`;
    }
  }

  // Pixels of a meter at the point about which the camera turns.
  pixelsPerMetre() {
    const distance = this.controls ? this.camera.position.distanceTo(this.controls.target) : this.size * 4;
    return this.element.clientHeight / (2 * distance * Math.tan((Math.PI / 360) * FIELD));
  }

  // What arrows of a size mean: bars as long as an arrow at the point about which the camera turns.
  legend(scales, shown) {
    const rows = [["force", "N", "reaction force"], ["moment", "N m", "reaction moment"]].filter(([kind]) => shown[kind]);
    const lines = rows.map(([kind, unit, meaning]) => {
      const pixels = this.pixelsPerMetre() * scales[kind], value = roundedUp(BAR / pixels) > (BAR / pixels) * 1.001 ? roundedDown(BAR / pixels) : BAR / pixels;
      return legendRow(kind, Math.round(value * pixels), `${withUnit(value, unit)}`, meaning);
    });
    if (shown.torques) lines.push(legendRow("torque", 0, `${withUnit(scales.torque, "N m")}`, "actuator torque, ¾ turn"));
    lines.push(legendRow("grid", 0, withUnit(this.cell, "m"), "grid"));
    document.getElementById("legend").replaceChildren(...lines);
  }
}

const dark = () => matchMedia("(prefers-color-scheme: dark)").matches;
const roundedDown = (x) => 1 / roundedUp(1 / x);

function legendRow(kind, width, value, meaning) {
  const row = document.createElement("div"), bar = document.createElement("i"), number = document.createElement("b");
  bar.className = kind;
  if (width) bar.style.width = `${width}px`;
  number.textContent = value;
  const words = document.createElement("span");
  words.textContent = meaning;
  row.append(bar, number, words);
  return row;
}

function trouble(text) {
  const place = document.getElementById("trouble");
  place.textContent = text;
  place.hidden = false;
}

const INSTANTS = 40;

// The box of a robot over its motion [low, high]: of its shapes as it stands, of joints and centers of mass all along.
function extent(figure) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const take = (point) => point.forEach((x, i) => { low[i] = Math.min(low[i], x); high[i] = Math.max(high[i], x); });
  const still = figure.instant(0).bodies;
  take(figure.robot.base.translation);
  for (let k = 0; k <= (figure.motion ? INSTANTS : 0); k++) {
    const bodies = figure.instant((figure.duration * k) / INSTANTS).bodies;
    figure.robot.bodies.forEach((body, j) => { take(bodies[j + 1].translation); take(centerOfMass(body, bodies[j + 1])); });
  }
  figure.robot.shapes.forEach((shape, s) => {
    const places = figure.layers.shapes[s].geometry.attributes.position.array, at = still[shape.body];
    for (let i = 0; i < places.length; i += 3) take(plus(at.translation, turned(at.rotation, [places[i], places[i + 1], places[i + 2]])));
  });
  return [low, high];
}

// Lines of cells of a width, through the origin, every fifth one stronger.
function groundGrid(middle, half, cell, height, [weak, strong]) {
  const grid = new THREE.Group(), from = [0, 1].map((i) => Math.floor((middle[i] - half) / cell)), count = Math.ceil((2 * half) / cell) + 1;
  for (const [color, chosen] of [[weak, (k) => k % 5 !== 0], [strong, (k) => k % 5 === 0]]) {
    const points = [];
    for (let k = 0; k <= count; k++) {
      const [x, y] = from.map((first) => (first + k) * cell), [x0, y0] = from.map((first) => first * cell), [x1, y1] = from.map((first) => (first + count) * cell);
      if (chosen(from[0] + k)) points.push(x, y0, height, x, y1, height);
      if (chosen(from[1] + k)) points.push(x0, y, height, x1, y, height);
    }
    const lines = new THREE.BufferGeometry();
    lines.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
    grid.add(new THREE.LineSegments(lines, new THREE.LineBasicMaterial({ color })));
  }
  return grid;
}
