// The module that emscripten makes of core/ (build.mjs says where it is).
declare module "editor-core" {
  export default function createModule(options: { wasmBinary: Uint8Array }): Promise<unknown>;
}
// The worker's code, bundled, as text.
declare module "worker-code" {
  const code: string;
  export default code;
}
