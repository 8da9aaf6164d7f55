// Field map: boundary, lines, the chosen pass, what will be driven and where that leaves it, and the tractor.
// Points are [east, north] in m; north is up. A line is chosen by touching it.

const NOTHING = Object.freeze({ chosen: [], driven: [], deviating: [] }); // what is frozen is not watched, point by point

export default {
  template: `
    <div class="field-map">
      <svg ref="svg" :viewBox="box.join(' ')" role="img" :aria-label="texts.field_map" preserveAspectRatio="xMidYMid meet"
        @pointerdown="grab" @pointermove="drag" @pointerup="release" @pointercancel="release" @wheel.prevent="wheel">
        <polygon v-if="shown.boundary.length" class="boundary" :points="text(shown.boundary)" />
        <g v-for="line in shown.lines" :key="line.name" class="line" @click="choose(line.name)">
          <polyline class="touch" :points="line.text" />
          <polyline class="drawn" :points="line.text" />
          <title>{{ line.name }}</title>
        </g>
        <polyline class="chosen" :points="text(pass.chosen)" />
        <polyline class="driven" :points="text(pass.driven)" />
        <polyline v-for="(piece, i) in pass.deviating" :key="i" class="deviating" :points="text(piece)" />
        <polyline class="track" :points="text(track)" />
        <g v-if="at" :transform="'translate(' + at[0] + ' ' + -at[1] + ') rotate(' + turn + ') scale(' + pixel + ')'">
          <path class="tractor" d="M 16 0 L -10 10 L -5 0 L -10 -10 Z" />
        </g>
      </svg>
      <div class="zoom">
        <button type="button" @click="zoom(0.7)" :aria-label="texts.zoom_in">+</button>
        <button type="button" @click="zoom(1 / 0.7)" :aria-label="texts.zoom_out">−</button>
        <button type="button" @click="fit" :aria-label="texts.whole">⤢</button>
      </div>
      <div class="scale"><i :style="{ width: bar / pixel + 'px' }"></i>{{ bar }} m</div>
    </div>`,
  props: { field: String, texts: Object },
  data() {
    return { box: [-50, -50, 100, 100], pass: NOTHING, at: null, track: [], held: null, width: 360, height: 300 };
  },
  computed: {
    shown() {
      const { boundary, lines } = JSON.parse(this.field);
      return { boundary, lines: lines.map((line) => ({ ...line, text: this.text(line.points) })) };
    },
    pixel() { // m
      return Math.max(this.box[2] / this.width, this.box[3] / this.height);
    },
    bar() {
      return [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].find((each) => each / this.pixel >= 48) || 2000;
    },
    turn() {
      return this.at[2] === null ? -90 : (-this.at[2] * 180) / Math.PI;
    },
  },
  watch: {
    field(now, before) {
      if (now === before) return;
      this.pass = NOTHING;
      this.fit();
    },
  },
  mounted() {
    this.observer = new ResizeObserver(() => {
      this.width = this.$refs.svg.clientWidth || 360;
      this.height = this.$refs.svg.clientHeight || 300;
    });
    this.observer.observe(this.$refs.svg);
    this.fit();
  },
  unmounted() {
    this.observer.disconnect();
  },
  methods: {
    text(points) {
      return points.map(([x, y]) => `${x},${-y}`).join(" ");
    },
    move(place, track) {
      this.at = place;
      if (track) this.track = Object.freeze(track);
      requestAnimationFrame(() => this.$emit("moved"));
    },
    showPlan(pass) {
      const first = this.pass === NOTHING;
      this.pass = Object.freeze(pass);
      if (first) this.fit();
    },
    choose(name) {
      if (!this.moved) this.$emit("choose", name);
    },
    fit() {
      const all = [...this.shown.boundary, ...this.pass.chosen, ...this.shown.lines.flatMap((line) => line.points)];
      if (this.at && !all.length) all.push(this.at);
      if (!all.length) return;
      const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
      for (const [x, y] of all) {
        low[0] = Math.min(low[0], x), low[1] = Math.min(low[1], -y);
        high[0] = Math.max(high[0], x), high[1] = Math.max(high[1], -y);
      }
      const size = Math.max(high[0] - low[0], high[1] - low[1], 10) * 0.08;
      this.box = [low[0] - size, low[1] - size, high[0] - low[0] + 2 * size, high[1] - low[1] + 2 * size];
    },
    zoom(factor) {
      const [x, y, w, h] = this.box;
      this.box = [x + (w * (1 - factor)) / 2, y + (h * (1 - factor)) / 2, w * factor, h * factor];
    },
    wheel(event) {
      this.zoom(event.deltaY > 0 ? 1.15 : 1 / 1.15);
    },
    grab(event) {
      this.held = [event.clientX, event.clientY, ...this.box.slice(0, 2)];
      this.moved = false;
    },
    drag(event) {
      if (!this.held) return;
      const dx = event.clientX - this.held[0], dy = event.clientY - this.held[1];
      if (Math.hypot(dx, dy) > 6) this.moved = true;
      if (this.moved) this.box = [this.held[2] - dx * this.pixel, this.held[3] - dy * this.pixel, this.box[2], this.box[3]];
    },
    release() {
      this.held = null;
    },
  },
};
