// Arrows for vectors, and arcs for torques about an axis; drawn over the robot, so that none hides inside a link.
"use strict";

const overlay = (color) => new THREE.MeshLambertMaterial({ color, depthTest: false, transparent: true });

const ALONG = [0, 1, 0];  // of cylinders and cones as three.js makes them

// A fixed number of arrows of one color; with two heads, as moments are drawn.
class Arrows {
  constructor(count, color, thickness, heads, place) {
    this.thickness = thickness;
    const shaft = new THREE.CylinderGeometry(1, 1, 1, 12).translate(0, 0.5, 0);
    const head = new THREE.ConeGeometry(1, 1, 20).translate(0, -0.5, 0);  // the tip at the origin
    this.parts = [shaft, ...Array(heads).fill(head)].map((geometry) => {
      const part = new THREE.InstancedMesh(geometry, overlay(color), count);
      part.frustumCulled = false;
      part.renderOrder = 3;
      place.add(part);
      return part;
    });
  }

  set visible(shown) {
    for (const part of this.parts) part.visible = shown;
  }

  // Arrow j from a point, as far as a vector reaches [m]; none where the vector is not known.
  set(j, from, given) {
    const vector = given.every(Number.isFinite) ? given : [0, 0, 0];
    const direction = new THREE.Vector3(...vector), length = direction.length(), up = new THREE.Vector3(...ALONG);
    const turn = new THREE.Quaternion().setFromUnitVectors(up, length > 0 ? direction.clone().normalize() : up);
    const thin = Math.min(this.thickness, length / 9), head = 5 * thin, shown = length - head, [shaft, ...heads] = this.parts;
    const matrix = new THREE.Matrix4(), start = new THREE.Vector3(...from);
    shaft.setMatrixAt(j, matrix.compose(start, turn, new THREE.Vector3(thin, shown, thin)));
    heads.forEach((part, k) => {
      const tip = start.clone().addScaledVector(direction, length > 0 ? (length - 0.75 * k * head) / length : 0);
      part.setMatrixAt(j, matrix.compose(tip, turn, new THREE.Vector3(head / 2.2, head, head / 2.2)));
    });
    for (const part of this.parts) part.instanceMatrix.needsUpdate = true;
  }

  // Where arrow j is drawn to begin and to end, read from what is drawn.
  ends(j) {
    const point = (part) => {
      const matrix = new THREE.Matrix4();
      part.getMatrixAt(j, matrix);
      return new THREE.Vector3().setFromMatrixPosition(matrix).toArray();
    };
    return [point(this.parts[0]), point(this.parts[1])];
  }
}

const ARC_STEPS = 72, ARC_SIDES = 8;
const FULL_ARC = 1.5 * Math.PI;

// Arrow heads on arcs of three quarters of a turn or less, right-handed about z, in the plane z = 0.
class Arc {
  constructor(color, radius, thickness) {
    const places = [], faces = [];
    for (let k = 0; k <= ARC_STEPS; k++) {
      const angle = (FULL_ARC * k) / ARC_STEPS;
      for (let i = 0; i < ARC_SIDES; i++) {
        const around = (2 * Math.PI * i) / ARC_SIDES, distance = radius + thickness * Math.cos(around);
        places.push(distance * Math.cos(angle), distance * Math.sin(angle), thickness * Math.sin(around));
        const here = k * ARC_SIDES + i, beside = k * ARC_SIDES + ((i + 1) % ARC_SIDES);
        if (k < ARC_STEPS) faces.push(here, here + ARC_SIDES, beside, beside, here + ARC_SIDES, beside + ARC_SIDES);
      }
    }
    const tube = new THREE.BufferGeometry();
    tube.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
    tube.setIndex(faces);
    tube.computeVertexNormals();
    const material = overlay(color);
    this.tube = new THREE.Mesh(tube, material);
    this.head = new THREE.Mesh(new THREE.ConeGeometry(3 * thickness, 7 * thickness, 20), material);
    this.turned = new THREE.Group().add(this.tube, this.head);  // over on its side where the torque is negative
    this.place = new THREE.Group().add(this.turned);
    this.radius = radius;
    for (const part of [this.tube, this.head]) part.renderOrder = 3;
  }

  // Part of the full arc, from -1 to 1; a larger one is drawn as full.
  set(part) {
    const sweep = Math.min(Math.abs(part), 1) * FULL_ARC;
    this.turned.visible = sweep > 0.01;
    this.head.scale.setScalar(Math.min(1, 2 * sweep));
    this.turned.rotation.x = part < 0 ? Math.PI : 0;
    this.tube.geometry.setDrawRange(0, 6 * ARC_SIDES * Math.round((sweep / FULL_ARC) * ARC_STEPS));
    this.head.position.set(this.radius * Math.cos(sweep), this.radius * Math.sin(sweep), 0);
    this.head.rotation.z = sweep;
  }
}
