// What every page does with script: copy buttons, a line above the tables that can be scrolled sideways, and
// opening what a link leads to, or what is closed and compressed.
"use strict";
function offerCopies() {
  for (const button of document.querySelectorAll(".copyable button[hidden]")) {
    if (!navigator.clipboard) continue;
    button.hidden = false;
    button.addEventListener("click", async () => {
      await navigator.clipboard.writeText(button.parentElement.querySelector("pre").textContent);
      button.textContent = "copied";
    });
  }
}
function tellScrolling() {
  for (const box of document.querySelectorAll(".scroll, pre")) {
    const scrolls = box.scrollWidth > box.clientWidth + 1;
    box.tabIndex = scrolls ? 0 : -1;  // what scrolls can be reached and moved by keys
    if (!box.matches(".scroll:has(table)")) continue;
    const told = box.previousElementSibling?.classList.contains("more");
    box.classList.toggle("scrolls", scrolls);
    if (scrolls && !told) {
      const line = document.createElement("p");
      line.className = "more";
      line.textContent = "The table goes on to the right: scroll it sideways.";
      box.before(line);
    } else if (!scrolls && told) {
      box.previousElementSibling.remove();
    }
  }
}
// What is large and closed is compressed until it is opened.
async function unpack(details) {
  const part = details.open && details.querySelector(":scope > [data-packed]");
  if (part) {
    const bytes = Uint8Array.from(atob(part.dataset.packed), (character) => character.charCodeAt(0));
    delete part.dataset.packed;
    part.innerHTML = await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
    part.dispatchEvent(new Event("unpacked", { bubbles: true }));
    offerCopies();
  }
  tellScrolling();
}
addEventListener("resize", tellScrolling);
document.addEventListener("toggle", (event) => unpack(event.target), true);
offerCopies();
tellScrolling();
function openTarget() {
  const target = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
  if (!target) return;
  const inside = target.querySelector(":scope > details");
  for (let place = inside ?? target; place; place = place.parentElement) if (place.tagName === "DETAILS") place.open = true;
  target.scrollIntoView();
}
addEventListener("hashchange", openTarget);
openTarget();
// Paper has no pointer: tables and notes that are folded are printed, long code is not.
let folded = [];
addEventListener("beforeprint", () => {
  folded = [...document.querySelectorAll("details:not([open])")].filter((one) => one.querySelector("table, li") || one.matches(".long-note"));
  for (const one of folded) one.open = true;
});
addEventListener("afterprint", () => { for (const one of folded) one.open = false; });
