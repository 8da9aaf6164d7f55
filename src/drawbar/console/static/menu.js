// On all pages: what a browser remembers of its own, light or dark and whether states sound; and a watch of the console.
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

// A console that was started again knows no page of before, and refuses its socket: the page is loaded again.
const PATIENCE = 7; // answers in a row without a socket, once a second; a socket that comes again needs up to 5 s
let answers = 0;

async function watchConsole() {
  const away = window.socket && !window.socket.connected;
  const question = away && fetch("/drawbar/menu.js", { cache: "no-store", signal: AbortSignal.timeout(5000) });
  const answer = await Promise.resolve(question).catch(() => null);
  answers = answer?.ok && !window.socket.connected ? answers + 1 : 0;
  if (answers > PATIENCE) window.location.reload();
  else setTimeout(watchConsole, 1000);
}
watchConsole();
