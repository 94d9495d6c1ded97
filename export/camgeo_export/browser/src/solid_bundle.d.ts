// What bundle/solid.js gives to the other scripts of its page. three.js is most of it, so that only
// pages that show a solid load it.

import type * as solid from "./solid";

declare global {
  const camgeoSolid: typeof solid;
}
