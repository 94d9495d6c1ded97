// The solids of the page of `camgeo report`; pages without one are spared this script.

import type { Body } from "./data";
import { singles, Solid } from "./solid";
import { WORDS } from "./words";

const { solids } = JSON.parse(document.getElementById("data")!.textContent) as { solids: Body[] };
solids.forEach(({ places }, k) => {
  const holder = document.getElementById(`solid-${k}`)!;
  const canvas = holder.querySelector("canvas")!;
  const solid = Solid.on(canvas);
  if (!solid) {
    canvas.replaceWith(WORDS.noWebGL);
    return;
  }
  solid.show(singles(places));
  for (const button of holder.querySelectorAll("button")) {
    button.addEventListener("click", () => solid.go(button.value));
  }
});
