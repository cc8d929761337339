// On the line of the time, the instants at which loads of joints are largest.
"use strict";

// Kind, instant [s] and words, of what is largest over the motion of a figure.
function largestInstants(figure) {
  if (!figure.duration) return [];
  const instants = Array.from(figure.motion.time, (t) => figure.moving(t));
  const sizes = {
    force: ({ wrenches }) => wrenches.map(([force]) => Math.hypot(...force)),
    moment: ({ wrenches }) => wrenches.map(([, moment]) => Math.hypot(...moment)),
  };
  return Object.entries(sizes).flatMap(([kind, size]) => {
    let largest = 0, at = null;
    instants.forEach((instant, row) => size(instant).forEach((x, j) => { if (x > largest) [largest, at] = [x, [row, j]]; }));
    if (at === null) return [];
    const t = figure.motion.time[at[0]], unit = kind === "force" ? "N" : "N m";
    return [[kind, t, `largest ${kind}: ${withUnit(largest, unit)} at ${figure.robot.joints[at[1]].name}, ${t.toFixed(2)} s`]];
  });
}

// duration: of the line, which may be that of a longer motion
function showMarks(element, figure, duration, seek) {
  element.replaceChildren(...largestInstants(figure).map(([kind, t, words]) => {
    const mark = html("button", { type: "button", className: kind, title: words, ariaLabel: words });
    mark.style.left = `calc(${THUMB / 2}px + ${t / duration} * (100% - ${THUMB}px))`;
    mark.addEventListener("click", () => seek(t));
    return mark;
  }));
}

const THUMB = 16;  // width of the knob of a slider [pixels]
