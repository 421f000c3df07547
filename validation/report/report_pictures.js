// Items and fields as pictures: the codes side by side at one moment, with a slider through the run, and coarse-grained fields.
// pictures.h says how the data is packed.
"use strict";

// Viridis, in bands: rising lightness, so that it reads without colour as well.
const BANDS = ["#440154", "#46327e", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#a0da39", "#fde725"];
const shadeOf = (share) => BANDS[Math.min(BANDS.length - 1, Math.max(0, Math.floor(BANDS.length * share) || 0))];

const bytes = (text) => Uint8Array.from(atob(text ?? ""), (c) => c.charCodeAt(0));

/** Numbers of one or two bytes each, spread evenly over [low, high]. */
function unpacked(text, size, [low, high]) {
  const raw = bytes(text);
  const whole = size === 2 ? 65535 : 255;
  return Float32Array.from({length: raw.length / size},
      (_, k) => low + (high - low) * (size === 2 ? raw[2 * k] + 256 * raw[2 * k + 1] : raw[k]) / whole);
}

/** One moment in metres and metres a second; unpacked when it is first shown. */
function momentOf(picture, k) {
  picture.unpacked ??= [];
  const {x, z, radius, start_x: start, speed} = picture.ranges;
  const packed = picture.moments[k];
  picture.unpacked[k] ??= {time: packed.time, count: packed.count, x: unpacked(packed.x, 2, x), z: unpacked(packed.z, 2, z),
    radius: unpacked(packed.radius, 1, radius), start: unpacked(packed.start_x, 1, start), speed: unpacked(packed.speed, 1, speed),
    sphere: picture.sphere?.[k]};
  return picture.unpacked[k];
}

const nearest = (moments, time) => moments.reduce((best, moment, k) =>
    Math.abs(moment.time - time) < Math.abs(moments[best].time - time) ? k : best, 0);

/** The lowest seed of each code, in the order of the codes. */
function shownPictures(pictures, point) {
  const mine = inCodeOrder(list(pictures).filter((picture) => picture.name === nameOf(point) && list(picture.moments).length));
  return mine.filter((picture, k) => mine.findIndex((other) => other.code === picture.code) === k);
}

/** The region that all pictures share, in metres. */
function extentOf(shown) {
  const all = (key, end) => shown.map((picture) => picture.ranges[key][end]);
  const margin = Math.max(...all("radius", 1));
  const low = (key) => { const edge = Math.min(...all(key, 0)); return edge >= 0 && edge < 3 * margin ? 0 : edge - margin; };
  const high = (key) => Math.max(...all(key, 1)) + margin;
  const spheres = shown.flatMap((picture) => list(picture.sphere)).map(({z, radius}) => z + radius);
  return {x: [low("x"), high("x")], z: [low("z"), Math.max(high("z"), ...spheres)]};
}

function niceStep(length, most) {
  const rough = length / most;
  const power = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].map((m) => m * power).find((step) => step >= rough);
}

/** Sizes a canvas for `extent`, draws the axes over `unit`, and returns the pen and the two scales. */
function stage(canvas, extent, unit) {
  const margin = {left: 40, right: 8, top: 6, bottom: 34};
  const available = canvas.parentElement.clientWidth;
  const deep = extent.z[1] - extent.z[0], wide = extent.x[1] - extent.x[0];
  const scale = Math.min((available - margin.left - margin.right) / wide, 420 / deep);
  const width = Math.ceil(wide * scale) + margin.left + margin.right, height = Math.ceil(deep * scale) + margin.top + margin.bottom;
  const ratio = pixelRatio();
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height}px`;
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  const across = (x) => margin.left + (x - extent.x[0]) * scale;
  const up = (z) => height - margin.bottom - (z - extent.z[0]) * scale;
  const axes = () => {
    pen.lineWidth = 1;
    pen.strokeStyle = pen.fillStyle = colour("muted");
    pen.font = font(11);
    pen.beginPath();
    pen.moveTo(margin.left, up(extent.z[1]));
    pen.lineTo(margin.left, up(extent.z[0]));
    pen.lineTo(across(extent.x[1]), up(extent.z[0]));
    const ticks = (range, count, draw) => {
      const step = niceStep((range[1] - range[0]) / unit.metres, count);
      const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
      for (let k = Math.ceil(range[0] / unit.metres / step - 1e-9); k * step * unit.metres <= range[1]; ++k) {
        draw(k * step * unit.metres, (k * step).toFixed(digits).replace("-", "−"));
      }
    };
    pen.textAlign = "center";
    pen.textBaseline = "top";
    ticks(extent.x, Math.max(2, wide * scale / 55), (x, text) => {
      pen.moveTo(across(x), up(extent.z[0]));
      pen.lineTo(across(x), up(extent.z[0]) + 4);
      pen.fillText(text, across(x), up(extent.z[0]) + 6);
    });
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    ticks(extent.z, Math.max(2, deep * scale / 35), (z, text) => {
      pen.moveTo(margin.left - 4, up(z));
      pen.lineTo(margin.left, up(z));
      pen.fillText(text, margin.left - 6, up(z));
    });
    pen.stroke();
    pen.fillStyle = colour("text");
    pen.textBaseline = "bottom";
    pen.fillText(`x ${unit.text}`, across(extent.x[1]), height);
    pen.save();
    pen.translate(10, up((extent.z[0] + extent.z[1]) / 2));
    pen.rotate(-Math.PI / 2);
    pen.textAlign = "center";
    pen.fillText(`z ${unit.text}`, 0, 0);
    pen.restore();
  };
  return {pen, across, up, scale, axes};
}

/** Draws by way of a bitmap: Chromium prints what it is told to draw, and a few thousand discs are half a megabyte of PDF. */
function throughBitmap(canvas, pen, draw) {
  const bitmap = make("canvas", {width: canvas.width, height: canvas.height});
  const brush = bitmap.getContext("2d");
  brush.setTransform(pen.getTransform());
  draw(brush);
  pen.save();
  pen.resetTransform();
  pen.drawImage(bitmap, 0, 0);
  pen.restore();
}

function drawItems(canvas, moment, extent, unit, share) {
  const {pen, across, up, scale, axes} = stage(canvas, extent, unit);
  throughBitmap(canvas, pen, (brush) => {
    brush.lineWidth = 0.4;
    brush.strokeStyle = colour("page");
    moment.x.forEach((x, k) => {
      brush.fillStyle = shadeOf(share(moment, k));
      brush.beginPath();
      brush.arc(across(x), up(moment.z[k]), Math.max(0.6, moment.radius[k] * scale), 0, 2 * Math.PI);
      brush.fill();
      brush.stroke();
    });
    if (!moment.sphere) return;
    brush.fillStyle = colour("muted");
    brush.beginPath();
    brush.arc(across(moment.sphere.x), up(moment.sphere.z), moment.sphere.radius * scale, 0, 2 * Math.PI);
    brush.fill();
  });
  axes();
}

/** Colours with what they stand for at both ends. */
function colourKey(low, high) {
  const bands = make("span", {class: "bands", "aria-hidden": "true"}, BANDS.map((shade) => {
    const band = make("i");
    band.style.background = shade;
    return band;
  }));
  return make("span", {class: "scale"}, low, bands, high);
}

/** Radio buttons in a row; `choose` hears the chosen key. */
function choice(title, options, choose) {
  const name = `choice-${document.querySelectorAll("fieldset").length}`;
  return make("fieldset", {class: "choice"}, make("legend", {}, title), Object.entries(options).map(([key, label], k) => {
    const input = make("input", {type: "radio", name, value: key, checked: k === 0 ? "" : null});
    input.addEventListener("change", () => choose(key));
    return make("label", {}, input, label);
  }));
}

/** Slider, play button and the time shown; calls `show(k)` for moment k of `times`. Starts at the last moment. */
function timeControls(times, show) {
  const last = times.length - 1;
  const slider = make("input", {type: "range", min: 0, max: last, step: 1, value: last, "aria-label": "moment of the run"});
  const shown = make("output", {});
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const button = make("button", {type: "button"}, still ? "Next moment" : "▶ Play");
  let timer = null;
  const go = (k) => {
    slider.value = k;
    shown.textContent = `t = ${number(times[k])} s`;
    slider.setAttribute("aria-valuetext", shown.textContent);
    show(k);
  };
  const stop = () => { clearInterval(timer); timer = null; if (!still) button.textContent = "▶ Play"; };
  slider.addEventListener("input", () => { stop(); go(Number(slider.value)); });
  button.addEventListener("click", () => {
    if (still) { go((Number(slider.value) + 1) % times.length); return; }
    if (timer !== null) { stop(); return; }
    button.textContent = "❚❚ Pause";
    if (Number(slider.value) === last) go(0);
    timer = setInterval(() => { if (Number(slider.value) >= last) stop(); else go(Number(slider.value) + 1); }, 350);
  });
  return {element: make("div", {class: "controls"}, button, slider, shown), start: () => go(last)};
}

const pictureUnit = (point) => isNumber(point.length_unit?.metres) && point.length_unit.metres > 0 ?
    {metres: point.length_unit.metres, text: `/ ${unitText(point.length_unit.symbol)}`} : {metres: 0.001, text: "(mm)"};

function drawAnimation(parent, point, pictures) {
  const shown = shownPictures(pictures, point);
  if (!shown.length) {
    parent.append(absent("These results hold no pictures."));
    return;
  }
  const extent = extentOf(shown), unit = pictureUnit(point);
  const range = (key) => [Math.min(...shown.map((p) => p.ranges[key][0])), Math.max(...shown.map((p) => p.ranges[key][1]))];
  const start = range("start_x"), speed = range("speed");
  const shares = {start: (moment, k) => (moment.start[k] - start[0]) / (start[1] - start[0] || 1),
                  speed: (moment, k) => moment.speed[k] / (speed[1] || 1)};
  const end = (metres) => exactly(Number((metres / unit.metres).toFixed(2)));
  const keys = {start: () => colourKey(`x at release ${end(start[0])}`, `${end(start[1])} ${unit.text}`),
                speed: () => colourKey("speed 0", `${number(speed[1])} m/s`)};
  let colouring = "start", time = 0;
  const stages = shown.map((picture) => {
    const canvas = make("canvas", {role: "img"});
    const caption = make("span");
    const element = make("figure", {}, make("figcaption", {}, make("strong", {}, codeOf(picture.code).label), make("br"), caption), make("div", {}, canvas));
    const draw = () => {
      const moment = momentOf(picture, nearest(picture.moments, time));
      const {label, items} = codeOf(picture.code);
      const drawn = moment.x.length < moment.count ? `${number(moment.x.length)} of ${number(moment.count)}` : number(moment.count);
      caption.textContent = `seed ${words(picture.seed)}, t = ${number(moment.time)} s, ${drawn} ${items}`;
      canvas.setAttribute("aria-label", `Side view of the ${label} run at t = ${number(moment.time)} s: ${drawn} ${items}, reaching x = ` +
          `${number(moment.x.reduce((most, x) => Math.max(most, x), 0) / unit.metres)} ${unit.text}.`);
      drawItems(canvas, moment, extent, unit, shares[colouring]);
    };
    return {canvas, element, draw};
  });
  const draw = () => stages.forEach((one) => one.draw());
  const times = shown[0].moments.map((moment) => moment.time);
  const controls = timeControls(times, (k) => { time = times[k]; draw(); });
  const key = make("p", {class: "key"}, keys.start());
  parent.append(make("div", {class: "bar"}, controls.element, choice("Colour by", {start: "place at release", speed: "speed"},
      (chosen) => { colouring = chosen; key.replaceChildren(keys[chosen]()); draw(); })),
  key, make("div", {class: "trio"}, stages.map((one) => one.element)));
  controls.start();
  figures.push({draw, painted: () => stages.every((one) => isPainted(one.canvas))});
}

function drawField(canvas, values, field, largest, extent, unit) {
  const {pen, across, up, axes} = stage(canvas, extent, unit);
  const {origin, spacing, cells: [wide, high]} = field;
  for (let cell = 0; cell < wide * high; ++cell) {
    if (!values.filled[cell]) continue;
    const i = cell % wide, j = Math.floor(cell / wide);
    const x = across(origin[0] + i * spacing), z = up(origin[1] + (j + 1) * spacing);
    pen.fillStyle = shadeOf(values.of[cell] / (largest || 1));
    pen.fillRect(x, z, across(origin[0] + (i + 1) * spacing) - x + 0.4, up(origin[1] + j * spacing) - z + 0.4);
  }
  axes();
}

/** Coarse-grained speed and volume fraction of the codes, a row for each moment. */
function drawFields(parent, point, pictures) {
  const shown = shownPictures(pictures, point).filter((picture) => list(picture.fields?.moments).length);
  if (!shown.length) {
    parent.append(absent("These results hold no fields."));
    return;
  }
  const unit = pictureUnit(point);
  const fastest = Math.max(...shown.map((picture) => picture.fields.ranges.speed[1]));
  const scales = {speed: [fastest, () => colourKey("speed 0", `${number(fastest)} m/s`)],
                  volume_fraction: [0.7, () => colourKey("volume fraction 0", "0.7")]};
  const extent = {x: [0, 1].map((end) => (end ? Math.max : Math.min)(...shown.map(({fields: f}) => f.origin[0] + end * f.cells[0] * f.spacing))),
                  z: [0, 1].map((end) => (end ? Math.max : Math.min)(...shown.map(({fields: f}) => f.origin[1] + end * f.cells[1] * f.spacing)))};
  let quantity = "speed";
  const stages = shown[0].fields.moments.flatMap((_, k) => shown.filter((picture) => picture.fields.moments[k]).map((picture) => {
    const {fields} = picture, moment = fields.moments[k];
    const fill = unpacked(moment.volume_fraction, 1, fields.ranges.volume_fraction);
    const data = {speed: unpacked(moment.speed, 1, fields.ranges.speed), volume_fraction: fill};
    const {label} = codeOf(picture.code);
    const canvas = make("canvas", {role: "img", "aria-label": `Fields of the ${label} run at t = ${number(moment.time)} s: largest speed ` +
        `${number(data.speed.reduce((most, v) => Math.max(most, v), 0))} m/s.`});
    const element = make("figure", {}, make("figcaption", {}, make("strong", {}, label), `, t = ${number(moment.time)} s`), make("div", {}, canvas));
    const draw = () => drawField(canvas, {of: data[quantity], filled: fill.map((phi) => phi > 0.1)}, fields, scales[quantity][0], extent, unit);
    return {canvas, element, draw};
  }));
  const key = make("p", {class: "key"}, scales.speed[1]());
  const draw = () => stages.forEach((one) => one.draw());
  parent.append(make("div", {class: "bar"}, choice("Show", {speed: "speed", volume_fraction: "volume fraction"},
      (chosen) => { quantity = chosen; key.replaceChildren(scales[chosen][1]()); draw(); })), key,
  make("div", {class: `trio of-${shown.length}`}, stages.map((one) => one.element)));
  draw();
  figures.push({draw, painted: () => stages.every((one) => isPainted(one.canvas))});
}
