// SPDX-License-Identifier: Apache-2.0
// The tree object, its hash and the names of its settings.
#include "fasttree/tree.h"

#include "tree/xxh3.h"

namespace fasttree {

const char* to_string(AxisSchedule axes) {
  switch (axes) {
    case AxisSchedule::cyclic:
      return "cyclic";
    case AxisSchedule::longest:
      return "longest";
  }
  return "unknown";
}

const char* to_string(Profile profile) {
  switch (profile) {
    case Profile::paper:
      return "paper";
    case Profile::sah_exact:
      return "sah-exact";
    case Profile::realtime:
      return "realtime";
    case Profile::sah_binned:
      return "sah-binned";
  }
  return "unknown";
}

Tree::Tree() : nodes_{Node::leaf(0, 0)} {}

Tree::Tree(const TreeInfo& info, std::vector<Node> nodes, std::vector<std::uint32_t> ids)
    : info_(info), nodes_(std::move(nodes)), ids_(std::move(ids)) {}

Tree::Tree(const TreeInfo& info, std::span<const Node> nodes, std::span<const std::uint32_t> ids,
           std::shared_ptr<const void> owner)
    : info_(info), mapped_nodes_(nodes), mapped_ids_(ids), owner_(std::move(owner)) {}

std::uint64_t Tree::hash() const {
  Xxh3 hash;
  for (const Vec3& corner : {info_.bounds.lo, info_.bounds.hi}) {
    for (std::size_t a = 0; a < 3; ++a) {
      hash.little_endian_words(std::bit_cast<std::array<std::uint32_t, 1>>(corner[a]));
    }
  }
  hash.little_endian_words(nodes());
  hash.little_endian_words(ids());
  return hash.digest();
}

std::shared_ptr<const void> Tree::release() {
  std::shared_ptr<const void> owner = std::move(owner_);
  *this = Tree();
  return owner;
}

std::string hash_string(std::uint64_t hash) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text(16, '0');
  for (auto digit = text.rbegin(); digit != text.rend(); ++digit, hash >>= 4) {
    *digit = kDigits[hash & 15];
  }
  return text;
}

}  // namespace fasttree
