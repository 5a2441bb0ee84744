#pragma once

#include <string_view>

namespace orbifit::batch {

/// The gallery: shows what items.js holds. Only the cards in view exist, so that 10 000 scroll as 20 do.
inline constexpr std::string_view kGalleryPage = R"PAGE(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Orbifit: collection</title>
<style>
:root { color-scheme: light; font: 14px/1.4 system-ui, sans-serif; color: #1c2126; }
body { margin: 0; height: 100vh; display: flex; flex-direction: column; background: #f4f5f6; }
header { display: flex; flex-wrap: wrap; gap: .5rem 1rem; align-items: center; padding: .6rem 1rem; background: #fff; border-bottom: 1px solid #d5d9dd; }
h1 { font-size: 1rem; margin: 0; }
label { display: flex; gap: .35rem; align-items: center; }
select, input { font: inherit; padding: .15rem .3rem; }
#count { margin-left: auto; font-variant-numeric: tabular-nums; }
#view { flex: 1; overflow-y: auto; position: relative; }
#cards { position: relative; margin: 0; padding: 0; }
.card { position: absolute; box-sizing: border-box; width: 200px; height: 206px; padding: 4px; border: 1px solid #d5d9dd; border-radius: 6px; background: #fff; text-align: left; font: inherit; cursor: pointer; overflow: hidden; }
.card:focus-visible { outline: 3px solid #1a66c2; }
.card img, .none { display: block; width: 190px; height: 142px; object-fit: contain; background: #fff; }
.none { display: grid; place-items: center; color: #5b6670; background: #eceef0; }
.id { white-space: nowrap; overflow: hidden; text-overflow: ellipsis; font-weight: 600; }
.more { white-space: nowrap; overflow: hidden; text-overflow: ellipsis; color: #46505a; font-size: 12px; }
.bad .more { color: #a3231b; }
dialog { max-width: min(44rem, 90vw); border: 1px solid #b9c0c7; border-radius: 8px; }
dialog img { width: 384px; max-width: 100%; display: block; }
dt { font-weight: 600; } dd { margin: 0 0 .4rem; overflow-wrap: anywhere; }
</style>
</head>
<body>
<header>
<h1>Collection</h1>
<label>Id <input id="text" type="search" placeholder="contains"></label>
<label>Group <select id="group"></select></label>
<label>Status <select id="status"></select></label>
<label>Vertices <input id="least" type="number" min="0" placeholder="least" style="width:6em"> to <input id="most" type="number" min="0" placeholder="most" style="width:6em"></label>
<label><input id="once" type="checkbox"> same shapes once</label>
<span id="count" role="status"></span>
</header>
<div id="view" tabindex="-1"><div id="cards"></div></div>
<dialog id="details"><form method="dialog"><button autofocus>Close</button></form><div id="inside"></div></dialog>
<script src="items.js"></script>
<script>
"use strict";
const ID = 0, STATUS = 1, MESSAGE = 2, SECONDS = 3, VERTICES = 4, GROUPS = 5, PATTERNS = 6, PICTURE = 7, RESULT = 8, SAME_FILE = 9, SAME_SHAPE = 10;
const items = window.orbifitItems, WIDTH = 208, HEIGHT = 214, GAP = 8;
const byId = id => document.getElementById(id);
const view = byId("view"), cards = byId("cards");
let chosen = items.map((_, i) => i);
const live = new Map();  // place among the chosen -> card
const spare = [];

function options(select, names, counts) {
  select.append(new Option("all", ""));
  for (const name of names) select.append(new Option(`${name} (${counts.get(name)})`, name));
}
function countBy(keysOf) {
  const counts = new Map();
  for (const item of items) for (const key of keysOf(item)) counts.set(key, (counts.get(key) || 0) + 1);
  return counts;
}
const groups = countBy(item => item[GROUPS]), statuses = countBy(item => [item[STATUS]]);
options(byId("group"), [...groups.keys()].sort((a, b) => groups.get(b) - groups.get(a) || (a < b ? -1 : 1)), groups);
options(byId("status"), [...statuses.keys()].sort(), statuses);

function filter() {
  const text = byId("text").value.toLowerCase(), group = byId("group").value, status = byId("status").value;
  const least = byId("least").value === "" ? 0 : +byId("least").value;
  const most = byId("most").value === "" ? Infinity : +byId("most").value, once = byId("once").checked;
  chosen = [];
  items.forEach((item, i) => {
    if (text && !item[ID].toLowerCase().includes(text)) return;
    if (group && !item[GROUPS].includes(group)) return;
    if (status && item[STATUS] !== status) return;
    if (item[VERTICES] < least || item[VERTICES] > most) return;
    if (once && item[SAME_SHAPE] !== i) return;
    chosen.push(i);
  });
  byId("count").textContent = `${chosen.length} of ${items.length}`;
  for (const card of live.values()) release(card);
  live.clear();
  view.scrollTop = 0;
  draw();
}

function release(card) {
  card.remove();
  card.replaceChildren();
  spare.push(card);
}

function line(name, text) {
  const element = document.createElement("div");
  element.className = name;
  element.textContent = text;
  return element;
}

function show(card, item) {
  const good = item[STATUS] === "ok" || item[STATUS] === "no_symmetry";
  card.className = good ? "card" : "card bad";
  card.setAttribute("aria-label", `${item[ID]}: ${item[STATUS]}`);
  let picture = line("none", item[STATUS]);
  if (item[PICTURE]) {
    picture = document.createElement("img");
    picture.alt = "";
    picture.decoding = "async";
    picture.src = item[PICTURE];
  }
  const same = item[SAME_SHAPE] === undefined ? "" : items[item[SAME_SHAPE]] === item ? "" : " = another";
  card.replaceChildren(picture, line("id", item[ID]), line("more", good ? `${item[GROUPS].slice(0, 5).join(" ") || item[STATUS]}` : `${item[STATUS]}: ${item[MESSAGE]}`),
    line("more", `${item[VERTICES]} vertices, ${item[SECONDS]} s${same}`));
}

function draw() {
  const columns = Math.max(1, Math.floor((view.clientWidth - GAP) / WIDTH));
  cards.style.height = `${Math.ceil(chosen.length / columns) * HEIGHT + GAP}px`;
  // One row more at each end, which is loaded before it is seen.
  const first = Math.max(0, Math.floor(view.scrollTop / HEIGHT) - 1) * columns;
  const end = Math.min(chosen.length, (Math.ceil((view.scrollTop + view.clientHeight) / HEIGHT) + 1) * columns);
  for (const [place, card] of live) if (place < first || place >= end) { release(card); live.delete(place); }
  for (let place = first; place < end; ++place) {
    let card = live.get(place);
    if (!card) {
      card = spare.pop() || document.createElement("button");
      show(card, items[chosen[place]]);
      card.onclick = () => details(items[chosen[place]]);
      live.set(place, card);
      cards.append(card);
    }
    card.style.left = `${GAP + (place % columns) * WIDTH}px`;
    card.style.top = `${GAP + Math.floor(place / columns) * HEIGHT}px`;
  }
}

function details(item) {
  const list = document.createElement("dl");
  const add = (name, ...what) => {
    const dt = document.createElement("dt"), dd = document.createElement("dd");
    dt.textContent = name;
    dd.append(...what);
    list.append(dt, dd);
  };
  add("Id", item[ID]);
  add("Status", item[STATUS] + (item[MESSAGE] ? `: ${item[MESSAGE]}` : ""));
  add("Vertices", String(item[VERTICES]));
  add("Groups", item[GROUPS].join(", ") || "none");
  add("Patterns", String(item[PATTERNS]));
  if (items[item[SAME_FILE]] !== item) add("Same file as", items[item[SAME_FILE]][ID]);
  else if (items[item[SAME_SHAPE]] !== item) add("Same shape as", items[item[SAME_SHAPE]][ID]);
  if (item[RESULT]) {
    const link = document.createElement("a");
    link.href = item[RESULT];
    link.textContent = "result";
    add("File", link);
  }
  const inside = byId("inside");
  inside.replaceChildren(list);
  if (item[PICTURE]) {
    const picture = document.createElement("img");
    picture.src = item[PICTURE];
    picture.alt = item[ID];
    inside.prepend(picture);
  }
  byId("details").showModal();
}

let drawing = false;
function later() {
  if (drawing) return;
  drawing = true;
  requestAnimationFrame(() => { drawing = false; draw(); });
}
view.addEventListener("scroll", later, { passive: true });
addEventListener("resize", later);
for (const id of ["text", "group", "status", "least", "most", "once"]) byId(id).addEventListener("input", filter);
filter();
</script>
</body>
</html>
)PAGE";

}  // namespace orbifit::batch
