// @ts-check
// Stands in for the server of `spectra view`: the page's requests go to the engine in a worker.

const worker = new Worker("worker.js");
let asked = 0;
/** @type {Map<number, (answer: any) => void>} */
const waiting = new Map();
/** @type {{bytes: ArrayBuffer, number: number}?} */
let last = null;
/** @type {((bytes: ArrayBuffer) => void)?} */
let listener = null;
let after = 0;

/** @param {any} request @returns {Promise<any>} */
function ask(request) {
  asked += 1;
  const id = asked;
  return new Promise((done) => {
    waiting.set(id, done);
    worker.postMessage({ id, request });
  });
}

/** @param {Uint8Array<ArrayBuffer>} picture @param {(head: any) => void} edit */
function withHead(picture, edit) {
  const length = new DataView(picture.buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(picture.subarray(4, 4 + length)));
  edit(head);
  const before = new TextEncoder().encode(JSON.stringify(head));
  const padded = before.length + (4 - before.length % 4) % 4;
  const bytes = new Uint8Array(4 + padded + picture.length - 4 - length).fill(32, 0, 4 + padded);
  new DataView(bytes.buffer).setUint32(0, padded, true);
  bytes.set(before, 4);
  bytes.set(picture.subarray(4 + length), 4 + padded);
  return { bytes: bytes.buffer, number: head.frame };
}

worker.onmessage = ({ data }) => {
  if (data.picture) {
    last = withHead(data.picture, (head) => { head.since_change_ms = data.sinceMs; });
    if (listener && last.number > after) {
      listener(last.bytes);
      listener = null;
    }
  } else if (data.id) {
    waiting.get(data.id)?.(data.answer);
    waiting.delete(data.id);
  }
};

/** @param {any} answer */
const json = (answer) => {
  const fault = answer?.faults?.[0];
  if (fault) return new Response(`${fault.place ? `${fault.place}: ` : ""}${fault.message}${fault.hint ? ` (${fault.hint})` : ""}`, { status: 400 });
  return new Response(JSON.stringify(answer), { headers: { "content-type": "application/json" } });
};

const chosen = new URLSearchParams(location.search).get("scene") ?? "biotar-ortho";
const about = ask({ do: "load", module: "spectra.wasm" });

/** @param {URL} url @param {any} body @returns {Promise<Response>} */
async function answer(url, body) {
  const number = (/** @type {string} */ key) => Number(url.searchParams.get(key));
  switch (url.pathname) {
    case "/open": {
      const loaded = await about;
      if (loaded.faults) return json(loaded);
      const opened = await ask({ do: "open", scene: chosen, still: true });
      if (opened.faults) return json(opened);
      await ask({ do: "width", width: 480 });
      return json({ desk: 1 });
    }
    case "/turn":
      return json(await ask(body.path === "width" ? { do: "width", width: body.value } : { do: "turn", ...body }));
    case "/frame":
      after = number("after");
      if (last && last.number > after) return new Response(last.bytes);
      return new Promise((done) => { listener = (bytes) => done(new Response(bytes)); });
    case "/controls":
      return json(await ask({ do: "controls" }));
    case "/spectra":
      return json(await ask({ do: "spectra" }));
    case "/pixel":
      return json(await ask({ do: "pixel", x: number("x"), y: number("y") }));
    case "/section": {
      const drawn = await ask({ do: "section", ground: url.searchParams.get("ground") });
      return drawn.faults ? json(drawn) : new Response(drawn, { headers: { "content-type": "image/svg+xml" } });
    }
    default:
      return new Response(null, { status: 204 });
  }
}

const server = globalThis.fetch;
globalThis.fetch = (what, options) => {
  if (typeof what === "string" && what.startsWith("/")) {
    const body = typeof options?.body === "string" ? JSON.parse(options.body) : null;
    return answer(new URL(what, location.origin), body);
  }
  return server(what, options);
};

// Choice of the scene, and comparison of the bits --------------------------------------------------------------------------------

const bar = document.createElement("p");
bar.className = "tools";
bar.id = "serverless";
const scenes = document.createElement("select");
scenes.setAttribute("aria-label", "Scene");
scenes.addEventListener("change", () => { location.search = `?scene=${encodeURIComponent(scenes.value)}`; });
const button = document.createElement("button");
button.type = "button";
button.id = "bits";
button.textContent = "Compare bits with the command line";
const said = document.createElement("output");
said.id = "bits-said";
bar.append(scenes, button, said);
document.querySelector("header")?.append(bar);

/** @type {Promise<{set: string[], samples: number, scenes: Record<string, string>}>} */
const known = server("fingerprints.json").then((found) => found.json());

Promise.all([about, known]).then(([{ scenes: names, faults }, { scenes: with_bits }]) => {
  if (faults) return;
  scenes.append(...names.filter((/** @type {string} */ name) => name in with_bits).map((/** @type {string} */ name) => new Option(name, name, false, name === chosen)));
});

/** Renders a scene in an engine of its own, as `spectra run` did when this folder was made. @param {string} scene */
async function fingerprint(scene) {
  const { set, samples } = await known;
  const own = new Worker("worker.js");
  let count = 0;
  /** @param {any} request @returns {Promise<any>} */
  const tell = (request) => new Promise((done) => {
    count += 1;
    const mine = count;
    own.addEventListener("message", ({ data }) => data.id === mine && done(data.answer));
    own.postMessage({ id: mine, request });
  });
  try {
    await tell({ do: "load", module: "spectra.wasm" });
    const opened = await tell({ do: "open", scene, set, still: true });
    if (opened.faults) throw new Error(opened.faults[0].message);
    const from = performance.now();
    await tell({ do: "step", samples });
    const { fingerprint: found } = await tell({ do: "fingerprint" });
    return { found, seconds: (performance.now() - from) / 1000 };
  } finally {
    own.terminate();
  }
}

button.addEventListener("click", async () => {
  button.disabled = true;
  said.textContent = "tracing";
  try {
    const { set, scenes: bits } = await known;
    const { found, seconds } = await fingerprint(chosen);
    const command = `spectra run ${chosen} ${set.map((text) => `--set ${text}`).join(" ")}`;
    const same = found === bits[chosen] ? "the same bits" : `not the same: the command line has ${bits[chosen]}`;
    said.textContent = `${found} in ${seconds.toFixed(2)} s: ${same} (fingerprint in the report of ${command})`;
    said.dataset.same = String(found === bits[chosen]);
  } catch (error) {
    said.textContent = String(error);
  }
  button.disabled = false;
});
Object.assign(globalThis, { spectraFingerprint: fingerprint, spectraAbout: about });
