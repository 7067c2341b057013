// SPDX-License-Identifier: Apache-2.0
#include "model/report/first_difference.h"

#include <algorithm>
#include <cstring>
#include <span>

#include "reference/reference_build.h"

namespace fasttree::model {
namespace {

// Compares until something differs.
class Comparison {
 public:
  const std::string& found() const { return found_; }

  template <typename Ours, typename Theirs>
  void compare(const char* name, const Ours& ours, const Theirs& theirs) {
    if (!found_.empty()) return;
    std::size_t i = 0;
    const std::size_t both = std::min(ours.size(), theirs.size());
    while (i < both && ours[i] == theirs[i]) ++i;
    if (i == ours.size() && i == theirs.size()) return;
    found_ = std::string(name) + "[" + std::to_string(i) + "] ";
    if (i == both) {
      found_ += "is one of " + std::to_string(std::max(ours.size(), theirs.size())) + " in " +
                (ours.size() > both ? "the machine's memory" : "the reference") +
                ", the other has " + std::to_string(both);
    } else {
      found_ += "is " + text(ours[i]) + " in the machine's memory, " + text(theirs[i]) +
                " in the reference";
    }
  }

 private:
  static std::string text(std::uint32_t value) { return std::to_string(value); }
  static std::string text(const Node& node) {
    return std::to_string(node.word0) + " " + std::to_string(node.word1);
  }

  std::string found_;
};

bool same_bytes(const Box3& a, const Box3& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

}  // namespace

BuildSettings build_settings(const MachineConfig& config) {
  BuildSettings settings;
  settings.profile = Profile::paper;
  settings.implementation = Implementation::reference;
  if (config.architecture == "fasttree-2") {
    const FastTree2Config& c = config.fasttree2;
    settings.axes = c.axes;
    if (c.depth != FastTree2Config::kDepthByRule) settings.depth = static_cast<int>(c.depth);
    settings.extra_depth = static_cast<int>(c.extra_depth);
    settings.max_growth = c.max_growth;
  } else {
    const PaperConfig::GridRule& c = config.paper.grid;
    settings.axes = c.axes;
    if (c.depth_fixed) settings.depth = static_cast<int>(c.depth);
    settings.extra_depth = static_cast<int>(c.extra_depth);
    settings.max_growth = c.max_growth;
  }
  return settings;
}

Result<std::string> first_difference(const MeshView& mesh, const MachineConfig& config,
                                     const SimulationResult& result,
                                     const ProgressCallback& progress) {
  BuildSettings settings = build_settings(config);
  settings.progress = progress;
  BuildStats stats;
  const Result<reference::ReferenceBuild> built = reference::build(mesh, settings, stats);
  if (!built.ok()) return built.status();
  const reference::ReferenceBuild& b = built.value();
  const IntermediateArrays& a = result.arrays;
  Comparison all;
  if (config.architecture != "fasttree-2") {
    // fasttree-2 never has these: it duplicates on chip, and its counters are the leaf table.
    all.compare("unsorted_codes", a.unsorted_codes, b.references.codes);
    all.compare("unsorted_ids", a.unsorted_ids, b.references.ids);
    all.compare("sorted_codes", a.sorted_codes, b.sorted.codes);
  }
  all.compare("sorted_ids", a.sorted_ids, b.sorted.ids);
  if (config.architecture != "fasttree-2") {
    all.compare("leaf_codes", a.leaf_codes, b.leaves.code);
    all.compare("leaf_first", a.leaf_first, b.leaves.first);
    all.compare("leaf_count", a.leaf_count, b.leaves.count);
    all.compare("mark_words", a.mark_words, b.essential.words());
  }
  Result<Tree> reference = tree_from_device_image(reference::device_image(b));
  if (!reference.ok()) return reference.status();
  const Tree& tree = reference.value();
  all.compare("tree_nodes", result.tree.nodes(), tree.nodes());
  all.compare("tree_ids", result.tree.ids(), tree.ids());
  if (!all.found().empty()) return all.found();
  if (!same_bytes(result.tree.info().bounds, tree.info().bounds)) {
    return std::string("tree_bounds differ");
  }
  if (!(result.tree.info() == tree.info())) return std::string("tree_info differs");
  return std::string();
}

}  // namespace fasttree::model
