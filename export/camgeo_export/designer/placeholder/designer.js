"use strict";
// What the server answers, as text; the page itself draws it.
const socket = new WebSocket(`ws://${location.host}/ws`);
const at = (id) => document.getElementById(id);
const send = (message) => socket.send(JSON.stringify(message));
socket.addEventListener("open", () => send({ kind: "hello" }));
socket.addEventListener("close", () => { at("state").textContent = "not connected"; });
socket.addEventListener("message", (event) => {
  const found = JSON.parse(event.data);
  if (found.text !== undefined && document.activeElement !== at("text")) at("text").value = found.text;
  if (found.kind === "state") at("state").textContent = `${found.file}: revision ${found.revision}, ${found.saved ? "saved" : "not saved"}`;
  at("last").textContent = `${found.kind}: ${event.data.length} characters`;
});
at("text").addEventListener("input", () => send({ kind: "text", text: at("text").value, gesture: "typing" }));
for (const name of ["undo", "redo", "save"]) at(name).addEventListener("click", () => send({ kind: name }));
