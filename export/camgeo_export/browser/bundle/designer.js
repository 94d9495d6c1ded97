/* Made by build.mjs from:
build.mjs
package-lock.json
package.json
src/designer/main.ts
tsconfig.json
sources a72207fe1236829bcfb569f109954d328ee3f5673848addedda4f10f09ecf4fa
bundle a0a9ab63e88e9ebf1ab0dd1a15cf4b51a02a76ea3c0d0b38c2b2c0324bfb3630
*/
"use strict";(()=>{document.documentElement.dataset.ready="true";})();
