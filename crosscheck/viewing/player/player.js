// The page as a whole: time, play and keys, and what happens when something is moved.
"use strict";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
const ARROW = 0.5;  // length of a usual arrow at first, over the size of the robot
const USUAL = 0.9;  // part of the instants whose arrows are shorter at first: a shock does not make all others small
const NOTES = 3;  // that are shown unasked
const FALL = 5;  // time that a robot is let go [s]
const STEP = 0.02;  // of the arrow keys [s]
const $ = (id) => document.getElementById(id);

async function main() {
  await runLibraries();
  const scene = JSON.parse($("scene").textContent), array = await numberStore($("numbers").textContent);
  const figures = scene.figures.map((figure) => new Figure(figure, scene.robots[figure.robot], array));
  const stage = new Stage($("stage"), figures);
  stage.colors();
  stage.whole();
  const state = { t: 0, playing: false, speed: 1, selected: figures[0], dirty: true }, shown = {}, sizes = {};
  const longest = () => Math.max(...figures.map((figure) => figure.duration));
  let duration = longest();
  const base = firstScales(figures, stage.size);
  let rows = null;

  const scales = () => ({ force: base.force * sizes.force, moment: base.moment * sizes.moment, torque: base.torque });
  const curves = new Curves($("chart"), seek);
  const absent = { loops: (robot) => !robot.chords.length, "collision shapes": (robot) => !robot.collision.length };
  const switches = SWITCHES.filter(([, name]) => !figures.every(({ robot }) => absent[name]?.(robot)));
  const link = new LinkNumbers($("told"), $("body"), stage, (figure) => {
    if (figure === state.selected) return;
    $("figure").selectedIndex = figures.indexOf(figure);
    select(figure);
    state.dirty = true;
  });
  const keys = makeSwitches($("switches"), switches, shown, sizes, applySwitches);

  function applySwitches() {
    for (const [, name, , layers] of switches)
      for (const figure of figures)
        for (const part of layers.flatMap((layer) => figure.layers[layer])) (part.place ?? part).visible = shown[name];
    for (const mesh of figures.flatMap((figure) => figure.layers.shapes)) {
      const opacity = mesh.userData.opacity * sizes.opacity, see = opacity < 1;
      if (mesh.material.transparent !== see) mesh.material.needsUpdate = true;
      Object.assign(mesh.material, { opacity, transparent: see, depthWrite: !see });
    }
    stage.setNames(shown["joint names"]);
    state.dirty = true;
  }

  function draw() {
    for (const figure of figures) figure.show(figure.instant(state.t), scales());
    rows.show(state.selected.shown);
    link.show();
    curves.at(state.t);
    $("time").value = state.t;
    $("now").textContent = `${state.t.toFixed(2)} s`;
    $("state").textContent = state.selected.hand ? `Pose set by hand: ${staticLoads(state.selected.robot)}.` : "";
    drawStage();
    state.dirty = false;
  }

  function drawStage() {
    stage.draw();
    const loads = figures.some((figure) => figure.duration > 0 || !figure.robot.lacking.every(Boolean));
    stage.legend(scales(), { force: loads && shown["reaction forces"], moment: loads && shown["reaction moments"], torques: loads && shown["actuator torques"] });
  }

  function select(figure, quantity = $("quantity").value) {
    state.selected = figure;
    $("rows").replaceChildren();
    rows = new JointRows($("rows"), figure, scene.live, move);
    $("why").textContent = rows.why;
    link.offer(figure);
    showMarks($("marks"), figure, duration, seek);
    $("notes").replaceChildren(...figure.notes.map((note) => html("li", {}, note)));
    $("noted").hidden = figure.notes.length === 0;
    $("noted").open = figure.notes.length <= NOTES;
    $("noted").querySelector("summary").textContent = figure.notes.length === 1 ? "one note" : `${figure.notes.length} notes`;
    $("curves").hidden = figure.duration === 0;
    if (figure.duration === 0) return;
    const titles = quantities(figure).map(([title]) => title);
    $("quantity").replaceChildren(...titles.map((title) => html("option", {}, title)));
    $("quantity").value = titles.includes(quantity) ? quantity : titles[0];
    curves.show(figure, $("quantity").selectedIndex);
  }

  function released() {
    for (const figure of figures) if (figure.motion) figure.hand = null;
  }

  function setPlaying(playing) {
    state.playing = playing && duration > 0;
    $("play").textContent = state.playing ? "❚❚" : "▶";
    $("play").ariaLabel = state.playing ? "pause" : "play";
  }

  function pause() { setPlaying(false); }

  function toggle() {
    if (!state.playing) released();
    setPlaying(!state.playing);
  }

  function seek(t) {
    released();
    pause();
    state.t = Math.min(duration, Math.max(0, t));
    draw();
  }

  function frame(now) {
    if (state.playing && state.last !== undefined) {
      state.t = (state.t + ((now - state.last) / 1000) * state.speed) % duration;
      state.dirty = true;
    }
    state.last = now;
    if (state.dirty) draw();
    else if (stage.changed) drawStage();
    requestAnimationFrame(frame);
  }

  function measure() {
    duration = longest();
    $("bar").classList.toggle("still", duration === 0);
    $("time").max = duration;
  }

  // Served live: the motion that graphdyn answers, which the selected figure follows from then on.
  async function ask(name, question) {
    const figure = state.selected;
    const answer = await fetch(name, { method: "POST", body: JSON.stringify({ figure: figures.indexOf(figure), ...question }) });
    if (!answer.ok) throw new Error(await answer.text());
    const { motion, numbers, notes } = await answer.json();
    figure.follow(motion, await numberStore(numbers));
    figure.notes = notes;
  }

  // What the selected robot does without torques, from where it is and at rest.
  async function letGo() {
    const figure = state.selected;
    pause();
    $("let-go").disabled = true;
    $("state").textContent = "The motion is computed …";
    try {
      await ask("let-go", { q: figure.shown.q, seconds: FALL });
      measure();
      select(figure, "reaction force");
      stage.whole();
      seek(0);
      toggle();
    } catch (error) {
      $("state").textContent = `No motion: ${error.message}`;
    }
    $("let-go").disabled = false;
  }

  // A joint moved by hand. Loops are closed by graphdyn, one question at a time, the latest move last.
  let asking = false, waiting = null;
  async function move(q, hold) {
    pause();
    if (!state.selected.robot.chords.length) {
      state.selected.hand = q;
      draw();
      return;
    }
    waiting = { q, hold };
    if (asking) return;
    asking = true;
    while (waiting) {
      const question = waiting;
      waiting = null;
      try {
        await ask("pose", question);
        draw();
      } catch (error) {
        $("state").textContent = `No such pose: ${error.message}`;
      }
    }
    asking = false;
  }

  $("play").addEventListener("click", toggle);
  $("fit").addEventListener("click", () => stage.whole());
  const save = () => savePicture(stage, scene.title);
  $("save").addEventListener("click", save);
  $("save").hidden = !stage.renderer;
  $("speed").append(...SPEEDS.map((speed) => html("option", { value: speed, selected: speed === 1 }, `${speed}×`)));
  $("speed").addEventListener("change", () => { state.speed = Number($("speed").value); });
  $("quantity").addEventListener("change", () => { curves.show(state.selected, $("quantity").selectedIndex); draw(); });
  $("choice").hidden = figures.length === 1;
  $("figure").append(...figures.map((figure) => html("option", {}, figure.name)));
  $("figure").addEventListener("change", () => { select(figures[$("figure").selectedIndex]); draw(); });
  if (figures.length > 1) {
    const together = html("input", { type: "checkbox" });
    together.addEventListener("change", () => { stage.setApart(!together.checked); stage.whole(); applySwitches(); });
    $("choice").after(html("label", {}, together, "in one place"));
  }

  const actions = {
    " ": ["play, pause", toggle], ArrowLeft: [`back ${STEP} s`, () => seek(state.t - STEP)], ArrowRight: [`on ${STEP} s`, () => seek(state.t + STEP)],
    Home: ["to the start", () => seek(0)], 0: ["whole view", () => stage.whole()],
    p: ["save the picture", save],
    ...Object.fromEntries(switches.map(([key, name]) => [key, [name, keys[key]]])),
  };
  const named = { " ": "space", ArrowLeft: "←", ArrowRight: "→" };
  $("keys").append(...Object.entries(actions).flatMap(([key, [meaning]]) => [html("dt", {}, named[key] ?? key), html("dd", {}, meaning)]));
  addEventListener("keydown", (event) => {
    const typing = ["INPUT", "SELECT", "BUTTON", "SUMMARY"].includes(event.target.tagName) && event.target.type !== "checkbox";
    if (typing || event.ctrlKey || event.metaKey || event.altKey || !actions[event.key]) return;
    event.preventDefault();
    actions[event.key][1]();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { stage.colors(); curves.again(); state.dirty = true; });
  new ResizeObserver(() => { stage.resize(); curves.resize(); state.dirty = true; }).observe($("stage"));

  $("let-go").hidden = !scene.live;
  $("let-go").addEventListener("click", letGo);

  measure();
  select(figures[0]);
  applySwitches();
  stage.resize();
  pause();
  draw();
  const start = new URLSearchParams(location.hash.slice(1)).get("t");  // page.html#t=1.5 begins there, and stands
  if (start !== null && duration > 0) seek(Number(start) || 0);
  else if (!matchMedia("(prefers-reduced-motion: reduce)").matches) setPlaying(true);
  requestAnimationFrame(frame);
  globalThis.player = { figures, stage, state, scales, seek, draw, toggle, letGo, move };  // for scripts of one's own
  document.body.dataset.ready = "yes";
}

// Meters per newton and newton meter, so that a usual load is a part of the size; the torque of a full arc. What is less
// than LEAST of the robot's weight, with its reach as lever, or a torque that is less than LEAST of the moments, is noise.
function firstScales(figures, size) {
  const loads = figures.map((figure) => figure.loads());
  const usual = (kind, least) => {
    const ofFigures = loads.map((load) => load[kind].sort((a, b) => a - b));
    return Math.max(least, ...ofFigures.map((sorted) => sorted[Math.floor(USUAL * (sorted.length - 1))] ?? 0));
  };
  const least = (kind) => LEAST * Math.max(...figures.map(({ robot }) => robot.usual[kind]));
  const force = usual("force", least("force")), moment = usual("moment", least("torque"));
  const torque = usual("torque", Math.max(least("torque"), LEAST * moment));
  return { force: (ARROW * size) / (force || 1), moment: (ARROW * size) / (moment || 1), torque: roundedUp(torque || 1) };
}

main().catch((error) => { trouble(`This page cannot be shown: ${error.message}`); console.error(error); });
