// Instruments: figures, light bars and map. Draws one picture at a time and says which state of the gate it has drawn.
// Where no picture has come for a second, or those that come are late by so much, everything is greyed: what is shown is
// old. A browser that was frozen gets first what waited for it meanwhile.

const STALE = 1000; // ms
const DRIFT = 0.1; // ms from picture to picture by which the clocks of browser and console may go apart
const TRAIL = 3000;
const MARGIN = 20; // px around the view in which lines are drawn as well
const BANDS = [[0.05, "--good", 3], [0.15, "--warn", 5], [Infinity, "--bad", 7]]; // error m, colour, width px

export default {
  template: `
    <div class="instruments">
      <section class="figures" aria-live="off">
        <div v-for="body in picture.bodies" class="body-error" :aria-label="body.name + ' ' + body.figure + ' cm ' + body.side">
          <div class="body-name">{{ body.name }}</div>
          <div class="body-figure"><span class="arrow" v-if="body.arrow === '◀'">◀</span><b>{{ body.figure }}</b><small>cm</small><span class="arrow" v-if="body.arrow === '▶'">▶</span></div>
          <div class="lightbar" role="img" :aria-label="body.side">
            <i v-for="n in 21" :class="lamp(n, body.bar)"></i>
          </div>
          <div class="body-side">{{ body.side }}</div>
        </div>
        <ul class="chips">
          <li v-for="chip in picture.chips" :class="chip.good ? 'ok' : 'doubt'">
            <span class="chip-name">{{ chip.name }}</span>
            <span class="chip-value">{{ chip.good ? '✓' : '!' }} {{ chip.value }}</span>
          </li>
        </ul>
      </section>
      <section class="map" ref="box">
        <canvas ref="canvas" role="img" :aria-label="texts.map"></canvas>
        <div class="zoom">
          <button type="button" @click="zoom(1.4)" :aria-label="texts.zoom_in">+</button>
          <button type="button" @click="zoom(1 / 1.4)" :aria-label="texts.zoom_out">−</button>
          <button type="button" @click="toggleWhole" :aria-label="texts.whole" :aria-pressed="whole">⤢</button>
        </div>
        <div class="old" role="alert" v-if="old">⚠ {{ texts.old }}</div>
      </section>
    </div>`,
  props: { standing: String, texts: Object },
  data() {
    return {
      picture: { bodies: [], chips: [] },
      old: true,
      whole: false,
      scale: 14, // px per m
    };
  },
  mounted() {
    this.scene = JSON.parse(this.standing);
    this.lines = this.scene.lines;
    this.boundary = this.scene.boundary;
    this.trail = this.scene.trail || [];
    this.last = 0; // when the picture would have come by the quickest way, ms
    this.quickest = Infinity; // the browser's clock when a picture comes, less the console's when it is sent, ms
    if (this.$refs.box.clientWidth > 600) this.scale = 26;
    this.state = null;
    this.unrecorded = false;
    this.watch = setInterval(() => this.judge(), 200);
    this.observer = new ResizeObserver(() => this.paint());
    this.observer.observe(this.$refs.box);
    this.looks = new MutationObserver(() => this.paint());
    this.looks.observe(document.body, { attributes: true, attributeFilter: ["class"] });
    this.judge();
    this.stayAwake();
    document.addEventListener("visibilitychange", this.stayAwake);
    document.addEventListener("click", this.hold, { once: true });
    window.addEventListener("popstate", this.goBack);
  },
  unmounted() {
    document.removeEventListener("visibilitychange", this.stayAwake);
    document.removeEventListener("click", this.hold);
    window.removeEventListener("popstate", this.goBack);
    clearInterval(this.watch);
    this.observer.disconnect();
    this.looks.disconnect();
  },
  methods: {
    showLines(lines) {
      this.lines = lines;
      this.paint();
    },
    draw(picture) {
      this.picture = picture;
      this.quickest = Math.min(performance.now() - picture.sent, this.quickest + DRIFT);
      this.last = picture.sent + this.quickest;
      const moving = picture.moving;
      if (moving) {
        const [x, y] = moving.tractor;
        const end = this.trail[this.trail.length - 1];
        if (!end || Math.hypot(x - end[0], y - end[1]) > 0.1) this.trail.push([x, y, picture.error]);
        if (this.trail.length > TRAIL) this.trail.shift();
      }
      this.tell(picture);
      this.judge();
      requestAnimationFrame(() => {
        this.paint();
        if (!picture.stale) this.$emit("drawn", picture.seen);
      });
    },
    // A tablet that sleeps while it has control stops the vehicle. Browsers allow this over TLS and on the same computer.
    stayAwake() {
      if (!document.hidden) navigator.wakeLock?.request("screen").catch(() => {});
    },
    // Back, a button or a swipe from the edge, first leads from here to here: whether it may lead on is asked. Browsers heed
    // an entry only of a page that was touched.
    hold() {
      history.pushState(null, "");
    },
    goBack() {
      this.$emit("back");
    },
    judge() {
      this.old = this.picture.stale !== false || performance.now() - this.last > STALE;
      document.body.classList.toggle("old-picture", this.old);
    },
    tell({ state, unrecorded }) {
      if (this.state !== null && sounds()) {
        if (state !== this.state) beep(state);
        else if (unrecorded && !this.unrecorded) beep("UNRECORDED");
      }
      this.state = state;
      this.unrecorded = unrecorded;
    },
    lamp(n, value) {
      if (value === null || value === undefined) return "off";
      const place = 11 - Math.round(value * 10); // left positive: to the left
      if (n === place) return n === 11 ? "on centre" : Math.abs(value) <= 0.34 ? "on near" : "on far";
      return n === 11 ? "middle" : "off";
    },
    zoom(factor) {
      this.whole = false;
      this.scale = Math.min(80, Math.max(1.5, this.scale * factor));
      this.paint();
    },
    toggleWhole() {
      this.whole = !this.whole;
      this.paint();
    },
    paint() {
      const canvas = this.$refs.canvas, box = this.$refs.box;
      if (!canvas || !box || !box.clientWidth) return;
      const dense = window.devicePixelRatio || 1, width = box.clientWidth, height = box.clientHeight;
      if (canvas.width !== Math.round(width * dense) || canvas.height !== Math.round(height * dense)) {
        canvas.width = Math.round(width * dense);
        canvas.height = Math.round(height * dense);
      }
      const ink = canvas.getContext("2d"), style = getComputedStyle(document.body);
      const colour = (name) => style.getPropertyValue(name).trim();
      ink.setTransform(dense, 0, 0, dense, 0, 0);
      ink.fillStyle = colour("--ground");
      ink.fillRect(0, 0, width, height);
      const to = this.camera(width, height), view = [width, height];
      const boundary = this.boundary;
      if (boundary.length) stroke(ink, to, view, [...boundary, boundary[0]], colour("--edge"), 5, []);
      for (const line of this.lines.neighbours) stroke(ink, to, view, line, colour("--edge"), 1.5, [2, 5]);
      stroke(ink, to, view, this.lines.path, colour("--line"), 2.5, [9, 6]);
      this.paintTrail(ink, to, view, colour);
      grid(ink, to, height, colour);
      const moving = this.picture.moving;
      if (!moving) return;
      this.paintTubes(ink, to, view, moving.plans, colour);
      stroke(ink, to, view, moving.plans[1], colour("--trailer"), 3, [3, 4]);
      stroke(ink, to, view, moving.plans[0], colour("--tractor"), 3, []);
      this.paintBodies(ink, to, moving, colour);
    },
    camera(width, height) {
      const moving = this.picture.moving;
      if (this.whole || !moving) {
        const [low, high] = extent([...this.lines.path, ...this.boundary]);
        const scale = 0.9 * Math.min(width / Math.max(high[0] - low[0], 1), height / Math.max(high[1] - low[1], 1));
        const middle = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2];
        return transform(middle, Math.PI / 2, scale, [width / 2, height / 2]);
      }
      const scale = this.scale * Math.min(1, Math.max(0.5, height / 180)); // both bodies, also where there is little room
      return transform(moving.tractor, moving.tractor[2], scale, [width / 2, height * 0.56]);
    },
    // How far beside its plan each body may be.
    paintTubes(ink, to, view, plans, colour) {
      ink.globalAlpha = 0.3;
      for (const [n, name] of [[1, "--trailer"], [0, "--tractor"]]) {
        const width = 2 * this.scene.tubes[n] * pixels(to);
        if (width > 0) stroke(ink, to, view, plans[n], colour(name), width, []);
      }
      ink.globalAlpha = 1;
    },
    paintTrail(ink, to, view, colour) {
      ink.globalAlpha = 0.75;
      let piece = [], drawn = null;
      const end = () => {
        if (drawn !== null) stroke(ink, to, view, piece, colour(BANDS[drawn][1]), BANDS[drawn][2], []);
      };
      for (const point of this.trail) {
        const error = Math.abs(point[2] ?? Infinity);
        const band = BANDS.findIndex(([limit]) => error <= limit);
        if (band !== drawn) {
          end();
          piece = piece.slice(-1);
          drawn = band;
        }
        piece.push(point);
      }
      end();
      ink.globalAlpha = 1;
    },
    paintBodies(ink, to, moving, colour) {
      const standing = this.scene, edge = colour("--ink");
      const joint = place(moving.tractor, [standing.tractorJoint, 0]);
      const eye = place(moving.trailer, [standing.trailerJoint, 0]);
      stroke(ink, to, [Infinity, Infinity], [joint, eye], edge, 4, []);
      shapes(ink, to, moving.trailer, standing.trailer, colour("--trailer"), edge);
      const steered = standing.tractor.length - standing.steered;
      shapes(ink, to, moving.tractor, standing.tractor.slice(0, steered), colour("--tractor"), edge);
      const wheels = standing.tractor.slice(steered).map((wheel) => turned(wheel, moving.steering));
      shapes(ink, to, moving.tractor, wheels, edge, edge);
      ink.fillStyle = colour("--ground");
      ink.strokeStyle = edge;
      ink.lineWidth = 2;
      for (const point of [joint, eye]) {
        ink.beginPath();
        ink.arc(...to(point), 4, 0, 2 * Math.PI);
        ink.fill();
        ink.stroke();
      }
    },
  },
};

// Returns what takes a place in the field (m) to the screen (px), with `yaw` upwards and `middle` at `at`.
function transform(middle, yaw, scale, at) {
  const cos = Math.cos(yaw), sin = Math.sin(yaw);
  return ([x, y]) => {
    const east = x - middle[0], north = y - middle[1];
    const ahead = cos * east + sin * north, left = -sin * east + cos * north;
    return [at[0] - scale * left, at[1] - scale * ahead];
  };
}

function place([x, y, yaw], [ahead, left]) {
  const cos = Math.cos(yaw), sin = Math.sin(yaw);
  return [x + cos * ahead - sin * left, y + sin * ahead + cos * left];
}

function turned(wheel, angle) {
  const corners = wheel.slice(0, 4);
  const middle = [0, 1].map((axis) => corners.reduce((sum, point) => sum + point[axis], 0) / corners.length);
  return wheel.map((point) => place([...middle, angle], [point[0] - middle[0], point[1] - middle[1]]));
}

// Draws what of a line is in the view: long dashes out of it would cost more than all the rest. Points that would lie
// within a pixel of the last one are left out.
function stroke(ink, to, view, points, colour, width, dash) {
  if (!points || points.length < 2) return;
  ink.strokeStyle = colour;
  ink.lineWidth = width;
  ink.lineJoin = "round";
  ink.setLineDash(dash);
  let last = to(points[0]), along = 0, open = false;
  const finish = () => open && ink.stroke();
  for (let i = 1; i < points.length; i++) {
    const next = to(points[i]), length = Math.hypot(next[0] - last[0], next[1] - last[1]);
    if (length < 1 && i < points.length - 1) continue;
    if (outside(last, next, view)) {
      finish();
      open = false;
    } else {
      if (!open) {
        ink.lineDashOffset = along; // the dashes stay where they are in the field
        ink.beginPath();
        ink.moveTo(...last);
        open = true;
      }
      ink.lineTo(...next);
    }
    along += length;
    last = next;
  }
  finish();
  ink.lineDashOffset = 0;
  ink.setLineDash([]);
}

function outside(a, b, view) {
  return [0, 1].some((axis) => Math.max(a[axis], b[axis]) < -MARGIN || Math.min(a[axis], b[axis]) > view[axis] + MARGIN);
}

function shapes(ink, to, pose, polygons, fill, edge) {
  ink.fillStyle = fill;
  ink.strokeStyle = edge;
  ink.lineWidth = 1.2;
  for (const polygon of polygons) {
    ink.beginPath();
    polygon.forEach((point, i) => {
      const at = to(place(pose, point));
      i ? ink.lineTo(...at) : ink.moveTo(...at);
    });
    ink.closePath();
    ink.fill();
    ink.stroke();
  }
}

function extent(points) {
  const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  for (const point of points) {
    for (const axis of [0, 1]) {
      low[axis] = Math.min(low[axis], point[axis]);
      high[axis] = Math.max(high[axis], point[axis]);
    }
  }
  return [low, high];
}

// Of a metre.
function pixels(to) {
  const [a, b] = [to([0, 0]), to([1, 0])];
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}

// A bar of a round length, so that distances on the map can be judged.
function grid(ink, to, height, colour) {
  const scale = pixels(to);
  const length = [1, 2, 5, 10, 20, 50, 100, 200].find((each) => each * scale >= 48) || 500;
  ink.fillStyle = colour("--ground");
  ink.fillRect(6, height - 34, length * scale + 12, 30); // lines behind it would hide the figure
  ink.strokeStyle = ink.fillStyle = colour("--ink");
  ink.lineWidth = 2;
  ink.beginPath();
  ink.moveTo(12, height - 16);
  ink.lineTo(12, height - 10);
  ink.lineTo(12 + length * scale, height - 10);
  ink.lineTo(12 + length * scale, height - 16);
  ink.stroke();
  ink.font = "600 14px system-ui, sans-serif";
  ink.fillText(`${length} m`, 18, height - 17);
}

let speaker = null;
function beep(state) {
  try {
    speaker = speaker || new AudioContext();
    const grave = ["FAULT", "ESTOP", "STOPPING", "OVERRIDE", "NO_CONTACT", "UNRECORDED"].includes(state);
    for (let n = 0; n < (grave ? 3 : 1); n++) {
      const tone = speaker.createOscillator(), volume = speaker.createGain();
      tone.frequency.value = grave ? 440 : state === "ACTIVE" ? 1040 : 780;
      volume.gain.value = 0.2;
      tone.connect(volume).connect(speaker.destination);
      tone.start(speaker.currentTime + 0.22 * n);
      tone.stop(speaker.currentTime + 0.22 * n + 0.14);
    }
  } catch {
    speaker = null; // a browser without sound, or before the first touch
  }
}
