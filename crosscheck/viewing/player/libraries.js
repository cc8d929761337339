// Runs the libraries of the page, which are compressed; the policy of the page knows their hash.
"use strict";

function expanded(text) {
  const bytes = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip")));
}

async function runLibraries() {
  const script = document.createElement("script");
  script.textContent = await expanded(document.getElementById("libraries").textContent).text();
  document.head.append(script);
}
