// SPDX-License-Identifier: Apache-2.0
// Between the device image (nodes by in-order rank, both children named) and the tree (nodes in
// pre-order, the lower child implied).
#include "fasttree/device_image.h"

#include <utility>

#include "fasttree/mesh.h"

namespace fasttree {
namespace {

constexpr std::uint64_t kMaxLeaves = kMaxNodes / 2;
constexpr std::uint32_t kRootPosition = 0;

std::string child_text(std::uint32_t child) {
  return (child & kDeviceLeaf ? "leaf " : "internal node ") + std::to_string(child & ~kDeviceLeaf);
}

Status bad_image(const std::string& what) {
  return {StatusCode::bad_input, "device image: " + what};
}

Status bad_tree(std::size_t position, const std::string& what) {
  return {StatusCode::bad_input, "tree: node " + std::to_string(position) + " " + what};
}

// Leaves and internal nodes, each by itself.
Status check_tables(const DeviceImage& image) {
  const std::size_t leaves = image.leaves.size();
  if (leaves == 0) return bad_image("no leaf; the tree of an empty mesh has one");
  if (leaves > kMaxLeaves) {
    return {StatusCode::resource_limit, "device image: " + std::to_string(leaves) +
                                            " leaves; a tree holds at most " +
                                            std::to_string(kMaxLeaves)};
  }
  if (image.internal.size() != leaves - 1) {
    return bad_image(std::to_string(leaves) + " leaves go with " + std::to_string(leaves - 1) +
                     " internal nodes, not " + std::to_string(image.internal.size()));
  }
  for (std::size_t j = 0; j < leaves; ++j) {
    const auto [first, count] = image.leaves[j];
    if (count > kMaxTriangles || first > image.ids.size() || count > image.ids.size() - first) {
      return bad_image("leaf " + std::to_string(j) + " is the run of " + std::to_string(count) +
                       " from " + std::to_string(first) + ", outside the " +
                       std::to_string(image.ids.size()) + " triangle ids");
    }
  }
  for (std::size_t j = 0; j < image.internal.size(); ++j) {
    if (image.internal[j].axis > 2) {
      return bad_image("internal node " + std::to_string(j) + " splits axis " +
                       std::to_string(image.internal[j].axis) + ", not 0, 1 or 2");
    }
  }
  return {};
}

// A subtree of the image: what its parent names, and the leaves that have to be its own.
struct Subtree {
  std::uint32_t child = 0;
  std::uint32_t first = 0;
  std::uint32_t last = 0;
  std::uint32_t lower_turns = 0;  ///< ancestors that have it on their lower side

  std::uint32_t leaf_count() const { return last - first + 1; }

  // Before it in pre-order lie the leaves left of it, as many internal nodes between those leaves
  // and it, and of all others only the ancestors that have it on their lower side.
  std::uint32_t position() const { return 2 * first + lower_turns; }

  // A subtree of leaves first..last is the leaf itself where there is one only, else an internal
  // node between two of its leaves.
  bool well_formed() const {
    return first == last ? child == (kDeviceLeaf | first) : first <= child && child < last;
  }
};

}  // namespace

Result<Tree> tree_from_device_image(const DeviceImage& image) {
  if (Status s = check_tables(image); !s.ok()) return s;
  const auto leaf_count = static_cast<std::uint32_t>(image.leaves.size());
  std::vector<Node> nodes(2 * std::size_t{leaf_count} - 1);

  // An internal node at rank j parts its leaves after leaf j. So the ranges are known from above,
  // get strictly smaller, and are disjoint: where every child is inside its range, each node is met
  // exactly once, and no cycle can be walked.
  Subtree next{image.root, 0, leaf_count - 1, 0};
  if (!next.well_formed()) {
    return bad_image("the root is " + child_text(image.root) + ", which does not part " +
                     std::to_string(leaf_count) + " leaves");
  }
  // Positions follow from the formula, so subtrees can be taken in any order. Going on with the
  // smaller one keeps the waiting ones to log2(leaves), however deep the tree is.
  std::vector<Subtree> waiting;
  while (true) {
    if (next.first == next.last) {
      const auto [first, count] = image.leaves[next.first];
      nodes[next.position()] = Node::leaf(first, count);
      if (waiting.empty()) break;
      next = waiting.back();
      waiting.pop_back();
      continue;
    }
    const std::uint32_t rank = next.child;
    const DeviceInternalNode& node = image.internal[rank];
    Subtree lower{node.lower, next.first, rank, next.lower_turns + 1};
    Subtree upper{node.upper, rank + 1, next.last, next.lower_turns};
    for (const auto& [side, child] : {std::pair("lower", &lower), std::pair("upper", &upper)}) {
      if (!child->well_formed()) {
        return bad_image("internal node " + std::to_string(rank) + " has " +
                         child_text(child->child) + " as its " + side + " child, where leaves " +
                         std::to_string(child->first) + " to " + std::to_string(child->last) +
                         " belong");
      }
    }
    nodes[next.position()] = Node::inner(node.axis, node.split, upper.position());
    const bool lower_is_smaller = lower.leaf_count() <= upper.leaf_count();
    waiting.push_back(lower_is_smaller ? upper : lower);
    next = lower_is_smaller ? lower : upper;
  }
  return Tree(image.info, std::move(nodes), image.ids);
}

Result<DeviceImage> device_image_from_tree(const Tree& tree) {
  const std::span<const Node> nodes = tree.nodes();
  if (nodes.empty()) return Status(StatusCode::bad_input, "tree: no node; a tree has a root");
  if (nodes.size() > kMaxNodes) {
    return Status(StatusCode::resource_limit, "tree: " + std::to_string(nodes.size()) +
                                                  " nodes; a tree holds at most " +
                                                  std::to_string(kMaxNodes));
  }

  // In pre-order a subtree ends with a leaf, and then the upper child of the innermost node that
  // still waits for one must follow. That node lies between this leaf and the next, which is its
  // rank. No link is followed, they are only compared.
  DeviceImage image;
  image.info = tree.info();
  std::vector<std::uint32_t> child_at(nodes.size());  // how a parent names the node there
  std::vector<std::uint32_t> open;                    // inner nodes whose upper child is to come
  std::vector<std::uint32_t> by_rank;                 // position of each internal node
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].is_leaf()) {
      open.push_back(i);
      continue;
    }
    const auto leaf = static_cast<std::uint32_t>(image.leaves.size());
    child_at[i] = kDeviceLeaf | leaf;
    image.leaves.push_back({nodes[i].first(), nodes[i].count()});
    if (i + 1 == nodes.size()) break;
    if (open.empty()) return bad_tree(i + 1, "belongs to no inner node");
    const std::uint32_t parent = open.back();
    open.pop_back();
    if (nodes[parent].upper() != i + 1) {
      return bad_tree(parent, "has its upper child at " + std::to_string(nodes[parent].upper()) +
                                  ", but its lower subtree ends before " + std::to_string(i + 1));
    }
    child_at[parent] = leaf;
    by_rank.push_back(parent);
  }
  if (!open.empty()) return bad_tree(open.back(), "has no upper child: the nodes end before it");

  image.root = child_at[kRootPosition];
  image.internal.reserve(by_rank.size());
  for (const std::uint32_t position : by_rank) {
    const Node& node = nodes[position];
    image.internal.push_back(
        {child_at[position + 1], child_at[node.upper()], node.split(), node.axis()});
  }
  const std::span<const std::uint32_t> ids = tree.ids();
  image.ids.assign(ids.begin(), ids.end());
  return image;
}

}  // namespace fasttree
