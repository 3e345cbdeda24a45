// The page: what each message shows, and what each key, button and movement asks for.
//
// A text that is typed here has a number. What the server says of a text counts only where it has heard the last of
// them: until then its text, and the places in it, are those of an older one.

import { connect, unframed } from "./connection.js";
import { makeEditor } from "./editor.js";
import { drawPath, makePicture, paint, watchMouse } from "./picture.js";

const element = (id) => document.getElementById(id);
const native = makePicture(element("native"));
const mitsuba = makePicture(element("by-mitsuba"));
const difference = makePicture(element("difference"));
const path = native.figure.querySelector("svg");

let page = ""; // this page's name, for uploads
let typed = 0; // the number of the last text that was sent
let heard = 0; // and of the last one that the server has heard
let offline = false; // typed while there was no server
let elsewhere = false; // the file has changed elsewhere, and so has the text here
let version = 0; // of the text that the server has
let wrong = false; // the text has mistakes
let number = null; // under the cursor
let sliding = false;

const current = () => heard === typed;

// ---- What the server says -------------------------------------------------------------------------------------------

const shown = {
  scene(message) {
    page = message.page;
    element("file").textContent = message.file;
    document.title = `${message.file} - whitted`;
    if (native.canvas.width === message.width && native.canvas.height === message.height) return;
    for (const picture of [native, mitsuba, difference]) picture.resize(message.width, message.height);
    element("over").width = message.width;
    element("over").height = message.height;
  },

  text(message) {
    if (offline) {
      offline = false;
      send();
    } else if (message.heard === typed) {
      document.body.dataset.version = version = message.version;
      editor.adopt(message.text, message.mine);
    }
  },

  state(message) {
    heard = message.heard;
    if (current()) document.body.dataset.version = version = message.version;
    elsewhere = message.elsewhere;
    element("state").textContent = elsewhere
      ? "changed here and elsewhere"
      : message.saved ? "saved" : "not saved";
    element("save").textContent = elsewhere ? "Save over it" : "Save";
    element("load").hidden = !elsewhere;
    document.body.dataset.saved = message.saved;
  },

  reading({ version: of, marks, omitted }) {
    if (!current() || of < version) return;
    editor.underline(marks);
    const items = marks.map(({ start, line, column, message }) => {
      const item = listItem(line ? `${line}:${column}: ${message}` : message);
      item.addEventListener("click", () => editor.goTo(start));
      return item;
    });
    if (omitted) items.push(listItem(`... and ${omitted} more`));
    element("mistakes").replaceChildren(...items);
    element("notes").replaceChildren();
    wrong = marks.length > 0;
    native.figure.classList.toggle("old", wrong);
  },

  notes({ version: of, notes }) {
    if (of === version) element("notes").replaceChildren(...notes.map(listItem));
  },

  native(frame) {
    native.show(frame);
    native.figure.classList.toggle("old", wrong); // it may come after what is told of a newer text
    const size = frame.whole ? "" : ", small first";
    native.tell(`native, ${(1000 * frame.seconds).toFixed(0)} ms${size}${frame.note ? `: ${frame.note}` : ""}`);
  },

  undrawn({ message }) {
    native.tell(message);
    native.figure.classList.add("old");
  },

  drawing() {
    for (const picture of [mitsuba, difference]) picture.figure.classList.add("old");
    mitsuba.tell("Mitsuba draws ...");
  },

  mitsuba(frame) {
    showBeside(mitsuba, frame);
    mitsuba.tell("Mitsuba");
  },

  difference(frame) {
    showBeside(difference, frame);
    difference.tell(frame.told);
  },

  undrawn_by_mitsuba({ message }) {
    mitsuba.tell(message);
  },

  rays({ found }) {
    drawPath(path, native.canvas, found);
    element("rays").hidden = !found;
    if (!found) return;
    element("pixel").textContent = `Pixel (${found.x}, ${found.y})`;
    const colors = Object.entries(found.colors).map(([name, color]) => `${name} ${color}`).join("; ");
    element("same").textContent = `${colors}. ${found.verdict}`;
    const lines = found.lines.map(({ text, side, first }) => {
      const line = document.createElement("span");
      line.className = first ? `${side} first` : side;
      line.textContent = `${text}\n`;
      return line;
    });
    element("tree").replaceChildren(...lines);
  },

  number({ found }) {
    if (sliding || (found && editor.slice(found.start, found.end) !== found.word)) return;
    number = found;
    element("number").hidden = !found;
    if (!found) return;
    element("number-name").textContent = found.name || "number";
    element("number-value").textContent = found.word;
    Object.assign(element("slider"), { min: found.low, max: found.high, step: found.step, value: found.value });
  },

  why({ message, done }) {
    element("verdict").hidden = false;
    element("verdict").textContent = message;
    element("why").disabled = !done;
  },

  said({ message }) {
    element("said").textContent = message;
  },
};

const server = connect({
  onMessage: (message) => shown[message.type]?.(message),
  onOpen() {
    typed = heard = version = 0;
    element("gone").hidden = true;
    if (element("mitsuba").getAttribute("aria-pressed") === "true") server.send({ type: "mitsuba", on: true });
  },
  onGone() {
    offline ||= !current();
    element("gone").hidden = false;
    element("state").textContent = "no server";
    keep();
  },
});

// Mitsuba takes longer: what it has drawn may belong to an older text than the picture at its side.
function showBeside(picture, frame) {
  picture.show(frame);
  picture.figure.classList.toggle("old", String(frame.version) !== native.canvas.dataset.version);
}

function listItem(text) {
  const item = document.createElement("li");
  item.textContent = text;
  return item;
}

// ---- The text -------------------------------------------------------------------------------------------------------

function send() {
  element("said").textContent = "";
  document.body.dataset.version = ""; // until the server has heard it
  if (!server.open) {
    offline = true;
    keep();
    return;
  }
  typed += 1;
  server.send({ type: "text", text: editor.text, number: typed });
}

// What the link in the notice gives: the text as it is now.
function keep() {
  const link = element("download");
  if (link.href) URL.revokeObjectURL(link.href);
  link.href = URL.createObjectURL(new Blob([editor.text], { type: "text/plain" }));
  link.download = element("file").textContent || "scene.in";
}

const editor = makeEditor({
  parent: element("editor"),
  onChange: send,
  onCursor() {
    if (!sliding) server.send({ type: "cursor", at: editor.cursor });
  },
  onNudge(steps) {
    if (number) slideTo(Number(number.word) + steps * number.step);
    return true;
  },
});

function slideTo(value) {
  const word = Math.min(Math.max(value, number.low), number.high).toFixed(number.decimals);
  if (editor.slice(number.start, number.end) !== number.word) return; // somebody has changed it
  const { start, end } = number;
  number = { ...number, word, value, end: start + word.length };
  editor.replace(start, end, word);
  element("number-value").textContent = word;
}

element("slider").addEventListener("input", () => {
  sliding = true;
  slideTo(Number(element("slider").value));
});
element("slider").addEventListener("change", () => {
  sliding = false;
  server.send({ type: "cursor", at: editor.cursor });
});

element("save").addEventListener("click", () => server.send({ type: "save", over: elsewhere }));
element("load").addEventListener("click", () => server.send({ type: "load" }));

// ---- The pictures ---------------------------------------------------------------------------------------------------

watchMouse(native, {
  onPixel: (x, y) => server.send({ type: "pixel", x, y }),
  onDrag: (x, y, first) => server.send({ type: "turn", x, y, first }),
});

function toggleMitsuba() {
  const on = element("mitsuba").getAttribute("aria-pressed") !== "true";
  element("mitsuba").setAttribute("aria-pressed", on);
  mitsuba.figure.hidden = difference.figure.hidden = !on;
  element("pictures").classList.toggle("several", on);
  server.send({ type: "mitsuba", on });
}

element("mitsuba").addEventListener("click", toggleMitsuba);

element("theirs").addEventListener("change", async ({ target }) => {
  const [file] = target.files;
  target.value = "";
  if (!file) return;
  const address = `picture?${new URLSearchParams({ page, name: file.name })}`;
  const answer = await fetch(address, { method: "POST", body: file }).catch(() => null);
  if (!answer?.ok) {
    element("said").textContent = answer ? await answer.text() : "The picture could not be sent.";
    return;
  }
  const picture = unframed(await answer.arrayBuffer());
  paint(element("over"), picture);
  element("laid-name").textContent = `${picture.name}, ${picture.width} x ${picture.height}`;
  layOver(true);
  element("verdict").hidden = true;
});

function layOver(there) {
  element("over").hidden = element("laid").hidden = element("why").hidden = !there;
  element("over").style.opacity = element("opacity").value;
}

element("opacity").addEventListener("input", () => layOver(true));
element("take-off").addEventListener("click", () => layOver(false));
element("why").addEventListener("click", () => {
  element("why").disabled = true;
  server.send({ type: "why" });
});

document.addEventListener("keydown", (event) => {
  if ((event.ctrlKey || event.metaKey) && event.key === "s") {
    event.preventDefault();
    server.send({ type: "save", over: false });
  } else if (event.altKey && event.key.toLowerCase() === "m") {
    event.preventDefault();
    toggleMitsuba();
  } else if (event.key === "Escape") {
    server.send({ type: "pixel", x: -1, y: -1 });
  }
});

addEventListener("beforeunload", (event) => {
  if (!server.open && offline) event.preventDefault();
});

editor.focus();
