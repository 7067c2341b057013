// SPDX-License-Identifier: Apache-2.0
// mutate FORMAT COUNT SEED CORPUS: parses COUNT damaged copies of the corpus's files and checks
// what the reader promises. Exit status 1 where it breaks one; the mutant is written to
// mutant.FORMAT. A sanitizer stops the program itself; with N, only mutant N is made, written
// there, and tried.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "fuzz/mesh_check.h"
#include "fuzz/mutator.h"

// Of AddressSanitizer and its like, where the program is built with one.
extern "C" void __sanitizer_set_death_callback(void (*)()) __attribute__((weak));

namespace {

std::string mutant_path;
const fasttree::fuzz::Bytes* current_mutant = nullptr;

void write_mutant() {
  if (current_mutant == nullptr) return;
  std::ofstream(mutant_path, std::ios::binary)
      .write(reinterpret_cast<const char*>(current_mutant->data()),
             static_cast<std::streamsize>(current_mutant->size()));
}

}  // namespace

int main(int argc, char** argv) {
  using namespace fasttree::fuzz;
  if (argc != 5) {
    std::fprintf(stderr,
                 "usage: %s FORMAT COUNT SEED CORPUS\n"
                 "FORMAT: ply, obj, stl or gltf. For example: mutate ply 1000000 1 "
                 "fuzz/corpus/ply\n",
                 argv[0]);
    return 2;
  }
  const MeshFormat* const format = find_mesh_format(argv[1]);
  const std::uint64_t count = std::strtoull(argv[2], nullptr, 10);
  const std::uint64_t seed = std::strtoull(argv[3], nullptr, 10);
  const std::vector<Bytes> corpus = read_corpus(argv[4]);
  if (format == nullptr || corpus.empty()) {
    std::fprintf(stderr, "mutate: no format '%s', or no files in '%s'\n", argv[1], argv[4]);
    return 2;
  }

  mutant_path = "mutant." + std::string(format->name);
  if (__sanitizer_set_death_callback != nullptr) __sanitizer_set_death_callback(&write_mutant);

  const auto start = std::chrono::steady_clock::now();
  Mutator mutator(corpus, seed);
  std::uint64_t meshes = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    const Bytes mutant = mutator.next();
    current_mutant = &mutant;
    bool is_mesh = false;
    const std::string broken = check_mesh_bytes(*format, mutant, &is_mesh);
    meshes += is_mesh ? 1 : 0;
    if (!broken.empty()) {
      write_mutant();
      std::fprintf(stderr, "mutate: number %llu (%s): %s\n", static_cast<unsigned long long>(i),
                   mutant_path.c_str(), broken.c_str());
      return 1;
    }
    current_mutant = nullptr;
  }
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("%s: %llu mutants of %zu files, %llu still a mesh, %.1f s\n", argv[1],
              static_cast<unsigned long long>(count), corpus.size(),
              static_cast<unsigned long long>(meshes), seconds);
  return 0;
}
