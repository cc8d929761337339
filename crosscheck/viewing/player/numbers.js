// The arrays of the page, and how numbers are written.
"use strict";

const KINDS = { f4: Float32Array, f8: Float64Array, u2: Uint16Array, u4: Uint32Array };

// A function from the place of an array (kind, first byte, number of entries) to the array.
async function numberStore(text) {
  const buffer = await expanded(text).arrayBuffer();
  return ([kind, first, length]) => new KINDS[kind](buffer, first, length);
}

const LEAST = 1e-4;  // part of the load that a robot lets one expect, or that it has, below which there is nothing but noise

// The next 1, 2 or 5 times a power of ten that is not below x > 0.
function roundedUp(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  return [1, 2, 5, 10].find((digit) => digit * power >= x * (1 - 1e-9)) * power;
}

// Four significant digits.
function written(x) {
  const size = Math.abs(x);
  if (size !== 0 && (size >= 1e6 || size < 1e-4)) return x.toExponential(2).replaceAll("-", "−");
  return String(Number(x.toPrecision(4))).replace("-", "−");
}

// With as many decimals as give a scale four digits, so that numbers beside each other line up.
function besideScale(x, scale) {
  if (Number.isNaN(x)) return "–";
  const decimals = Math.min(Math.max(3 - Math.floor(Math.log10(scale)), 0), 6);
  return (Math.abs(x) < 0.5 * 10 ** -decimals ? 0 : x).toFixed(decimals).replace("-", "−");
}

// With a prefix where that is shorter: 2000 N as "2 kN".
function withUnit(x, unit) {
  if (x >= 1e6) return `${written(x / 1e6)} M${unit}`;
  if (x >= 1e3) return `${written(x / 1e3)} k${unit}`;
  return x < 0.1 ? `${written(x * 1e3)} m${unit}` : `${written(x)} ${unit}`;
}

// The last row of increasing times that is not after t, and how far t is towards the next one, from 0 to 1.
function rowAt(times, t) {
  let low = 0, high = times.length - 1;
  if (t >= times[high]) return [high, 0];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  return [low, Math.max(0, (t - times[low]) / (times[high] - times[low]))];
}

// Row k of rows of a width, a part u of the way to the next one: straight lines between rows.
function rowBetween(array, width, k, u) {
  const next = Math.min((k + 1) * width, array.length - width);
  return Array.from({ length: width }, (_, i) => array[k * width + i] * (1 - u) + array[next + i] * u);
}
