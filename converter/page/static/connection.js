// The WebSocket, and what to do when it is gone: try again, for the server may only have slept.

const AGAIN = 1000; // milliseconds

export function connect({ onMessage, onOpen, onGone }) {
  let socket;

  function open() {
    socket = new WebSocket(new URL("live", location.href.replace(/^http/, "ws")));
    socket.binaryType = "arraybuffer";
    socket.onopen = onOpen;
    socket.onmessage = ({ data }) => onMessage(typeof data === "string" ? JSON.parse(data) : unframed(data));
    socket.onclose = () => {
      onGone();
      setTimeout(open, AGAIN);
    };
  }

  open();
  return {
    get open() {
      return socket.readyState === WebSocket.OPEN;
    },
    send(message) {
      if (socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
    },
  };
}

// What converter/page/pictures.py frames: told about the picture, and its levels.
export function unframed(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const told = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  return { ...told, levels: new Uint8Array(buffer, 4 + length) };
}
