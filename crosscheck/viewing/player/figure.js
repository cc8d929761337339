// One robot on the stage: its shapes, what can be shown besides, and its loads at one instant.
"use strict";

const COLORS = { force: 0xd0342c, moment: 0x2c62d0, torque: 0xe08a00, center: 0xf0b400, ellipsoid: 0x2a9d6c, axis: 0x00929b, chord: 0x8a4fbf, collision: 0x8fb339, chosen: 0x7a4a00 };
const CREASE = 0.6;  // angle from which an edge is drawn sharp [rad]

const matrixOf = ({ rotation: R, translation: t }) =>
  new THREE.Matrix4().set(R[0], R[1], R[2], t[0], R[3], R[4], R[5], t[1], R[6], R[7], R[8], t[2], 0, 0, 0, 1);

class Figure {
  constructor({ name, notes, start, motion }, robot, array) {
    Object.assign(this, { name, notes, start, robot });
    this.n = robot.joints.length;
    this.place = new THREE.Group();
    this.bodies = [robot.base, ...robot.bodies].map(() => new THREE.Group());
    for (const body of this.bodies) { body.matrixAutoUpdate = false; this.place.add(body); }
    this.layers = {
      shapes: robot.shapes.map((shape) => this.addShape(shape, array)),
      collision: robot.collision.map((shape) => this.addShape({ ...shape, color: null }, array)),
    };
    this.follow(motion, array);
  }

  // A motion as crosscheck/viewing/scene.py writes it, or null.
  follow(motion, array) {
    this.motion = motion && Object.fromEntries(Object.entries(motion).map(([name, place]) => [name, place && array(place)]));
    this.duration = motion ? this.motion.time.at(-1) : 0;
    this.hand = motion ? null : this.start;  // positions set by hand; null while it follows its motion
  }

  addShape(shape, array) {
    const steps = array(shape.vertices), faces = array(shape.faces);
    const places = Float32Array.from(steps, (step, i) => shape.low[i % 3] + step * shape.step[i % 3]);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
    geometry.setIndex(new THREE.BufferAttribute(faces, 1));
    const [red, green, blue, opacity] = shape.color ?? [0, 0, 0, 0.45];
    const color = shape.color ? new THREE.Color().setRGB(red, green, blue, "srgb") : new THREE.Color(COLORS.collision);
    const material = new THREE.MeshLambertMaterial({ color, side: THREE.DoubleSide, opacity, transparent: opacity < 1 });
    const mesh = new THREE.Mesh(THREE.toCreasedNormals(geometry, CREASE), material);
    Object.assign(mesh.userData, { opacity, body: shape.body });
    this.bodies[shape.body].add(mesh);
    return mesh;
  }

  // The shapes of a body stand out; of none for -1.
  mark(number) {
    for (const mesh of [...this.layers.shapes, ...this.layers.collision]) mesh.material.emissive.setHex(mesh.userData.body === number ? COLORS.chosen : 0);
  }

  // All else that can be shown, in sizes that suit the stage: size is the half of what it shows [m].
  furnish(size) {
    const { robot, n } = this, largest = Math.max(...robot.bodies.map((body) => body.mass)) || 1;
    const frame = frameGeometry(0.1 * size, 0.004 * size), sphere = new THREE.SphereGeometry(1, 32, 20);
    const rod = new THREE.CylinderGeometry(0.004 * size, 0.004 * size, 0.36 * size, 8);
    const colors = new THREE.MeshBasicMaterial({ vertexColors: true, depthTest: false, transparent: true });
    const axis = new THREE.MeshBasicMaterial({ color: COLORS.axis, depthTest: false, transparent: true });
    const center = overlay(COLORS.center);
    const glass = new THREE.MeshLambertMaterial({ color: COLORS.ellipsoid, transparent: true, opacity: 0.4, depthWrite: false });
    Object.assign(this.layers, { frames: [], axes: [], centers: [], ellipsoids: [], torques: [] });
    this.bodies.forEach((group) => this.layers.frames.push(added(group, new THREE.Mesh(frame, colors), 2)));
    robot.joints.forEach((joint, j) => {
      const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(...ALONG), new THREE.Vector3(...joint.axis));
      const line = added(this.bodies[j + 1], new THREE.Mesh(rod, axis), 2);
      line.quaternion.copy(turn);
      this.layers.axes.push(line);
      const arc = new Arc(COLORS.torque, 0.13 * size, 0.006 * size);
      arc.place.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), new THREE.Vector3(...joint.axis));
      this.bodies[j + 1].add(arc.place);
      this.layers.torques.push(arc);
    });
    robot.bodies.forEach((body, j) => {
      const dot = added(this.bodies[j + 1], new THREE.Mesh(sphere, center), 2);
      dot.position.set(...body.center);
      dot.scale.setScalar(0.026 * size * Math.cbrt(Math.max(body.mass / largest, 0.02)));
      this.layers.centers.push(dot);
      if (!body.ellipsoid) return;
      const ellipsoid = added(this.bodies[j + 1], new THREE.Mesh(sphere, glass), 1);
      ellipsoid.matrixAutoUpdate = false;
      ellipsoid.matrix.copy(matrixOf({ rotation: body.ellipsoid.rotation, translation: body.center }));
      ellipsoid.matrix.scale(new THREE.Vector3(...body.ellipsoid.axes.map((half) => Math.max(half, 1e-6))));
      this.layers.ellipsoids.push(ellipsoid);
    });
    this.layers.chords = robot.chords.flatMap((chord) => chord.ends.map((end) => chordMarker(chord, end, this.bodies[end.body], size)));
    this.force = new Arrows(n, COLORS.force, 0.0075 * size, 1, this.place);
    this.moment = new Arrows(n, COLORS.moment, 0.0075 * size, 2, this.place);
    this.slide = new Arrows(n, COLORS.torque, 0.0075 * size, 1, this.place);
    Object.assign(this.layers, { force: [this.force], moment: [this.moment], slide: [this.slide] });
  }

  // What it does at a time of the stage: positions, placements, wrenches in world axes, torques.
  instant(t) {
    return this.hand ? this.atRest(this.hand) : this.moving(t);
  }

  moving(t) {
    const { time, q, wrenches, tau, recorded } = this.motion, free = this.robot.independent.length;
    const [k, u] = rowAt(time, t), position = rowBetween(q, free, k, u), bodies = placements(this.robot, position);
    return {
      q: position, bodies, wrenches: inWorldAxes(bodies, rowBetween(wrenches, 6 * this.n, k, u)),
      tau: rowBetween(tau, free, k, u), recorded: recorded && rowBetween(recorded, free, k, u),
    };
  }

  atRest(q) {
    const bodies = placements(this.robot, q), wrenches = wrenchesAtRest(this.robot, bodies);
    return { q, bodies, wrenches, tau: actuatorTorques(this.robot, bodies, wrenches), recorded: null };
  }

  // Draw an instant; lengths per newton and newton meter, and the torque of a full arc, in scales.
  show(instant, scales) {
    this.bodies.forEach((group, i) => { group.matrix.copy(matrixOf(instant.bodies[i])); });
    instant.wrenches.forEach(([force, moment], j) => {
      const origin = instant.bodies[j + 1].translation, slides = this.slides(j);
      const axis = worldAxis(this.robot, instant.bodies, j), along = dot(axis, slides ? force : moment);
      this.force.set(j, origin, times(force, scales.force));
      this.moment.set(j, origin, times(moment, scales.moment));
      this.slide.set(j, origin, times(axis, slides ? along * scales.force : 0));
      this.layers.torques[j].set(slides ? 0 : along / scales.torque);
    });
    this.shown = instant;
  }

  // The largest force, moment and torque about an axis of every instant of the motion, and at rest: {kind: numbers}.
  loads() {
    const instants = this.motion ? Array.from(this.motion.time, (t) => this.moving(t)) : [];
    if (!this.robot.chords.length) instants.push(this.atRest(this.start));
    const about = (instant, wrench, j) => (this.slides(j) ? 0 : Math.abs(dot(worldAxis(this.robot, instant.bodies, j), wrench[1])));
    const largest = (size) => instants.map((instant) => Math.max(...instant.wrenches.map((wrench, j) => size(instant, wrench, j) || 0)));
    return {
      force: largest((_, wrench) => Math.hypot(...wrench[0])), moment: largest((_, wrench) => Math.hypot(...wrench[1])), torque: largest(about),
    };
  }

  slides(j) {
    return this.robot.joints[j].kind === "prismatic";
  }

  // Where joint j's arrow of a kind is drawn: two points in the world.
  arrow(kind, j) {
    const shift = this.place.position.toArray();
    return this[kind].ends(j).map((point) => plus(point, shift));
  }
}

function added(group, mesh, order) {
  mesh.renderOrder = order;
  group.add(mesh);
  return mesh;
}

// One end of a connection that closes a loop: where the loop is closed, both ends are in one place.
function chordMarker(chord, end, group, size) {
  const material = new THREE.MeshLambertMaterial({ color: COLORS.chord, depthTest: false, transparent: true });
  const marker = added(group, new THREE.Mesh(new THREE.SphereGeometry(0.022 * size, 24, 16), material), 2);
  marker.position.set(...end.translation);
  if (chord.axis) {
    const rod = new THREE.Mesh(new THREE.CylinderGeometry(0.006 * size, 0.006 * size, 0.16 * size, 10), material);
    rod.quaternion.setFromUnitVectors(new THREE.Vector3(...ALONG), new THREE.Vector3(...turned(end.rotation, chord.axis)));
    rod.renderOrder = 2;
    marker.add(rod);
  }
  return marker;
}

// x, y and z of a frame in red, green and blue.
function frameGeometry(length, radius) {
  const colors = [[0.86, 0.2, 0.18], [0.2, 0.62, 0.25], [0.16, 0.42, 0.86]];
  const parts = colors.map((color, k) => {
    const rod = new THREE.CylinderGeometry(radius, radius, length, 8).translate(0, length / 2, 0);
    if (k === 0) rod.rotateZ(-Math.PI / 2);
    if (k === 2) rod.rotateX(Math.PI / 2);
    const shown = new THREE.Color().setRGB(...color, "srgb").toArray();
    const each = Array.from({ length: rod.attributes.position.count }, () => shown).flat();
    rod.setAttribute("color", new THREE.BufferAttribute(new Float32Array(each), 3));
    return rod;
  });
  return THREE.mergeGeometries(parts);
}
