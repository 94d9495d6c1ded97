/* Made by build.mjs from:
build.mjs
package-lock.json
package.json
src/designer/main.ts
tsconfig.json
sources 67a6bba816acfddafc3d714f7cf7f3008ae4d7b5c2b9cb8eacd51bf878ddb2c5
bundle a0a9ab63e88e9ebf1ab0dd1a15cf4b51a02a76ea3c0d0b38c2b2c0324bfb3630
*/
"use strict";(()=>{document.documentElement.dataset.ready="true";})();
