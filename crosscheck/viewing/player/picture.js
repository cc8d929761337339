// The view as a picture to be saved, with the names and the legend that lie over it.
"use strict";

function pictureOf(stage) {
  stage.draw();
  const drawn = stage.renderer.domElement, here = stage.element.getBoundingClientRect();
  const canvas = html("canvas", { width: drawn.width, height: drawn.height }), brush = canvas.getContext("2d");
  brush.drawImage(drawn, 0, 0);  // at once: the browser does not keep what is drawn
  brush.scale(drawn.width / here.width, drawn.height / here.height);
  brush.textBaseline = "middle";
  for (const element of stage.element.querySelectorAll("#labels span:not([hidden]), #legend i, #legend b, #legend span")) {
    const style = getComputedStyle(element), { left, top, width, height } = element.getBoundingClientRect();
    const [x, y] = [left - here.left, top - here.top];
    if (element.tagName === "I") {
      brush.fillStyle = style.color === css("--ink") ? style.borderTopColor : style.backgroundColor === "rgba(0, 0, 0, 0)" ? style.borderTopColor : style.backgroundColor;
      brush.fillRect(x, y + height / 2 - 2, width, 4);
    } else {
      brush.fillStyle = style.color;
      brush.font = `${style.fontWeight} ${style.fontSize} system-ui, sans-serif`;
      brush.fillText(element.textContent, x + parseFloat(style.paddingLeft), y + height / 2);
    }
  }
  return canvas;
}

function savePicture(stage, name) {
  pictureOf(stage).toBlob((blob) => {
    const link = html("a", { href: URL.createObjectURL(blob), download: `${name}.png` });
    link.click();
    URL.revokeObjectURL(link.href);
  });
}
