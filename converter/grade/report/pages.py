"""The report as pages that need no server: one of the class, and one for each program, all in itself.

Nothing in a page comes from elsewhere, and its policy lets nothing: what programs say, and what their files are called,
is text and no markup.
"""

import base64
import hashlib
from collections.abc import Mapping
from html import escape
from pathlib import Path

from converter.grade.grades import Cell, Grades, Row
from converter.grade.judge import mistakes
from converter.grade.report import images
from converter.why.picture import Picture, read_theirs

STUDENTS = "students"
"""Folder of the pages of programs."""
KINDS = {
    "right": "right",
    "forgiven": "only mistakes that cost nothing here",
    "mistakes": "mistakes with a name",
    "unexplained": "wrong, and no known mistake explains it",
    "none": "no picture",
}
_CAUSES_IN_CELL = 2


def class_page(grades: Grades, references: Mapping[str, Picture], report: Path) -> str:
    """The page of the class: a row a program, a column a scene; then mistakes, then scenes."""
    backgrounds = "".join(
        f".s{k}{{background-image:url({images.small(references[scene])})}}" for k, scene in enumerate(grades.tasks)
    )
    body = [
        f"<h1>{len(grades.rows)} programs, {len(grades.tasks)} scenes</h1>",
        _conditions(grades),
        "<p>Hold <kbd>R</kbd> to see the right pictures in place of theirs. A column's head sorts by it.</p>",
        _legend(),
        _class_table(grades, report),
        "<h2>Mistakes</h2>",
        _mistakes_table(grades),
        "<h2>Scenes</h2>",
        _scenes_table(grades),
    ]
    return _page("Report", "\n".join(body), backgrounds)


def student_page(row: Row, grades: Grades, references: Mapping[str, Picture], report: Path) -> str:
    """The page of one program: what was found, and where to look."""
    known = mistakes()
    body = [f"<h1>{escape(row.name)}: {_points(row.points)} of {_points(grades.most)} points</h1>", _conditions(grades)]
    features = "".join(
        f"<tr><td>{escape(feature)}</td><td class=n>{_points(sum(row.cells[s].mark.points for s in scenes))}</td>"
        f"<td class=n>{_points(sum(row.cells[s].mark.most for s in scenes))}</td></tr>"
        for feature, scenes in grades.features.items()
    )
    body.append(f"<table><tr><th>feature</th><th>points</th><th>of</th></tr>{features}</table>")
    if row.mistakes:
        items = "".join(
            f"<li><b>{escape(_capital(known[name].sentence))}.</b> Look at {escape(known[name].hint)}. "
            f"<span class=pale>{escape(', '.join(scenes))}</span></li>"
            for name, scenes in row.mistakes.items()
        )
        body.append(f"<h2>Mistakes</h2><ol>{items}</ol>")
    body.append("<h2>Pictures</h2><p>Hold <kbd>R</kbd> to see the right picture in place of yours.</p>")
    body += [_section(scene, cell, grades, references[scene], report) for scene, cell in row.cells.items()]
    return _page(row.name, "\n".join(body))


# ---- The class -------------------------------------------------------------------------------------------------------


def _class_table(grades: Grades, report: Path) -> str:
    heads = "".join(
        f"<th title='{escape(grades.rubric.feature(scene))}'><span class='shot s{k}'></span>{escape(scene)}</th>"
        for k, scene in enumerate(grades.tasks)
    )
    rows = "".join(_class_row(row, grades, report) for row in grades.rows)
    head = f"<tr><th>program</th><th>points of {_points(grades.most)}</th><th>seconds</th>{heads}</tr>"
    return f"<div class=wide><table class='class sortable'><thead>{head}</thead><tbody>{rows}</tbody></table></div>"


def _class_row(row: Row, grades: Grades, report: Path) -> str:
    page = f"{STUDENTS}/{escape(row.name)}.html"
    cells = []
    for k, (scene, cell) in enumerate(row.cells.items()):
        causes = () if cell.verdict is None else cell.verdict.causes
        told = ", ".join(cause.replace("_", " ") for cause in causes[:_CAUSES_IN_CELL])
        told += ", ..." if len(causes) > _CAUSES_IN_CELL else ""
        short = told or {"right": "", "none": cell.attempt.trouble}.get(cell.kind, _percent(cell))
        theirs = ""
        if cell.attempt.picture is not None and cell.kind != "right":
            theirs = f"<img alt='' src='{images.small(read_theirs(report / cell.attempt.picture).levels)}'>"
        empty = " empty" if cell.attempt.picture is None else ""
        cells.append(
            f"<td class='{cell.kind}' data-v='{cell.mark.points:.4f}' title='{escape(cell.sentence)}'>"
            f"<a href='{page}#{escape(scene)}'><span class='shot s{k}{empty}'>{theirs}</span>"
            f"<b>{_points(cell.mark.points)}</b> <small>{escape(short[:70])}</small></a></td>"
        )
    return (
        f"<tr><th data-v='{escape(row.name)}'><a href='{page}'>{escape(row.name)}</a></th>"
        f"<td class=n data-v='{row.points:.4f}'>{_points(row.points)}</td>"
        f"<td class=n data-v='{row.clock:.3f}'>{row.clock:.1f}</td>{''.join(cells)}</tr>"
    )


def _mistakes_table(grades: Grades) -> str:
    rows = "".join(
        f"<tr><td class=n>{len(who)}</td><td>{escape(_capital(mistake.sentence))}<br><small>{escape(mistake.name)}, "
        f"{escape(mistake.part)}: look at {escape(mistake.hint)}</small></td><td>{_who(who)}</td></tr>"
        for mistake, who in grades.mistakes()
    )
    if not rows:
        return "<p>None was found.</p>"
    return f"<table><tr><th>programs</th><th>mistake</th><th>who, in how many scenes</th></tr>{rows}</table>"


def _who(who: Mapping[str, list[str]]) -> str:
    return ", ".join(
        f"<a href='{STUDENTS}/{escape(name)}.html' title='{escape(', '.join(scenes))}'>{escape(name)}</a> {len(scenes)}"
        for name, scenes in who.items()
    )


def _scenes_table(grades: Grades) -> str:
    rows = []
    for k, scene in enumerate(grades.tasks):
        counts = {kind: sum(row.cells[scene].kind == kind for row in grades.rows) for kind in KINDS}
        median = grades.median_clock(scene)
        cells = "".join(
            f"<td class='{f'n {kind}' if count else 'n'}'>{count or ''}</td>" for kind, count in counts.items()
        )
        rows.append(
            f"<tr><td><span class='shot s{k}'></span></td><td>{escape(scene)}</td>"
            f"<td>{escape(grades.rubric.feature(scene))}</td>"
            f"<td class=n>{_points(grades.rubric.part(scene).points)}</td>{cells}"
            f"<td class=n>{'' if median is None else f'{median:.2f}'}</td>"
            f"<td class=n>{grades.reference[scene].clock:.2f}</td></tr>"
        )
    kinds = "".join(f"<th title='{escape(told)}'>{kind}</th>" for kind, told in KINDS.items())
    head = f"<tr><th></th><th>scene</th><th>feature</th><th>points</th>{kinds}"
    return f"<table class=scenes>{head}<th>class, s</th><th>reference, s</th></tr>{''.join(rows)}</table>"


# ---- One program -----------------------------------------------------------------------------------------------------


def _section(scene: str, cell: Cell, grades: Grades, right: Picture, report: Path) -> str:
    attempt, verdict = cell.attempt, cell.verdict
    figures = []
    if attempt.picture is not None:
        theirs = read_theirs(report / attempt.picture).levels
        figures.append(_figure("yours", images.whole(theirs), "theirs", images.whole(right)))
        if cell.kind != "right" and theirs.shape == right.shape:
            apart = images.difference(theirs, right, attempt.lossy)
            figures.append(_figure("what differs", images.whole(apart)))
    if cell.kind != "right":
        figures.append(_figure("right", images.whole(right)))
    lines = [f"<p>{escape(cell.sentence)}</p>"]
    if cell.mark.forgiven:
        lines.append(f"<p class=pale>Costs nothing here: {escape(', '.join(cell.mark.forgiven))}.</p>")
    if verdict is not None and verdict.places and not verdict.right:
        places = "; ".join(f"{100 * share:.0f} % on {o}: {m}" for o, m, share in verdict.places)
        lines.append(f"<p class=pale>The wrong pixels that are left: {escape(places)}.</p>")
    if verdict is not None and "name" in attempt.mistakes:
        lines.append(f"<p class=pale>{escape(_capital(attempt.trouble))}.</p>")
    if attempt.said.strip():
        lines.append(f"<details><summary>what it said</summary><pre>{escape(_printable(attempt.said))}</pre></details>")
    feature = grades.rubric.feature(scene)
    title = scene if feature == scene else f"{scene}: {feature}"
    return (
        f"<section class='{cell.kind}' id='{escape(scene)}'><h3>{escape(title)} "
        f"<span class=mark>{_points(cell.mark.points)} of {_points(cell.mark.most)}</span></h3>"
        f"<div class=figures>{''.join(figures)}</div>{''.join(lines)}"
        f"<p class=pale>{_times(scene, cell, grades)}</p></section>"
    )


def _figure(caption: str, source: str, kind: str = "", held: str = "") -> str:
    """A picture; one of that kind gives way to the one that is `held` while the key is."""
    other = f"<img class=held alt='' src='{held}'>" if held else ""
    return (
        f"<figure class='{kind}'><img alt='{caption}' src='{source}'>{other}<figcaption>{caption}</figcaption></figure>"
    )


def _times(scene: str, cell: Cell, grades: Grades) -> str:
    attempt, median = cell.attempt, grades.median_clock(scene)
    if not attempt.clock:
        return ""
    in_class = "" if median is None else f", the class in the middle {median:.2f} s"
    return (
        f"{attempt.clock:.2f} s, {attempt.cpu:.2f} s of processor time, {attempt.memory} MiB; "
        f"the native tracer takes {grades.reference[scene].clock:.2f} s{in_class}."
    )


# ---- Pages -----------------------------------------------------------------------------------------------------------


def _conditions(grades: Grades) -> str:
    return f"<p class=conditions>{' '.join(map(escape, grades.conditions))}</p>"


def _legend() -> str:
    return "<p>" + " ".join(f"<span class='key {kind}'>{told}</span>" for kind, told in KINDS.items()) + "</p>"


def _percent(cell: Cell) -> str:
    return "" if cell.verdict is None else f"{100 * cell.verdict.wrong:.1f} % wrong"


def _points(points: float) -> str:
    return f"{round(points, 2):g}"


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _printable(text: str) -> str:
    return "".join(c if c.isprintable() or c in "\n\t" else "?" for c in text)


def _page(title: str, body: str, style: str = "") -> str:
    policy = f"default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'sha256-{_digest(_SCRIPT)}'"
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">'
        f'<meta name="viewport" content="width=device-width"><title>{escape(title)}</title>'
        f"<style>{_STYLE}{style}</style></head>\n<body>{body}\n<script>{_SCRIPT}</script></body></html>\n"
    )


def _digest(script: str) -> str:
    return base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()


_STYLE = """
:root{color-scheme:light dark;--right:#2a9d4a;--forgiven:#3a86c8;--mistakes:#e09f1f;--unexplained:#d1373a;--none:#777}
body{font:15px/1.45 system-ui,sans-serif;margin:1.5rem;max-width:100rem}
h1{font-size:1.5rem}h2{font-size:1.2rem;margin-top:2rem}h3{font-size:1rem;margin:.2rem 0 .6rem}
a{color:inherit}.pale,.conditions,small{opacity:.75}
kbd{border:1px solid;border-radius:3px;padding:0 .3em}
table{border-collapse:collapse}
td,th{padding:.25rem .5rem;text-align:left;vertical-align:top;border-bottom:1px solid #8884}
td.n{text-align:right;font-variant-numeric:tabular-nums}
.wide{overflow:auto;max-height:90vh}
.class thead th{position:sticky;top:0;background:Canvas;z-index:2;cursor:pointer}
.class tbody th{position:sticky;left:0;background:Canvas;z-index:1}
.class td a{text-decoration:none;display:block;width:96px}
.class td small{display:block;font-size:11px;line-height:1.25;overflow-wrap:anywhere}
.class td:not(.n){border-top:4px solid var(--kind);padding-top:0;padding-left:0}
.shot{display:block;width:96px;height:72px;background-size:contain;background-repeat:no-repeat;overflow:hidden}
.shot img{width:96px;height:72px;object-fit:contain;background:Canvas;display:block}
.shot.empty{background-image:none;background-color:#8883}
.reference .shot img{visibility:hidden}
.right{--kind:var(--right)}.forgiven{--kind:var(--forgiven)}.mistakes{--kind:var(--mistakes)}
.unexplained{--kind:var(--unexplained)}.none{--kind:var(--none)}
.key{padding:.1em .5em;border-left:.6em solid var(--kind);margin-right:.6em}
.scenes td[class~=n][class*=' ']{border-bottom:3px solid var(--kind)}
section{border-left:.4rem solid var(--kind);padding-left:1rem;margin:1.5rem 0}
.mark{font-weight:normal;opacity:.75}.figures{display:flex;flex-wrap:wrap;gap:1rem}
figure{margin:0;position:relative}figure img{max-width:min(100%,640px);display:block;image-rendering:pixelated}
figure .held{position:absolute;top:0;left:0;visibility:hidden}.reference figure .held{visibility:visible}
figcaption{font-size:13px;opacity:.75}pre{white-space:pre-wrap;background:#8882;padding:.5rem;max-height:20rem;overflow:auto}
"""
_SCRIPT = """
const hold = on => document.body.classList.toggle('reference', on);
addEventListener('keydown', e => { if (e.key === 'r' || e.key === 'R') hold(true); });
addEventListener('keyup', () => hold(false));
addEventListener('blur', () => hold(false));
for (const table of document.querySelectorAll('.sortable')) {
  table.tHead.addEventListener('click', e => {
    const head = e.target.closest('th'), k = head.cellIndex, body = table.tBodies[0];
    const up = head.dataset.up = head.dataset.up === '1' ? '' : '1';
    const value = row => row.cells[k].dataset.v;
    const order = (a, b) => k ? value(a) - value(b) : value(a).localeCompare(value(b));
    body.append(...[...body.rows].sort((a, b) => up ? order(a, b) : order(b, a)));
  });
}
"""
