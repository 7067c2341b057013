// SPDX-License-Identifier: Apache-2.0
// Damaged files: cut at every byte, and thousands of random mutants of each format. Whatever the
// bytes, a reader gives a sound mesh or a readable error (fuzz/mesh_check.h says what that means).
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "fuzz/mesh_check.h"
#include "fuzz/mutator.h"

namespace fasttree::fuzz {
namespace {

std::vector<Bytes> corpus_of(const MeshFormat& format) {
  return read_corpus(std::string(FASTTREE_CORPUS) + "/" + std::string(format.name));
}

class Damage : public testing::TestWithParam<MeshFormat> {};

TEST_P(Damage, CorpusFilesAreMeshes) {
  const std::vector<Bytes> corpus = corpus_of(GetParam());
  ASSERT_FALSE(corpus.empty());
  for (std::size_t i = 0; i < corpus.size(); ++i) {
    bool is_mesh = false;
    EXPECT_EQ(check_mesh_bytes(GetParam(), corpus[i], &is_mesh), "");
    EXPECT_TRUE(is_mesh) << "corpus file " << i << " in the order of names";
  }
}

TEST_P(Damage, SurvivesBeingCutAtEveryByte) {
  std::size_t refused = 0;
  for (const Bytes& file : corpus_of(GetParam())) {
    for (std::size_t size = 0; size < file.size(); ++size) {
      bool is_mesh = false;
      ASSERT_EQ(check_mesh_bytes(GetParam(), std::span(file).first(size), &is_mesh), "")
          << "cut at " << size;
      refused += is_mesh ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 0u);
}

TEST_P(Damage, SurvivesTwentyThousandMutations) {
  Mutator mutator(corpus_of(GetParam()), 2026);
  std::size_t meshes = 0;
  for (int i = 0; i < 20000; ++i) {
    const Bytes mutant = mutator.next();
    bool is_mesh = false;
    ASSERT_EQ(check_mesh_bytes(GetParam(), mutant, &is_mesh), "") << "mutant " << i;
    meshes += is_mesh ? 1 : 0;
  }
  // Mutants that are all refused at the first byte, or all harmless, would test nothing.
  EXPECT_GT(meshes, 100u);
  EXPECT_LT(meshes, 19000u);
}

INSTANTIATE_TEST_SUITE_P(Formats, Damage,
                         testing::ValuesIn(mesh_formats().begin(), mesh_formats().end()),
                         [](const auto& format) { return std::string(format.param.name); });

}  // namespace
}  // namespace fasttree::fuzz
