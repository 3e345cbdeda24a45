// The text: CodeMirror, with mistakes underlined.

import {
  Annotation, Decoration, EditorState, EditorView, Prec, StateEffect, StateField, Transaction, basicSetup, hoverTooltip,
  keymap,
} from "../editor/index.js";

const theirs = Annotation.define(); // a change that did not begin here
const setMarks = StateEffect.define();

const marks = StateField.define({
  create: () => Decoration.none,
  update(underlined, transaction) {
    underlined = underlined.map(transaction.changes);
    for (const effect of transaction.effects) if (effect.is(setMarks)) underlined = effect.value;
    return underlined;
  },
  provide: (field) => EditorView.decorations.from(field),
});

const sentences = hoverTooltip((view, at) => {
  let found = null;
  view.state.field(marks).between(at, at, (from, to, mark) => {
    found = { from, to, message: mark.spec.message };
    return false;
  });
  return found && {
    pos: found.from,
    end: found.to,
    create() {
      const dom = document.createElement("div");
      dom.className = "told";
      dom.textContent = found.message;
      return { dom };
    },
  };
});

export function makeEditor({ parent, onChange, onCursor, onNudge }) {
  const view = new EditorView({
    parent,
    state: EditorState.create({
      extensions: [
        Prec.highest(keymap.of([
          { key: "Ctrl-ArrowUp", run: () => onNudge(1) },
          { key: "Ctrl-ArrowDown", run: () => onNudge(-1) },
        ])),
        basicSetup,
        EditorView.lineWrapping,
        marks,
        sentences,
        EditorView.contentAttributes.of({ "aria-label": "The scene's text" }),
        EditorView.updateListener.of((update) => {
          const ours = update.transactions.some((change) => change.docChanged && !change.annotation(theirs));
          if (ours) onChange();
          if (update.docChanged || update.selectionSet) onCursor();
        }),
      ],
    }),
  });

  function change(from, to, insert, annotations) {
    view.dispatch({ changes: { from, to, insert }, annotations });
  }

  return {
    get text() {
      return view.state.doc.toString();
    },
    get cursor() {
      return view.state.selection.main.head;
    },
    slice: (from, to) => view.state.sliceDoc(from, to),
    // A change that is this page's own.
    replace: (from, to, insert) => change(from, to, insert),
    // Take over a text, by the least change, so that the cursor stays where it is; `undone` where Ctrl-Z may undo it.
    adopt(text, undone) {
      const old = view.state.doc.toString();
      if (old === text) return;
      let from = 0;
      while (from < old.length && from < text.length && old[from] === text[from]) from++;
      let same = 0;
      const most = Math.min(old.length, text.length) - from;
      while (same < most && old[old.length - 1 - same] === text[text.length - 1 - same]) same++;
      const annotations = [theirs.of(true), Transaction.addToHistory.of(undone)];
      change(from, old.length - same, text.slice(from, text.length - same), annotations);
    },
    underline(mistakes) {
      const length = view.state.doc.length;
      const ranges = mistakes
        .filter(({ start, end }) => start < end && end <= length)
        .map(({ start, end, message }) => Decoration.mark({ class: "mistake", message }).range(start, end));
      view.dispatch({ effects: setMarks.of(Decoration.set(ranges, true)) });
    },
    goTo(at) {
      const anchor = Math.min(at, view.state.doc.length);
      view.dispatch({ selection: { anchor }, scrollIntoView: true });
      view.focus();
    },
    focus: () => view.focus(),
  };
}
