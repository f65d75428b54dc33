// The report without this script is whole. With it plots can be asked and changed.
const all = (selector, of = document) => [...of.querySelectorAll(selector)];
const make = (name, text = "", properties = {}) =>
  Object.assign(document.createElement(name), { textContent: text }, properties);
const sum = list => { let now = 0; return list.map(step => (now += step) / 100); };
const number = (value, places) => value.toFixed(places).replace(/^-(0\.?0*)$/, "$1").replace("-", "\u2212");
const signed = (value, places) => (value > 0 ? "+" : "") + number(value, places);

const data = JSON.parse(document.getElementById("curves").textContent);
for (const circle of data.circles)
  for (const curve of circle.t) {
    for (const key of "amp") curve[key] = sum(curve[key]);
    curve.e = curve.e.map(sum);
    curve.way = +!curve.f;
  }
const state = { times: 1, runs: new Set(), ways: new Set(), cured: new Set() };

// What is shown of a curve at one of its points, um: as if some causes were repaired.
const cured = (curve, k) => [...state.cured].reduce((all, cause) => all + (curve.e[cause] ? curve.e[cause][k] : 0), 0);
const visible = circle => circle.t.filter(curve => !state.runs.has(curve.n) && !state.ways.has(curve.way));
const place = (circle, angle) => {
  const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
  return circle.u.map((u, k) => (u * cosine + circle.v[k] * sine) / 1e6);
};

const polars = all("svg[data-circle]").map(svg => {
  const [x, y, radius, pixels] = svg.dataset.place.split(" ").map(Number);
  const curves = svg.querySelector(".curves");
  const rings = all("text.halo", svg).map(text => [text, text.textContent, Number(text.textContent.replace("\u2212", "-"))]);
  const circle = data.circles[svg.dataset.circle];
  const at = (degrees, um) => {
    const out = radius + Math.min(Math.max(um * pixels * state.times, -0.9 * radius), 0.62 * radius);
    const angle = degrees * Math.PI / 180;
    return [x + out * Math.cos(angle), y - out * Math.sin(angle)];
  };
  return { svg, circle, curves, printed: curves.innerHTML, rings, at };
});

const line = (polar, curve, values, name) => {
  const points = values.map((um, k) => polar.at(curve.a[k], um - cured(curve, k)).map(c => c.toFixed(1)).join());
  return `<polyline class="${name} ${curve.f ? "forward" : "backward"}" points="${points.join(" ")}"/>`;
};
const drawPolar = polar => {
  const asPrinted = state.times === 1 && !state.runs.size && !state.ways.size && !state.cured.size;
  const shown = visible(polar.circle);
  // Where the first repeat is switched off, the first of the others is bold.
  const bold = shown.some(curve => curve.b) ? curve => curve.b : curve => curve.n === shown[0].n;
  const [thick, thin] = [shown.filter(bold), shown.filter(curve => !bold(curve))];
  polar.curves.innerHTML = asPrinted ? polar.printed
    : thin.map(curve => line(polar, curve, curve.m, "faint")).join("")
      + thick.map(curve => line(polar, curve, curve.m, "measured")).join("")
      + thick.map(curve => line(polar, curve, curve.p, "predicted")).join("");
  for (const [text, printed, um] of polar.rings) {
    const now = um / state.times;
    text.textContent = state.times === 1 ? printed : signed(now, Number.isInteger(now) ? 0 : Math.abs(now) < 1 ? 2 : 1);
  }
};
const scales = all(".scale").map(span => [span, span.textContent]);
const drawScale = ([span, printed]) => {
  const count = (words, factor) => {
    const value = Number(words.replace(/\s/g, "")) * factor;
    return value >= 1e4 ? String(Math.round(value)).replace(/\B(?=(\d{3})+$)/g, "\u00a0") : String(+value.toPrecision(6));
  };
  span.textContent = printed
    .replace(/[\d\s]+(?= times)/, words => ` ${count(words, state.times)}`)
    .replace(/[\d.]+(?= µm per)/, words => count(words, 1 / state.times));
};

// From highest to lowest about the least-squares circle of what is shown, um.
const range = circle => {
  const shown = visible(circle).filter(curve => curve.b);
  const rows = shown.flatMap(curve => curve.m.map((um, k) => {
    const angle = curve.a[k] * Math.PI / 180;
    return [1, Math.cos(angle), Math.sin(angle), um - cured(curve, k)];
  }));
  if (rows.length < 4) return null;
  const normal = [0, 1, 2].map(i => [0, 1, 2, 3].map(k => rows.reduce((all, row) => all + row[i] * row[k], 0)));
  for (let i = 0; i < 3; i++)
    for (let k = 0; k < 3; k++)
      if (k !== i) {
        const factor = normal[k][i] / normal[i][i];
        normal[k] = normal[k].map((value, column) => value - factor * normal[i][column]);
      }
  const of = normal.map((row, i) => row[3] / row[i]);
  const left = rows.map(row => row[3] - of[0] - of[1] * row[1] - of[2] * row[2]);
  return left.reduce((most, um) => Math.max(most, um), -Infinity) - left.reduce((least, um) => Math.min(least, um), Infinity);
};
const printedRange = data.circles.map(range);
const gain = () => {
  const rms = open => Math.hypot(data.left, ...data.causes.filter((_, k) => open(k)).map(cause => cause[1]));
  const ranges = data.circles.map((circle, k) => [circle, printedRange[k], range(circle)])
    .filter(([circle, before, now]) => circle.w && before !== null && now !== null)
    .map(([circle, before, now]) => `${circle.name} ${number(before, 1)} \u2192 ${number(now, 1)} µm`);
  return `Residual of the model as it was: ${number(rms(() => true), 3)} \u2192 ${number(rms(k => !state.cured.has(k)), 3)} µm rms.`
    + (ranges.length ? ` Range about the least-squares circle, first repeat: ${ranges.join(", ")}.` : "");
};

const boxes = [];
const redraw = () => {
  polars.forEach(drawPolar);
  scales.forEach(drawScale);
  boxes.forEach(update => update());
};
const box = (set, key, words) => {
  const label = make("label");
  const input = make("input", "", { type: "checkbox" });
  const positive = set === state.cured;
  input.addEventListener("change", () => {
    input.checked === positive ? set.add(key) : set.delete(key);
    redraw();
  });
  boxes.push(() => { input.checked = set.has(key) === positive; });
  label.append(input, ` ${words}`);
  return label;
};
const group = (title, parts) => {
  const row = make("div");
  row.append(...(title ? [make("span", title)] : []), ...parts);
  return row;
};
const tools = ways => {
  const bar = make("div", "", { className: "tools" });
  const choice = make("select");
  for (const times of [0.5, 1, 2, 5, 10]) choice.append(make("option", `\u00d7 ${times}`, { value: times }));
  choice.addEventListener("change", () => { state.times = +choice.value; redraw(); });
  boxes.push(() => { choice.value = state.times; });
  const label = make("label", "Deviations ");
  label.append(choice);
  bar.append(group("", [label, ...ways.map((way, k) => box(state.ways, k, way))]));
  if (data.runs.length > 1) bar.append(group("Runs", data.runs.map((run, k) => box(state.runs, k, run))));
  if (data.causes.length && data.circles.some(circle => circle.t.some(curve => curve.e.length))) {
    const told = make("output");
    boxes.push(() => { told.textContent = state.cured.size ? gain() : ""; });
    bar.append(group("As if repaired", [...data.causes.map(([cause], k) => box(state.cured, k, cause)), told]));
  }
  return bar;
};
const ways = document.querySelector(".plots").dataset.ways.split(" ");
document.querySelector(".plots").append(tools(ways));
all("#circles > .legend").forEach(legend => legend.after(tools(ways)));

// Asking a plot: the reading that is nearest to the pointer.
const tip = make("div", "", { id: "tip", hidden: true });
document.body.append(tip);
const where = (circle, degrees) => {
  const at = place(circle, degrees * Math.PI / 180).map((part, axis) => number(circle.c[axis] + circle.r * part, 2));
  return `${number((degrees % 360 + 360) % 360, 1)}°: X ${at[0]} Y ${at[1]} Z ${at[2]} mm`;
};
const tell = (event, text) => {
  tip.textContent = text;
  tip.hidden = false;
  tip.style.left = `${Math.max(4, Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 8))}px`;
  tip.style.top = `${event.clientY + 18 + tip.offsetHeight > innerHeight ? event.clientY - tip.offsetHeight - 10 : event.clientY + 18}px`;
};
const inside = (svg, event) => new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
const ask = (svg, nearest, words) => {
  const dot = document.createElementNS(svg.namespaceURI, "g");
  dot.setAttribute("class", "asked");
  svg.append(dot);
  const hide = () => { tip.hidden = true; dot.innerHTML = ""; };
  const show = event => {
    const found = nearest(inside(svg, event));
    if (!found) return hide();
    dot.innerHTML = `<circle r="4" cx="${found.x}" cy="${found.y}"/>`;
    tell(event, words(...found.of));
  };
  svg.addEventListener("pointermove", show);
  svg.addEventListener("pointerdown", show);
  svg.addEventListener("pointerleave", hide);
  return hide;
};
const closest = (points, to, farthest) => {
  let best = null, least = farthest;
  for (const [x, y, ...of] of points) {
    const far = Math.hypot(x - to.x, y - to.y);
    if (far < least) { least = far; best = { x, y, of }; }
  }
  return best;
};
for (const { svg, circle, at } of polars)
  ask(svg, to => closest(visible(circle).flatMap(curve =>
    curve.m.map((um, k) => [...at(curve.a[k], um - cured(curve, k)), curve, k])), to, 25), (curve, k) => {
    const [read, foretold] = [curve.m[k], curve.p[k]].map(um => um - cured(curve, k));
    return `${circle.name}, ${data.runs[curve.n]}, ${ways[curve.way]}\n${where(circle, curve.a[k])}\n`
      + `read ${signed(read, 2)} µm, predicted ${signed(foretold, 2)}, left ${signed(read - foretold, 2)}`;
  });

// A chart with straight axes tells the nearest point of its lines and dots.
for (const svg of all("svg[data-chart]")) {
  const [left, right, bottom, top, ...ends] = svg.dataset.chart.split(" ").map(Number);
  const axes = all("text.axis", svg).map(text => text.textContent.split(/, (?=[^,]*$)/));
  const words = (axis, share) => {
    const [low, high] = ends.slice(2 * axis);
    const places = Math.max(0, Math.ceil(2.5 - Math.log10(high - low)));
    return `${axes[axis][0]} ${number(low + share * (high - low), places)} ${axes[axis][1] || ""}`;
  };
  let points;
  ask(svg, to => closest(points ||= all("polyline,.dots", svg).flatMap(curve =>
    (curve.getAttribute("points") || curve.getAttribute("d")).match(/[\d.]+[ ,][\d.]+/g)
      .map(pair => pair.split(/[ ,]/).map(Number)).map(([x, y]) => [x, y, curve.classList, x, y])), to, 25), (names, x, y) =>
    [words(0, (x - left) / (right - left)), words(1, (y - bottom) / (top - bottom)),
      ...["before", ...ways].filter((_, k) => names.contains(["before", "forward", "backward"][k]))].join("\n"));
}

// The sphere of what is left: turned by the pointer or the arrow keys.
for (const svg of all("svg[data-sphere]")) {
  const [x, y, radius, limit] = svg.dataset.sphere.split(" ").map(Number);
  let [azimuth, height] = [-60, 30];
  const curves = svg.querySelector(".curves");
  // Readings of all runs within 2 degrees, driven one way, are one dot; the way back runs inside of the way there.
  const dots = data.circles.flatMap(circle => [0, 1].flatMap(way => {
    const sums = new Map();
    for (const curve of circle.t.filter(curve => curve.way === way))
      curve.a.forEach((degrees, k) => {
        const stretch = Math.floor((degrees % 360 + 360) % 360 / 2);
        const before = sums.get(stretch) || [0, 0];
        sums.set(stretch, [before[0] + 1, before[1] + curve.m[k] - curve.p[k]]);
      });
    return [...sums].map(([stretch, [count, left]]) => {
      const degrees = 2 * stretch + 1;
      const at = place(circle, degrees * Math.PI / 180).map(part => part * (way ? 0.97 : 1));
      return { circle, way, degrees, count, at, left: left / count };
    });
  }));
  const seen = () => {
    const [az, el] = [azimuth, height].map(degrees => degrees * Math.PI / 180);
    return dots.map(dot => {
      const [a, b, c] = dot.at;
      const depth = a * Math.cos(az) + b * Math.sin(az);
      return [x + radius * (b * Math.cos(az) - a * Math.sin(az)), y - radius * (c * Math.cos(el) - depth * Math.sin(el)),
        dot, depth * Math.cos(el) + c * Math.sin(el)];
    });
  };
  const turn = () => {
    const paths = {};
    for (const [px, py, dot, near] of seen()) {
      const kind = Math.max(-2, Math.min(2, Math.round(2 * dot.left / limit))) + 2;
      const name = `${near < 0 ? "far" : "near"} left${kind}`;
      paths[name] = (paths[name] || "") + `M${px.toFixed(1)} ${py.toFixed(1)}h0`;
    }
    curves.innerHTML = ["far", "near"].flatMap(side => [2, 1, 3, 0, 4].map(kind => `${side} left${kind}`))
      .map(name => `<path class="dots ${name}" d="${paths[name] || ""}"/>`).join("");
  };
  const hide = ask(svg, to => held ? null : closest(seen().filter(point => point[3] >= 0), to, 10),
    dot => `${dot.circle.name}, ${ways[dot.way]}\n${where(dot.circle, dot.degrees)}\nleft ${signed(dot.left, 3)} µm, mean of ${dot.count}`);
  let held = null;
  const by = (right, up) => { azimuth -= right; height = Math.max(-90, Math.min(90, height + up)); turn(); };
  svg.addEventListener("pointerdown", event => { held = event; svg.setPointerCapture(event.pointerId); hide(); });
  svg.addEventListener("pointermove", event => {
    if (!held) return;
    by((event.clientX - held.clientX) * 0.5, (event.clientY - held.clientY) * 0.5);
    held = event;
  });
  for (const end of ["pointerup", "pointercancel"]) svg.addEventListener(end, () => { held = null; });
  svg.setAttribute("tabindex", "0");
  svg.addEventListener("keydown", event => {
    const step = { ArrowLeft: [-10, 0], ArrowRight: [10, 0], ArrowUp: [0, -10], ArrowDown: [0, 10] }[event.key];
    if (step) { event.preventDefault(); by(...step); }
  });
}

// What is linked is open, and so is all that is printed.
const reveal = () => {
  const at = document.getElementById(location.hash.slice(1));
  const fold = at && at.closest("details");
  if (fold && !fold.open) { fold.open = true; at.scrollIntoView(); }
};
addEventListener("hashchange", reveal);
addEventListener("click", event => event.target.closest("a") && setTimeout(reveal));
addEventListener("beforeprint", () => all("details").forEach(fold => { fold.open = true; }));
reveal();
redraw();
document.documentElement.classList.add("live");
