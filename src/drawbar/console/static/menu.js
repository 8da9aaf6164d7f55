// What a browser remembers of its own: light or dark, and whether states sound. Both hold on all pages.
const YEAR = 365 * 86400;

function remember(name, value) {
  document.cookie = `${name}=${value}; max-age=${YEAR}; path=/; samesite=strict`;
}

function toggleLook() {
  const dark = !document.body.classList.contains("body--dark");
  Quasar.Dark.set(dark);
  remember("drawbar-look", dark ? "dark" : "light");
}

function sounds() {
  return !document.cookie.includes("drawbar-sound=off");
}

function toggleSound(on, off) {
  remember("drawbar-sound", sounds() ? "off" : "on");
  Quasar.Notify.create({ message: sounds() ? on : off, position: "top" });
}
