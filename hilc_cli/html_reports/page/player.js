
"use strict";

// Plays the recorded iterations of a run: the path, the error and the wheel speeds in step.

const SVG = "http://www.w3.org/2000/svg";
const KEYS = "Keys: space plays and pauses; left and right go through the pass (with Shift by one "
  + "sample); up and down change the iteration; Home and End go to its start and end.";
const SPEEDS = [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50];
const PASS_SECONDS = 4; // about so long a pass is played, unless somebody chooses
const HOLD_SECONDS = 0.5; // between two passes
const SMALLEST_ROBOT = 7; // pixels from its middle to a wheel
const FAR_APART = 50; // the largest error and that of most samples of the best iteration, from
// which on a scale is logarithmic
const SHOWN = [30, 1e5]; // so many times smaller errors than these two are shown

function element(parent, name, attributes = {}, text = "") {
  const made = name.startsWith("svg:")
    ? document.createElementNS(SVG, name.slice(4))
    : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== "") made.textContent = text;
  parent.append(made);
  return made;
}

function between(line, values, sample) {
  // The value of a thinned line at a sample, by the kept ones around it.
  const at = line.at;
  let low = 0;
  let high = at.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (at[middle] <= sample) low = middle; else high = middle;
  }
  if (at[high] === at[low]) return values[low];
  const share = Math.min(1, Math.max(0, (sample - at[low]) / (at[high] - at[low])));
  return values[low] + share * (values[high] - values[low]);
}

function shortNumber(value, digits = 3) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < 1e-3 || size >= 1e5) return value.toExponential(digits - 1).replace("e+", "e");
  return String(Number(value.toPrecision(digits)));
}

function inLength(meters) {
  if (meters < 1e-6) return `${shortNumber(meters)} m`;
  if (meters < 1e-3) return `${shortNumber(meters * 1e6)} µm`;
  if (meters < 0.1) return `${shortNumber(meters * 1e3)} mm`;
  return `${shortNumber(meters)} m`;
}

function roundTicks(low, high, most) {
  const rough = (high - low) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((each) => each * power >= rough * (1 - 1e-9));
  const ticks = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n += 1) {
    ticks.push(Number((n * step).toPrecision(12)));
  }
  return ticks;
}

class Panel {
  // Axes in pixels: a frame with ticks and labels, into which lines are drawn.
  constructor(parent, label, xLabel, yLabel) {
    this.svg = element(parent, "svg:svg", { role: "img", "aria-label": label });
    this.labels = [xLabel, yLabel];
  }

  clear(width, height, shown, scale = {}) {
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.svg.replaceChildren();
    const [left, top, right, bottom] = [58, 8, width - 10, height - 40];
    let [xLow, xHigh, yLow, yHigh] = shown;
    if (scale.equal) { // as much more of the plane as fills the frame
      const pixel = Math.max((xHigh - xLow) / (right - left), (yHigh - yLow) / (bottom - top));
      const [x, y] = [(xLow + xHigh) / 2, (yLow + yHigh) / 2];
      [xLow, xHigh] = [x - pixel * (right - left) / 2, x + pixel * (right - left) / 2];
      [yLow, yHigh] = [y - pixel * (bottom - top) / 2, y + pixel * (bottom - top) / 2];
    }
    const log = scale.log ? Math.log10 : (value) => value;
    [yLow, yHigh] = [log(yLow), log(yHigh)];
    this.x = (value) => left + (right - left) * (value - xLow) / (xHigh - xLow);
    this.y = (value) => {
      const y = bottom - (bottom - top) * (log(value) - yLow) / (yHigh - yLow);
      return scale.log ? Math.min(bottom + 1, Math.max(top - 1, y)) : y;
    };
    this.unX = (pixels) => xLow + (xHigh - xLow) * (pixels - left) / (right - left);
    this.perUnit = (right - left) / (xHigh - xLow);
    this.box = { left, top, right, bottom };
    for (const value of roundTicks(xLow, xHigh, (right - left) / 70)) {
      this.tick(this.x(value), bottom, "x", shortNumber(value, 6));
    }
    for (const value of roundTicks(yLow, yHigh, (bottom - top) / 40)) {
      if (scale.log && !Number.isInteger(value)) continue;
      const y = bottom - (bottom - top) * (value - yLow) / (yHigh - yLow);
      this.tick(left, y, "y", scale.log ? shortNumber(10 ** value, 1) : shortNumber(value, 6));
    }
    const clip = `clip-${Panel.count += 1}`;
    const area = { x: left, y: top, width: right - left, height: bottom - top };
    element(element(this.svg, "svg:clipPath", { id: clip }), "svg:rect", area);
    element(this.svg, "svg:rect", { ...area, class: "frame" });
    const [middleX, middleY] = [(left + right) / 2, (top + bottom) / 2];
    element(this.svg, "svg:text", { x: middleX, y: height - 5, class: "label" }, this.labels[0]);
    element(this.svg, "svg:text", {
      class: "label", transform: `translate(13 ${middleY}) rotate(-90)`,
    }, this.labels[1]);
    this.inside = element(this.svg, "svg:g", { "clip-path": `url(#${clip})` });
  }

  tick(x, y, axis, text) {
    const { left, top, right, bottom } = this.box;
    const line = axis === "x" ? { x1: x, x2: x, y1: top, y2: bottom }
      : { x1: left, x2: right, y1: y, y2: y };
    element(this.svg, "svg:line", { ...line, class: "grid" });
    const place = axis === "x" ? { x, y: bottom + 15, class: "tick x" }
      : { x: left - 6, y: y + 4, class: "tick y" };
    element(this.svg, "svg:text", place, text.replace("-", "−"));
  }

  line(points, kind) {
    const path = points.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L");
    return element(this.inside, "svg:path", { d: points.length ? `M${path}` : "", class: kind });
  }
}
Panel.count = 0;

class Player {
  constructor(root) {
    this.root = root;
    this.data = JSON.parse(root.querySelector(".data").textContent);
    this.place = this.data.iterations.length - 1;
    this.sample = this.data.samples;
    this.playing = false;
    this.most = Math.max(...this.data.iterations.map((each) => Math.max(...each.error.value)));
    this.usual = Math.min(...this.data.iterations.map((each) => this.medianError(each)));
    this.isLog = this.most > FAR_APART * this.usual;
    root.tabIndex = 0;
    this.makeControls();
    this.makePanels();
    root.addEventListener("keydown", (event) => this.onKey(event));
    new ResizeObserver(() => this.layOut()).observe(root);
    this.layOut();
  }

  get pass() { return this.data.iterations[this.place]; }

  get duration() { return this.data.samples * this.data.sampleTime; }

  medianError(pass) {
    const values = [];
    for (let part = 0; part <= 200; part += 1) {
      values.push(between(pass.error, pass.error.value, part / 200 * this.data.samples));
    }
    return values.sort((a, b) => a - b)[100];
  }

  makeControls() {
    const controls = element(this.root, "div", { class: "controls" });
    this.button = element(controls, "button", { type: "button", class: "play" }, "Play");
    this.button.addEventListener("click", () => this.toggle());
    const slider = (name, most, onInput) => {
      const label = element(controls, "label", { class: name });
      const line = element(label, "span", {}, name === "time" ? "Time " : "Iteration ");
      const told = element(line, "b");
      const input = element(label, "input", { type: "range", min: 0, max: most, step: 1 });
      input.addEventListener("input", () => onInput(Number(input.value)));
      return [input, told];
    };
    [this.passSlider, this.passTold] = slider("iteration", this.data.iterations.length - 1,
      (place) => this.goTo(place, this.sample));
    [this.timeSlider, this.timeTold] = slider("time", this.data.samples,
      (sample) => { this.pause(); this.goTo(this.place, sample); });
    const speed = element(controls, "label", { class: "speed" }, "Speed ");
    this.speed = element(speed, "select");
    const wanted = this.duration / PASS_SECONDS;
    const usual = SPEEDS.reduce((best, each) => (
      Math.abs(Math.log(each / wanted)) < Math.abs(Math.log(best / wanted)) ? each : best));
    for (const each of SPEEDS) {
      const option = element(this.speed, "option", { value: each }, `${each} ×`);
      option.selected = each === usual;
    }
    const scale = element(controls, "label", { class: "scale" });
    const box = element(scale, "input", { type: "checkbox" });
    box.checked = this.isLog;
    box.addEventListener("change", () => { this.isLog = box.checked; this.redraw(); });
    scale.append(" Logarithmic error");
  }

  makePanels() {
    this.panels = element(this.root, "div", { class: "panels" });
    const add = (name, label, x, y, legend) => {
      const figure = element(this.panels, "figure", { class: name });
      const panel = new Panel(figure, label, x, y);
      const caption = element(figure, "figcaption");
      for (const [kind, text] of legend) {
        const entry = element(caption, "span", { class: "entry" });
        if (kind) {
          const sample = element(entry, "svg:svg", { viewBox: "0 0 28 8", "aria-hidden": "true" });
          element(sample, "svg:path", { d: "M1 4L27 4", class: kind });
        }
        element(entry, "span", {}, text);
      }
      return panel;
    };
    const robot = element(document.createElement("p"), "span");
    this.path = add("path", "The robot on its way, and the reference", "x [m]", "y [m]", [
      ["reference", "Reference"], ["driven", "This pass"], ["past", "Passes before"],
      ["", "Robot"]]);
    this.robotTold = this.panels.querySelector(".path .entry:last-child span") || robot;
    this.error = add("error", "Position error of this pass over time", "Time [s]",
      "Position error [m]", [["driven", "This pass"], ["past", "Passes before"]]);
    const limit = this.data.limit === null ? [] : [["limit", "Speed limit"]];
    this.wheels = add("wheels", "Wheel speeds of this pass over time", "Time [s]",
      "Wheel speed [rad/s]", [["left", "Left wheel"], ["right", "Right wheel"], ...limit]);
    for (const panel of [this.error, this.wheels]) this.seekOn(panel);
    this.told = element(this.root, "p", { class: "told", "aria-live": "polite" });
    element(this.root, "p", { class: "keys" }, KEYS);
  }

  seekOn(panel) {
    const seek = (event) => {
      const box = panel.svg.getBoundingClientRect();
      const view = panel.svg.viewBox.baseVal;
      const time = panel.unX((event.clientX - box.left) * view.width / box.width);
      this.pause();
      this.goTo(this.place, Math.round(time / this.data.sampleTime));
    };
    panel.svg.addEventListener("pointerdown", (event) => {
      panel.svg.setPointerCapture(event.pointerId);
      seek(event);
    });
    panel.svg.addEventListener("pointermove", (event) => { if (event.buttons) seek(event); });
  }

  layOut() {
    const width = Math.floor(this.panels.getBoundingClientRect().width);
    if (width === 0 || width === this.width) return;
    this.width = width;
    this.redraw();
  }

  redraw() {
    const beside = this.width >= 720;
    const pathWidth = beside ? Math.floor(this.width * 0.52) : this.width;
    const sideWidth = beside ? this.width - pathWidth - 16 : this.width;
    const [xLow, xHigh, yLow, yHigh] = this.data.view;
    const shape = Math.min(1.05, Math.max(0.55, (yHigh - yLow) / (xHigh - xLow)));
    const pathHeight = Math.round(beside ? Math.min(560, Math.max(440, pathWidth * shape))
      : pathWidth * shape + 20);
    const sideHeight = beside ? Math.round(pathHeight / 2 - 12) : 220;
    this.drawPath(pathWidth, pathHeight);
    this.drawError(sideWidth, sideHeight);
    this.drawWheels(sideWidth, sideHeight);
    this.move();
  }

  points(panel, pose) {
    const { step } = this.data;
    return pose.x.map((x, place) => [panel.x(x * step), panel.y(pose.y[place] * step)]);
  }

  drawPath(width, height) {
    const panel = this.path;
    panel.clear(width, height, this.data.view, { equal: true });
    for (const each of this.data.iterations.slice(0, this.place)) {
      panel.line(this.points(panel, each.pose), "past");
    }
    panel.line(this.points(panel, this.pass.pose), "ahead");
    this.drivenPath = panel.line([], "driven");
    panel.line(this.points(panel, this.data.reference), "reference");
    this.link = element(panel.inside, "svg:line", { class: "link" });
    this.target = element(panel.inside, "svg:circle", { class: "target", r: 4 });
    this.robot = element(panel.inside, "svg:g", { class: "robot" });
    const known = this.data.robot;
    const half = known === null ? 0.03 * (this.data.view[1] - this.data.view[0]) : known.halfTrack;
    const size = Math.max(SMALLEST_ROBOT, half * panel.perUnit);
    const wheel = known === null ? 0.4 * size : size * known.wheelRadius / half;
    const rect = (x, y, w, h, kind, r = 0) => element(this.robot, "svg:rect",
      { x: x - w / 2, y: y - h / 2, width: w, height: h, rx: r, class: kind });
    rect(0.1 * size, 0, 2 * size, 1.7 * size, "body", 0.3 * size);
    for (const side of [-1, 1]) rect(0, side * size, 2 * wheel, 0.3 * size, "wheel", 0.08 * size);
    element(this.robot, "svg:path", {
      d: `M${0.95 * size} 0L${0.35 * size} ${-0.45 * size}L${0.35 * size} ${0.45 * size}Z`,
      class: "nose",
    });
    const larger = size > half * panel.perUnit * 1.001;
    this.robotTold.textContent = known === null ? "Robot, of unknown size"
      : larger ? "Robot, drawn larger than it is" : "Robot: wheels to scale, length assumed";
  }

  drawError(width, height) {
    const panel = this.error;
    const isLog = this.isLog && this.most > 0;
    const [low, high] = isLog
      ? [Math.max(this.usual / SHOWN[0], this.most / SHOWN[1]), this.most * 1.5]
      : [0, (this.most || 1) * 1.06];
    panel.clear(width, height, [0, this.duration, low, high], { log: isLog });
    const points = (line) => line.at.map((at, place) => [panel.x(at * this.data.sampleTime),
      panel.y(isLog ? Math.max(line.value[place], low / 10) : line.value[place])]);
    for (const each of this.data.iterations.slice(0, this.place)) {
      panel.line(points(each.error), "past");
    }
    panel.line(points(this.pass.error), "driven");
    this.errorCursor = this.cursorOn(panel);
    this.errorLow = isLog ? low / 10 : 0;
  }

  drawWheels(width, height) {
    const panel = this.wheels;
    const { speedZero, speedStep, limit, sampleTime } = this.data;
    let [low, high] = [speedZero, speedZero + 20000 * speedStep];
    if (limit !== null && limit <= 1.6 * Math.max(Math.abs(low), Math.abs(high))) {
      high = Math.max(high, limit);
      if (low < -0.5 * limit) low = Math.min(low, -limit);
    }
    const room = 0.06 * (high - low);
    panel.clear(width, height, [0, this.duration, low - room, high + room]);
    for (const each of limit === null ? [] : [limit, -limit]) {
      panel.line([[panel.box.left, panel.y(each)], [panel.box.right, panel.y(each)]], "limit");
    }
    for (const side of ["left", "right"]) {
      const line = this.pass.speed;
      panel.line(line.at.map((at, place) => [panel.x(at * sampleTime),
        panel.y(speedZero + line[side][place] * speedStep)]), side);
    }
    this.wheelCursor = this.cursorOn(panel);
  }

  cursorOn(panel) {
    return {
      line: panel.line([], "cursor"),
      dot: element(panel.inside, "svg:circle", { class: "dot", r: 0 }),
    };
  }

  move() {
    // Puts everything that depends on the time in its place.
    const { pass, sample } = this;
    const { step, stepTurn, sampleTime, speedZero, speedStep } = this.data;
    const here = (pose, what) => between(pose, pose[what], sample);
    const [x, y] = [here(pass.pose, "x") * step, here(pass.pose, "y") * step];
    const px = this.path.x(x);
    const py = this.path.y(y);
    const count = pass.pose.at.filter((at) => at <= sample).length;
    const driven = this.points(this.path, {
      x: pass.pose.x.slice(0, count), y: pass.pose.y.slice(0, count) });
    this.drivenPath.setAttribute("d", `M${[...driven, [px, py]].map(
      ([a, b]) => `${a.toFixed(1)} ${b.toFixed(1)}`).join("L")}`);
    const turn = -here(pass.pose, "heading") * stepTurn * 180 / Math.PI;
    this.robot.setAttribute("transform",
      `translate(${px.toFixed(1)} ${py.toFixed(1)}) rotate(${turn.toFixed(2)})`);
    const rx = this.path.x(here(this.data.reference, "x") * step);
    const ry = this.path.y(here(this.data.reference, "y") * step);
    const set = (what, values) => {
      for (const [key, value] of Object.entries(values)) what.setAttribute(key, value.toFixed(1));
    };
    set(this.target, { cx: rx, cy: ry });
    set(this.link, { x1: px, y1: py, x2: rx, y2: ry });
    const time = sample * sampleTime;
    for (const [panel, cursor] of [[this.error, this.errorCursor],
      [this.wheels, this.wheelCursor]]) {
      const at = panel.x(time).toFixed(1);
      cursor.line.setAttribute("d", `M${at} ${panel.box.top}L${at} ${panel.box.bottom}`);
    }
    const error = between(pass.error, pass.error.value, sample);
    set(this.errorCursor.dot, { cx: this.error.x(time), r: 4,
      cy: this.error.y(Math.max(error, this.errorLow)) });
    const speeds = ["left", "right"].map((side) => (
      speedZero + between(pass.speed, pass.speed[side], sample) * speedStep));
    this.tell(time, error, speeds);
  }

  tell(time, error, speeds) {
    const digits = Math.max(0, Math.min(6, Math.ceil(-Math.log10(this.duration / 300))));
    const clock = `${time.toFixed(digits)} s`;
    const last = this.data.last === this.pass.number ? "" : ` of ${this.data.last}`;
    this.passSlider.value = this.place;
    this.timeSlider.value = Math.round(this.sample);
    this.passTold.textContent = `${this.pass.number}${last}`;
    this.timeTold.textContent = `${clock} of ${shortNumber(this.duration, 6)} s`;
    this.passSlider.setAttribute("aria-valuetext", `iteration ${this.pass.number}`);
    this.timeSlider.setAttribute("aria-valuetext", `${clock}, error ${inLength(error)}`);
    const [left, right] = speeds.map((each) => shortNumber(each, 4).replace("-", "−"));
    const text = `Iteration ${this.pass.number}, ${clock}: position error ${inLength(error)}, `
      + `left wheel ${left} rad/s, right wheel ${right} rad/s.`;
    this.told.setAttribute("aria-live", this.playing ? "off" : "polite");
    this.told.textContent = text;
  }

  goTo(place, sample) {
    const before = this.place;
    this.place = Math.min(this.data.iterations.length - 1, Math.max(0, place));
    this.sample = Math.min(this.data.samples, Math.max(0, sample));
    if (this.place !== before) this.redraw(); else this.move();
  }

  get isAtEnd() {
    return this.place === this.data.iterations.length - 1 && this.sample >= this.data.samples;
  }

  toggle() { if (this.playing) this.pause(); else this.play(); }

  play() {
    if (this.isAtEnd) this.goTo(0, 0);
    this.playing = true;
    this.button.textContent = "Pause";
    this.hold = 0;
    let before = null;
    const frame = (now) => {
      if (!this.playing) return;
      const passed = before === null ? 0 : Math.min(0.1, (now - before) / 1000);
      before = now;
      this.advance(passed);
      if (this.playing) requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  advance(seconds) {
    if (this.sample < this.data.samples) {
      const samples = seconds * Number(this.speed.value) / this.data.sampleTime;
      this.goTo(this.place, this.sample + samples);
      this.hold = 0;
    } else if (this.isAtEnd) {
      this.pause();
    } else if ((this.hold += seconds) >= HOLD_SECONDS) {
      this.goTo(this.place + 1, 0);
    }
  }

  pause() {
    this.playing = false;
    this.button.textContent = "Play";
    this.move();
  }

  onKey(event) {
    if (event.altKey || event.ctrlKey || event.metaKey || event.target === this.speed) return;
    const onPasses = event.target === this.passSlider;
    const few = event.shiftKey ? 1 : Math.max(1, Math.round(this.data.samples / 100));
    const through = (sample) => () => { this.pause(); this.goTo(this.place, sample); };
    const actions = {
      ArrowUp: () => this.goTo(this.place + 1, this.sample),
      ArrowDown: () => this.goTo(this.place - 1, this.sample),
    };
    if (event.target !== this.button && event.target.type !== "checkbox") {
      actions[" "] = () => this.toggle();
    }
    if (!onPasses) {
      actions.ArrowLeft = through(Math.round(this.sample) - few);
      actions.ArrowRight = through(Math.round(this.sample) + few);
      actions.Home = through(0);
      actions.End = through(this.data.samples);
    }
    if (!(event.key in actions)) return;
    event.preventDefault();
    actions[event.key]();
  }
}

function letChooseTheme(button) {
  const themes = { "": "as the system", light: "light", dark: "dark" };
  button.hidden = false;
  button.addEventListener("click", () => {
    const names = Object.keys(themes);
    const now = document.documentElement.dataset.theme || "";
    const next = names[(names.indexOf(now) + 1) % names.length];
    if (next) document.documentElement.dataset.theme = next;
    else delete document.documentElement.dataset.theme;
    button.textContent = `Theme: ${themes[next]}`;
  });
}

function unfoldOnPaper() {
  const folded = () => document.querySelectorAll("details:not([open])");
  let opened = [];
  addEventListener("beforeprint", () => {
    opened = [...folded()];
    for (const each of opened) each.open = true;
  });
  addEventListener("afterprint", () => { for (const each of opened) each.open = false; });
}

letChooseTheme(document.getElementById("theme"));
unfoldOnPaper();
for (const root of document.querySelectorAll(".player")) new Player(root);
