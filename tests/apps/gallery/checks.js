// Runs within the gallery's own page; what it finds goes into <pre id="checks">.
"use strict";
(async () => {
  const lines = [];
  const check = (holds, what) => lines.push(`${holds ? "ok" : "FAILED"}: ${what}`);
  const later = (time) => new Promise((done) => setTimeout(done, time));
  const view = document.getElementById("view");
  const all = () => [...document.querySelectorAll(".card")];
  // Pictures asked for: those that stand here already, and each that is made from now on.
  let made = document.querySelectorAll(".card img").length;
  const make = document.createElement;
  document.createElement = function (name) {
    if (name === "img") ++made;
    return make.call(document, name);
  };
  const choose = async (id, value) => {
    const element = document.getElementById(id);
    if (element.type === "checkbox") element.checked = value;
    else element.value = value;
    element.dispatchEvent(new Event("input"));
    await later(20);
  };
  const count = () => document.getElementById("count").textContent;
  try {
    await later(500);
    check(count() === "10000 of 10000", count());
    check(all().length > 5 && all().length < 60, `${all().length} cards exist of 10000`);
    check(all().filter((card) => card.querySelector("img")).every((card) => card.querySelector("img").naturalWidth > 0),
      "the pictures in view are loaded");
    check(made > 0 && made < 60, `${made} pictures are asked for at first`);

    // What a frame costs is what it makes; the browser's clock stands still in such a test.
    let most = 0;
    for (let step = 0; step <= 100; ++step) {
      const before = made;
      view.scrollTop = (view.scrollHeight - view.clientHeight) * step / 100;
      draw();
      most = Math.max(most, made - before);
      await later(5);
    }
    check(most > 0 && most < 60, `a jump asks for ${most} pictures at most`);
    check(all().length < 60, `${all().length} cards exist after scrolling`);
    check(all().some((card) => card.textContent.includes("m10000")), "the last item is there at the end");

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
