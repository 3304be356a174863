// @ts-check
// The engine, in a thread of its own: it answers requests, and between them traces pieces of the picture.

/** Approximate duration of one piece of the picture, ms; changes are handled between pieces. */
const PIECE_MS = 120;

/** @typedef {{memory: WebAssembly.Memory, start(): void, inbox(bytes: number): number, call(): number, outbox(): number}} Engine */
/** @type {Engine} */
let engine;
const text = new TextEncoder();

/** @param {any} request @returns {Uint8Array<ArrayBuffer>} */
function raw(request) {
  const bytes = text.encode(JSON.stringify(request));
  // A call may move the memory, so its buffer is looked up again afterwards.
  const inbox = engine.inbox(bytes.length);
  new Uint8Array(engine.memory.buffer, inbox, bytes.length).set(bytes);
  const length = engine.call();
  const outbox = engine.outbox();
  return new Uint8Array(engine.memory.buffer, outbox, length).slice();
}

/** @param {any} request @returns {any} */
function ask(request) {
  return JSON.parse(new TextDecoder().decode(raw(request)));
}

/** Progress of the picture. `paceMs` is the time that one sample of all pixels takes, ms. */
let state = { samples: 0, of: 0 };
let paceMs = 0;
let started = 0;
let isAtWork = false;

/** @param {any} answer */
function changed(answer) {
  if (answer.faults) return;
  state = answer;
  paceMs = 0;
  started = performance.now();
}

function show() {
  const picture = raw({ do: "look" });
  postMessage({ picture, sinceMs: performance.now() - started }, { transfer: [picture.buffer] });
}

/** Traces a piece, shows it, and continues with the next after pending messages are handled. */
function work() {
  isAtWork = false;
  if (state.samples >= state.of) return;
  const from = performance.now();
  const samples = paceMs > 0 ? Math.max(1, Math.floor(PIECE_MS / paceMs)) : 1;
  const before = state.samples;
  const answer = ask({ do: "step", samples });
  if (answer.faults) {
    postMessage({ fault: answer });
    return;
  }
  state = answer;
  // The first sample includes the preparation of the scene, so it is not timed.
  if (before > 0) paceMs = (performance.now() - from) / samples;
  show();
  goOn();
}

const next = new MessageChannel();
next.port1.onmessage = work;
function goOn() {
  if (isAtWork) return;
  isAtWork = true;
  next.port2.postMessage(null);
}

onmessage = async ({ data: { id, request } }) => {
  /** @type {any} */
  let answer;
  try {
    if (request.do === "load") {
      const { instance } = await WebAssembly.instantiateStreaming(fetch(request.module), {});
      engine = /** @type {Engine} */ (/** @type {unknown} */ (instance.exports));
      engine.start();
      answer = ask({ do: "about" });
    } else if (request.do === "section") {
      const drawn = raw(request);
      // The answer is a drawing, or JSON with the reason why there is none.
      answer = drawn[0] === 0x7b ? JSON.parse(new TextDecoder().decode(drawn)) : drawn;
    } else {
      answer = ask(request);
      if (["open", "width", "turn"].includes(request.do)) {
        changed(answer);
        // Light that is still valid is only developed again.
        if (answer.kept && answer.light) show();
        if (!request.still) goOn();
      }
    }
  } catch (error) {
    answer = { faults: [{ message: `the engine stopped: ${error}`, hint: "reload the page" }] };
  }
  postMessage({ id, answer });
};
