// A picture on a canvas, a pixel's path over it, and what the mouse does there.

const DRAG = 4; // pixels of the screen that the mouse goes before a click is none

export function makePicture(figure) {
  const canvas = figure.querySelector("canvas");
  const caption = figure.querySelector("figcaption");
  return {
    canvas,
    figure,
    resize(width, height) {
      canvas.width = width;
      canvas.height = height;
    },
    show(frame) {
      paint(canvas, frame);
      canvas.dataset.version = frame.version;
      canvas.dataset.whole = frame.whole ?? true;
      figure.classList.remove("old");
    },
    tell(text) {
      caption.textContent = text;
    },
  };
}

// A picture of any size over all of a canvas; its pixels stay squares with sharp edges.
export function paint(canvas, { width, height, levels }) {
  const image = new ImageData(width, height);
  const pixels = image.data;
  for (let from = 0, to = 0; to < pixels.length; from += 3, to += 4) {
    pixels[to] = levels[from];
    pixels[to + 1] = levels[from + 1];
    pixels[to + 2] = levels[from + 2];
    pixels[to + 3] = 255;
  }
  const context = canvas.getContext("2d");
  if (width === canvas.width && height === canvas.height) {
    context.putImageData(image, 0, 0);
    return;
  }
  const given = new OffscreenCanvas(width, height);
  given.getContext("2d").putImageData(image, 0, 0);
  context.imageSmoothingEnabled = false;
  context.drawImage(given, 0, 0, canvas.width, canvas.height);
}

// The path of a pixel's rays, and the pixel: null shows none.
export function drawPath(svg, canvas, found) {
  svg.setAttribute("viewBox", `0 0 ${canvas.width} ${canvas.height}`);
  svg.replaceChildren();
  if (!found) return;
  const add = (name, attributes) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    svg.append(element);
  };
  for (const { kind, depth, x0, y0, x1, y1 } of found.path) {
    add("line", { class: kind, x1: x0, y1: y0, x2: x1, y2: y1, opacity: Math.max(0.25, 1 - 0.15 * (depth - 1)) });
  }
  for (const name of ["light", "dark"]) add("circle", { class: name, cx: found.x + 0.5, cy: found.y + 0.5, r: 4 });
}

// A click tells its pixel; a drag how far it is from where it began, in pictures.
export function watchMouse(picture, { onPixel, onDrag }) {
  const area = picture.canvas.parentElement;
  let began = null;

  area.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    began = { x: event.clientX, y: event.clientY, dragging: false };
    area.setPointerCapture(event.pointerId);
  });
  area.addEventListener("pointermove", (event) => {
    if (!began) return;
    const [dx, dy] = [event.clientX - began.x, event.clientY - began.y];
    if (!began.dragging && Math.hypot(dx, dy) < DRAG) return;
    const box = picture.canvas.getBoundingClientRect();
    onDrag(dx / box.width, dy / box.width, !began.dragging);
    began.dragging = true;
  });
  area.addEventListener("pointerup", (event) => {
    if (began && !began.dragging) {
      const box = picture.canvas.getBoundingClientRect();
      const x = Math.floor(((event.clientX - box.left) / box.width) * picture.canvas.width);
      const y = Math.floor(((event.clientY - box.top) / box.height) * picture.canvas.height);
      onPixel(x, y);
    }
    began = null;
  });
  area.addEventListener("pointercancel", () => {
    began = null;
  });
}
