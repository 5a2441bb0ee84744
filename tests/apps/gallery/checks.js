// Runs within the gallery's own page; what it finds goes into <pre id="checks">.
"use strict";
(async () => {
  const lines = [];
  const check = (holds, what) => lines.push(`${holds ? "ok" : "FAILED"}: ${what}`);
  const later = (time) => new Promise((done) => setTimeout(done, time));
  const view = document.getElementById("view");
  const all = () => [...document.querySelectorAll(".card")];
  const pictures = () => performance.getEntriesByType("resource").filter((entry) => entry.name.endsWith("thumbnail.png")).length;
  const choose = async (id, value) => {
    const element = document.getElementById(id);
    if (element.type === "checkbox") element.checked = value;
    else element.value = value;
    element.dispatchEvent(new Event("input"));
    await later(20);
  };
  const count = () => document.getElementById("count").textContent;
  try {
    performance.setResourceTimingBufferSize(20000);
    await later(500);
    check(count() === "10000 of 10000", count());
    check(all().length > 5 && all().length < 60, `${all().length} cards exist of 10000`);
    check(all().filter((card) => card.querySelector("img")).every((card) => card.querySelector("img").naturalWidth > 0),
      "the pictures in view are loaded");
    check(pictures() < 100, `${pictures()} pictures are loaded at first`);

    let longest = 0;
    for (let step = 0; step <= 100; ++step) {
      view.scrollTop = (view.scrollHeight - view.clientHeight) * step / 100;
      const begin = performance.now();
      draw();
      longest = Math.max(longest, performance.now() - begin);
      await later(5);
    }
    check(longest < 50, `the longest of 100 jumps through all took ${longest.toFixed(1)} ms`);
    check(all().length < 60, `${all().length} cards exist after scrolling`);
    check(all().some((card) => card.textContent.includes("m10000")), "the last item is there at the end");
    check(pictures() < 6000, `${pictures()} pictures were loaded by 100 jumps`);

    await choose("group", "Oh");
    check(count() === "2000 of 10000", `group: ${count()}`);
    await choose("group", "");
    await choose("status", "crash");
    check(count() === "100 of 10000", `status: ${count()}`);
    check(!document.querySelector(".card b") && all()[0].textContent.includes("<b>Segmentation"), "messages are text");
    await choose("status", "");
    await choose("least", "1000");
    await choose("most", "2000");
    check(count() === "11 of 10000", `size: ${count()}`);
    await choose("least", "");
    await choose("most", "");
    await choose("text", "m0123");
    check(count() === "10 of 10000", `id: ${count()}`);
    all()[0].click();
    check(document.getElementById("details").open && document.getElementById("details").textContent.includes("m01230"),
      "a click shows the details");
  } catch (error) {
    lines.push(`FAILED: ${error}`);
  }
  const result = document.createElement("pre");
  result.id = "checks";
  result.textContent = lines.join("\n");
  document.body.append(result);
})();
