// Where the bodies of a robot are, and what its joints transmit: graphdyn's definitions, on arrays in world axes.
// A placement has rotation, nine numbers row by row, and translation. Body 0 is the ground.
"use strict";

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times = (a, factor) => [a[0] * factor, a[1] * factor, a[2] * factor];
const turned = (R, a) => [0, 3, 6].map((row) => R[row] * a[0] + R[row + 1] * a[1] + R[row + 2] * a[2]);

function product(A, B) {
  const rows = [0, 3, 6], columns = [0, 1, 2];
  return rows.flatMap((i) => columns.map((k) => A[i] * B[k] + A[i + 1] * B[k + 3] + A[i + 2] * B[k + 6]));
}

// Rodrigues' formula: about a unit axis by an angle [rad].
function rotationAbout([x, y, z], angle) {
  const c = Math.cos(angle), s = Math.sin(angle), d = 1 - c;
  return [
    c + d * x * x, d * x * y - s * z, d * x * z + s * y,
    d * x * y + s * z, c + d * y * y, d * y * z - s * x,
    d * x * z - s * y, d * y * z + s * x, c + d * z * z,
  ];
}

// Of all joints, from those of the independent ones: K q + o.
const jointPositions = (robot, q) => robot.matrix.map((row, j) => row.reduce((sum, ratio, k) => sum + ratio * q[k], robot.offset[j]));

// Of the ground and all bodies.
function placements(robot, q) {
  const found = [robot.base];
  jointPositions(robot, q).forEach((position, j) => {
    const joint = robot.joints[j], inside = found[joint.inside];
    const rotation = product(inside.rotation, joint.rotation);
    const origin = plus(inside.translation, turned(inside.rotation, joint.translation));
    found.push(joint.kind === "prismatic"
      ? { rotation, translation: plus(origin, times(turned(rotation, joint.axis), position)) }
      : { rotation: product(rotation, rotationAbout(joint.axis, position)), translation: origin });
  });
  return found;
}

const centerOfMass = (body, placement) => plus(placement.translation, turned(placement.rotation, body.center));

// Wrench of the inside body on body j at O_j, per joint [force, moment], of a robot at rest: the weight of all that j carries.
function wrenchesAtRest(robot, bodies) {
  const wrenches = robot.joints.map((_, j) => {
    const force = times(robot.gravity, -robot.bodies[j].mass);
    return [force, cross(minus(centerOfMass(robot.bodies[j], bodies[j + 1]), bodies[j + 1].translation), force)];
  });
  for (let j = wrenches.length - 1; j >= 0; j--) {
    const i = robot.joints[j].inside;
    if (i === 0) continue;
    const [force, moment] = wrenches[j], lever = minus(bodies[j + 1].translation, bodies[i].translation);
    wrenches[i - 1] = [plus(wrenches[i - 1][0], force), plus(wrenches[i - 1][1], plus(moment, cross(lever, force)))];
  }
  return wrenches;
}

// Wrenches in world axes from 6 n numbers in link axes.
const inWorldAxes = (bodies, numbers) => bodies.slice(1).map(({ rotation }, j) => [
  turned(rotation, numbers.slice(6 * j, 6 * j + 3)), turned(rotation, numbers.slice(6 * j + 3, 6 * j + 6)),
]);

const worldAxis = (robot, bodies, j) => turned(bodies[j + 1].rotation, robot.joints[j].axis);

// Torques, of prismatic joints forces, of the actuators: what the wrenches have along the axes, through the couplings.
function actuatorTorques(robot, bodies, wrenches) {
  const along = wrenches.map((wrench, j) => dot(worldAxis(robot, bodies, j), wrench[robot.joints[j].kind === "prismatic" ? 0 : 1]));
  return robot.independent.map((_, k) => along.reduce((sum, torque, j) => sum + robot.matrix[j][k] * torque, 0));
}

// The five multipliers of joint j: revolute, the force in world axes, then moments about t_1 and t_2; prismatic, forces
// along t_1 and t_2, then moments about t_1, t_2 and the axis.
function multipliers(robot, bodies, wrench, j) {
  const joint = robot.joints[j], inside = bodies[joint.inside], [force, moment] = wrench;
  const [t1, t2] = joint.normals.map((normal) => turned(inside.rotation, turned(joint.rotation, normal)));
  if (joint.kind !== "prismatic") return [...force, dot(t1, moment), dot(t2, moment)];
  return [dot(t1, force), dot(t2, force), dot(t1, moment), dot(t2, moment), dot(worldAxis(robot, bodies, j), moment)];
}
