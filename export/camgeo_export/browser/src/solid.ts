// A solid in three dimensions, by WebGL: triangles of its STL file, shaded, with its sharp edges.

import {
  AmbientLight,
  BufferGeometry,
  Color,
  DirectionalLight,
  EdgesGeometry,
  Float32BufferAttribute,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
  OrthographicCamera,
  Scene,
  Vector3,
  WebGLRenderer,
} from "three";
import { toCreasedNormals } from "three/examples/jsm/utils/BufferGeometryUtils.js";

const SHARP = Math.PI / 7; // the angle at which two triangles meet in an edge
const FIRST = { yaw: -30, pitch: 55, zoom: 1.25 }; // degrees
const [NEAREST, FARTHEST] = [20, 0.5]; // of zoom
const FILLED = 0.95; // of the picture's height, by the whole body whichever way it is turned
const LEAST = 1280; // pixels across, for a printer has more than a screen
const DENSEST = 2; // pixels to a CSS pixel

// What buttons do, by their value: degrees to the right and up, and how much closer.
const WAYS: Record<string, [number, number, number]> = {
  left: [-15, 0, 1],
  right: [15, 0, 1],
  up: [0, 15, 1],
  down: [0, -15, 1],
  closer: [0, 0, 1.25],
  farther: [0, 0, 0.8],
};

// Coordinates of corners, of base 64.
export function singles(text: string): Float32Array {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

// Draws into a canvas, in the colours that the style sheet gives it: `--paper`, `--body`, `--edge`.
export class Solid {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new OrthographicCamera();
  private readonly light = new DirectionalLight("white", 2.2);
  private readonly body = new Mesh(
    new BufferGeometry(),
    new MeshLambertMaterial({ polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }),
  );
  private readonly edges = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
  private readonly watcher: ResizeObserver;
  private readonly themes = [window.matchMedia("(prefers-color-scheme: dark)"), window.matchMedia("print")];
  private readonly paint = () => this.draw();
  private view = { ...FIRST };
  private shape: number; // height of the picture, in widths
  private reach = 1; // half the length of the box around the body

  // Null where there is no WebGL.
  static on(canvas: HTMLCanvasElement): Solid | null {
    const context = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    return context && new Solid(canvas, context);
  }

  private constructor(private readonly canvas: HTMLCanvasElement, context: WebGL2RenderingContext) {
    this.shape = canvas.height / canvas.width;
    this.renderer = new WebGLRenderer({ canvas, context, preserveDrawingBuffer: true });
    this.scene.add(this.body, this.edges, new AmbientLight("white", 1.1), this.camera);
    this.camera.add(this.light, this.light.target);
    this.light.position.set(0.35, 0.5, 0.8);
    this.watcher = new ResizeObserver(() => this.resize());
    this.watcher.observe(canvas);
    for (const each of this.themes) each.addEventListener("change", this.paint);
    window.addEventListener("beforeprint", this.paint);
    window.addEventListener("afterprint", this.paint);
    canvas.addEventListener("webglcontextrestored", this.paint);
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons) this.look(0.5 * event.movementX, 0.5 * event.movementY);
    });
  }

  // Another body, by nine coordinates [mm] of each triangle, seen as the last one was.
  show(places: Float32Array): void {
    const flat = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(places, 3));
    flat.computeBoundingBox();
    const size = flat.boundingBox!.getSize(new Vector3());
    const middle = flat.boundingBox!.getCenter(new Vector3());
    this.reach = 0.5 * size.length() || 1;
    flat.translate(-middle.x, -middle.y, -middle.z);
    this.body.geometry.dispose();
    this.edges.geometry.dispose();
    this.body.geometry = toCreasedNormals(flat, SHARP);
    this.edges.geometry = new EdgesGeometry(flat, (180 * SHARP) / Math.PI);
    this.resize();
  }

  // Turns the body to the right and up [degrees], and brings it closer.
  look(across: number, up: number, closer = 1): void {
    this.view.yaw = (this.view.yaw + across) % 360;
    this.view.pitch = Math.min(Math.max(this.view.pitch - up, 0), 180);
    this.view.zoom = Math.min(Math.max(this.view.zoom * closer, FARTHEST), NEAREST);
    this.draw();
  }

  // As a button with this value says; "back" is the first view.
  go(way: string): void {
    if (way === "back") this.view = { ...FIRST };
    this.look(...(WAYS[way] ?? [0, 0, 1]));
  }

  dispose(): void {
    this.watcher.disconnect();
    for (const each of this.themes) each.removeEventListener("change", this.paint);
    window.removeEventListener("beforeprint", this.paint);
    window.removeEventListener("afterprint", this.paint);
    this.canvas.removeEventListener("webglcontextrestored", this.paint);
    for (const each of [this.body, this.edges]) {
      each.geometry.dispose();
      each.material.dispose();
    }
    this.renderer.dispose();
    this.renderer.forceContextLoss(); // a browser has few contexts, and else keeps this one
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas;
    // What is laid out in whole pixels is no reason for another shape.
    if (clientWidth && Math.abs(clientHeight - this.shape * clientWidth) > 1.5) this.shape = clientHeight / clientWidth;
    const wide = Math.max(LEAST, Math.round(clientWidth * Math.min(window.devicePixelRatio, DENSEST)));
    this.renderer.setSize(wide, Math.round(wide * this.shape), false);
    this.draw();
  }

  private draw(): void {
    const style = getComputedStyle(this.canvas);
    const color = (name: string, usual: string) => new Color(style.getPropertyValue(name).trim() || usual);
    this.renderer.setClearColor(color("--paper", "#ffffff"));
    this.body.material.color = color("--body", "#c7d4e0");
    this.edges.material.color = color("--edge", "#12365c");
    const { yaw, pitch, zoom } = this.view;
    const { width, height } = this.canvas;
    const half = this.reach / (FILLED * zoom);
    Object.assign(this.camera, { left: (-half * width) / height, right: (half * width) / height, top: half, bottom: -half });
    Object.assign(this.camera, { near: 0, far: 4 * this.reach });
    this.camera.updateProjectionMatrix();
    // About z by yaw, then back from the viewer by pitch, which shows the near side.
    this.camera.rotation.set((pitch * Math.PI) / 180, 0, (-yaw * Math.PI) / 180, "ZXY");
    this.camera.position.set(0, 0, 2 * this.reach).applyEuler(this.camera.rotation);
    this.renderer.render(this.scene, this.camera);
    this.canvas.dataset.view = `${yaw} ${pitch} ${zoom}`;
  }
}
