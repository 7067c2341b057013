// SPDX-License-Identifier: Apache-2.0
#include "fuzz/mesh_check.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  return fasttree::fuzz::fuzz_mesh_bytes("gltf", data, size);
}
