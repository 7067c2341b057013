// SPDX-License-Identifier: Apache-2.0
// Random damage to files: what a bad disk, a bad exporter or a bad person does. Deterministic for a
// seed on every machine, and needs no special compiler; libFuzzer, guided by coverage, goes deeper.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace fasttree::fuzz {

using Bytes = std::vector<std::byte>;

class Mutator {
 public:
  /// `seeds`: good files; at least one.
  Mutator(std::vector<Bytes> seeds, std::uint64_t seed);

  /// A seed with one, two, four or eight changes.
  Bytes next();

 private:
  std::size_t below(std::size_t bound);  ///< uniform in [0, bound), or 0 for 0
  void change(Bytes& bytes);
  void put(Bytes& bytes, std::size_t at, std::size_t erase, const Bytes& insert) const;
  Bytes some_of(const Bytes& bytes);

  void change_bits(Bytes& bytes);
  void change_number(Bytes& bytes);
  void change_word(Bytes& bytes);
  void move_parts(Bytes& bytes);

  std::vector<Bytes> seeds_;
  std::vector<Bytes> words_;  ///< of all seeds
  std::mt19937_64 random_;
};

/// All files of a folder in the order of their names; empty where there is none.
std::vector<Bytes> read_corpus(const std::string& folder);

}  // namespace fasttree::fuzz
