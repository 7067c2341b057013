// SPDX-License-Identifier: Apache-2.0
// The kd-tree every builder makes, every tracer walks and every file holds.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fasttree/status.h"
#include "fasttree/vec.h"

namespace fasttree {

/// Which axis each level of the grid halves.
enum class AxisSchedule : std::uint8_t {
  cyclic = 0,   ///< x, y, z, x, y, z, ... over the live axes: the classic Morton code
  longest = 1,  ///< the axis whose cell is longest now; ties to the lowest axis
};

/// Which builder made a tree. The numbers are part of the file format.
enum class Profile : std::uint8_t {
  paper = 0,       ///< the six steps of the FastTree paper: grid, Morton codes, path compression
  sah_exact = 1,   ///< exact surface-area heuristic with perfect splits (Wald and Havran 2006)
  sah_binned = 2,  ///< binned surface-area heuristic (Shevtsov et al. 2007)
  realtime = 3,    ///< least time for build plus trace: a coarse grid, gridded again where crowded
};
inline constexpr Profile kLastProfile = Profile::realtime;

/// "cyclic", "longest"; "paper", "sah-exact", "sah-binned", "realtime".
const char* to_string(AxisSchedule axes);
const char* to_string(Profile profile);

/// One node, 8 bytes. Nodes lie in depth-first pre-order, the lower child right after its parent.
///
///   word 0, bits 0..1   axis of the split (0, 1, 2), or 3 for a leaf
///   word 0, bits 2..31  inner: index of the upper child; leaf: number of triangles
///   word 1              inner: the split, binary32; leaf: first index into the triangle ids
///
/// A point p belongs to the upper child exactly when p[axis] >= split (cells are half open).
struct Node {
  static constexpr std::uint32_t kLeaf = 3;

  std::uint32_t word0 = kLeaf;
  std::uint32_t word1 = 0;

  static Node inner(std::uint32_t axis, float split, std::uint32_t upper) {
    return {upper << 2 | axis, std::bit_cast<std::uint32_t>(split)};
  }
  static constexpr Node leaf(std::uint32_t first, std::uint32_t count) {
    return {count << 2 | kLeaf, first};
  }

  bool is_leaf() const { return (word0 & 3) == kLeaf; }
  std::uint32_t axis() const { return word0 & 3; }
  std::uint32_t upper() const { return word0 >> 2; }
  float split() const { return std::bit_cast<float>(word1); }
  std::uint32_t count() const { return word0 >> 2; }
  std::uint32_t first() const { return word1; }

  friend bool operator==(const Node&, const Node&) = default;
};
static_assert(sizeof(Node) == 8);

/// Largest number of nodes in a tree: the index of the upper child has 30 bits.
inline constexpr std::uint64_t kMaxNodes = std::uint64_t{1} << 30;

/// Largest number of inner nodes above a leaf. Every builder keeps to it and verify() checks it, so
/// that a tracer's stack can have a fixed size.
inline constexpr std::uint32_t kMaxTreeDepth = 64;

/// What a tree says of itself beside its nodes and ids.
struct TreeInfo {
  Profile profile = Profile::paper;
  AxisSchedule axes = AxisSchedule::cyclic;  ///< meaningful for Morton trees only
  std::uint8_t depth = 0;                    ///< D, levels of the grid; 0 for a tree without grid
  std::array<std::uint8_t, 3> bits{};        ///< bits of the grid per axis; they sum to depth
  std::uint32_t triangle_count = 0;          ///< triangles of the mesh the tree was built for
  Box3 bounds{{0, 0, 0}, {0, 0, 0}};         ///< the scene's bounds; all zero for an empty mesh

  friend bool operator==(const TreeInfo&, const TreeInfo&) = default;
};

/// A kd-tree: its info, its nodes and the ids its leaves point into. A tree always has a root: an
/// empty mesh gives one leaf without triangles. Owns its arrays, or shares those that something
/// else owns (a mapped file, what a builder has built): copies are deep or share it likewise, and
/// neither can be changed through them.
class Tree {
 public:
  /// The tree of an empty mesh.
  Tree();
  /// Takes over finished arrays. Nothing is checked: see verify() for that.
  Tree(const TreeInfo& info, std::vector<Node> nodes, std::vector<std::uint32_t> ids);
  /// Views arrays that `owner` keeps alive (a mapped file, a builder's memory) and that do not
  /// change while it does.
  Tree(const TreeInfo& info, std::span<const Node> nodes, std::span<const std::uint32_t> ids,
       std::shared_ptr<const void> owner);

  const TreeInfo& info() const { return info_; }
  std::span<const Node> nodes() const { return owner_ ? mapped_nodes_ : std::span(nodes_); }
  std::span<const std::uint32_t> ids() const { return owner_ ? mapped_ids_ : std::span(ids_); }
  std::uint64_t leaf_count() const { return (nodes().size() + 1) / 2; }

  /// XXH3 (64 bits) over the tree's bytes, little-endian: bounds (lo, hi), nodes, ids. Equal trees
  /// have equal hashes, whichever builder, thread count or machine made them.
  std::uint64_t hash() const;

  /// Leaves the tree empty and hands over what kept its arrays; null for arrays of its own. A
  /// builder reuses the memory of what it has built where nobody else holds it.
  std::shared_ptr<const void> release();

 private:
  TreeInfo info_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> ids_;
  std::span<const Node> mapped_nodes_;
  std::span<const std::uint32_t> mapped_ids_;
  std::shared_ptr<const void> owner_;
};

/// The hash as 16 hexadecimal digits.
std::string hash_string(std::uint64_t hash);

}  // namespace fasttree
