// The connection to the twin: receives its latest messages, and sends requests.

const link = {
  open: false,
  /** Handler of each kind of message. */
  takes: {},
  orders: new Map(),
  count: 0,
};

function connect() {
  const at = new URL("live", location.href);
  at.protocol = "ws:";
  at.search = location.search;
  const socket = new WebSocket(at);
  link.socket = socket;
  socket.addEventListener("open", () => {
    link.open = true;
  });
  socket.addEventListener("message", ({ data }) => {
    for (const [kind, value] of Object.entries(JSON.parse(data))) {
      if (kind === "answer") answered(value);
      else link.takes[kind]?.(value);
    }
  });
  socket.addEventListener("close", () => {
    link.open = false;
    for (const { refuse } of link.orders.values()) refuse(new Error("connection to the twin lost"));
    link.orders.clear();
    setTimeout(connect, 500);
  });
}

/** Sends a request; fails with the reason if it is not executed. */
function order(what, parameters = {}) {
  if (!link.open) return Promise.reject(new Error("the twin cannot be reached"));
  link.count += 1;
  const id = link.count;
  const text = JSON.stringify({ id, do: what, ...parameters });
  link.socket.send(text);
  return new Promise((done, refuse) => {
    link.orders.set(id, { done, refuse });
  });
}

function answered({ id, error }) {
  const waiting = link.orders.get(id);
  link.orders.delete(id);
  if (!waiting) return;
  if (error === null) waiting.done();
  else waiting.refuse(new Error(error));
}

/** Uploads a program text; fails with the reason if the program cannot be planned. */
async function handOver(name, text) {
  const at = new URL("program", location.href);
  at.search = location.search;
  at.searchParams.set("name", name);
  const answer = await fetch(at, { method: "POST", body: text }).catch(() => {
    throw new Error("the twin cannot be reached");
  });
  if (!answer.ok) throw new Error((await answer.text()).trim() || answer.statusText);
  const { error } = await answer.json();
  if (error !== null) throw new Error(error);
}

/** Removes earlier error messages from the page. */
function forgetComplaints() {
  for (const it of document.querySelectorAll(".said")) it.textContent = "";
}

/** Sends a request, and shows a refusal at a place on the page. */
function ask(place, what, parameters) {
  return attempt(place, () => order(what, parameters));
}

/** Runs a function, and shows its failure at a place on the page. */
async function attempt(place, what) {
  forgetComplaints();
  try {
    await what();
    return true;
  } catch (error) {
    $(place).textContent = error.message;
    return false;
  }
}
