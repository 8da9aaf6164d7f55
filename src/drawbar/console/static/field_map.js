// Field map: boundary, lines, the chosen pass, what will be driven and where that leaves it, and the tractor.
// Points are [east, north] in m; north is up. A line is chosen by touching it.

export default {
  template: `
    <div class="field-map">
      <svg ref="svg" :viewBox="box.join(' ')" role="img" :aria-label="texts.field_map" preserveAspectRatio="xMidYMid meet"
        @pointerdown="grab" @pointermove="drag" @pointerup="release" @pointercancel="release" @wheel.prevent="wheel">
        <polygon v-if="scene.boundary.length" class="boundary" :points="text(scene.boundary)" />
        <g v-for="line in scene.lines" :key="line.name" class="line" @click="choose(line.name)">
          <polyline class="touch" :points="text(line.points)" />
          <polyline class="drawn" :points="text(line.points)" />
          <title>{{ line.name }}</title>
        </g>
        <polyline class="chosen" :points="text(scene.chosen)" />
        <polyline class="driven" :points="text(scene.driven)" />
        <polyline v-for="(piece, i) in scene.aside" :key="i" class="aside" :points="text(piece)" />
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
  props: { drawn: String, texts: Object },
  data() {
    return { box: [-50, -50, 100, 100], at: null, track: [], held: null, width: 360, height: 300 };
  },
  computed: {
    scene() {
      return JSON.parse(this.drawn);
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
    scene(now, before) {
      if (JSON.stringify(now.lines) !== JSON.stringify(before.lines) || now.name !== before.name) this.fit();
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
      this.track = track;
    },
    choose(name) {
      if (!this.moved) this.$emit("choose", name);
    },
    fit() {
      const all = [...this.scene.boundary, ...this.scene.chosen, ...this.scene.lines.flatMap((line) => line.points)];
      if (this.at && !all.length) all.push(this.at);
      if (!all.length) return;
      const xs = all.map((point) => point[0]), ys = all.map((point) => -point[1]);
      const low = [Math.min(...xs), Math.min(...ys)];
      const size = Math.max(Math.max(...xs) - low[0], Math.max(...ys) - low[1], 10) * 0.08;
      this.box = [low[0] - size, low[1] - size, Math.max(...xs) - low[0] + 2 * size, Math.max(...ys) - low[1] + 2 * size];
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
