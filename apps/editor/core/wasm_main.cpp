// The WebAssembly module has no program of its own: the page calls editor.h.
#include "editor.h"

int main() {
  return 0;
}
