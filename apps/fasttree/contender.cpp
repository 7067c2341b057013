// SPDX-License-Identifier: Apache-2.0
#include "contender.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <span>

#include "command.h"
#include "inputs.h"
#include "options.h"
#include "oracle/embree_oracle.h"
#include "oracle/embree_peer.h"

namespace fasttree::app {
namespace {

using oracle::EmbreeQuality;
using Clock = std::chrono::steady_clock;

struct NamedTree {
  const char* name;
  Profile profile;
  AxisSchedule axes;
};
constexpr std::array kTrees = {NamedTree{"realtime", Profile::realtime, AxisSchedule::cyclic},
                               NamedTree{"paper-cyclic", Profile::paper, AxisSchedule::cyclic},
                               NamedTree{"paper-longest", Profile::paper, AxisSchedule::longest},
                               NamedTree{"sah-binned", Profile::sah_binned, AxisSchedule::cyclic},
                               NamedTree{"sah-exact", Profile::sah_exact, AxisSchedule::cyclic}};

struct NamedEmbree {
  const char* name;
  EmbreeQuality quality;
};
constexpr std::array kEmbrees = {NamedEmbree{"embree-low", EmbreeQuality::low},
                                 NamedEmbree{"embree-medium", EmbreeQuality::medium}};
constexpr const char* kBothEmbrees = "embree";

bool is_embree(const std::string& name) {
  return name.starts_with(kBothEmbrees);
}

std::vector<std::string> embree_ways() {
  std::vector<std::string> ways;
  for (const int width : oracle::kEmbreeWidths) {
    ways.push_back(width == 1 ? "single" : fmt::format("packet{}", width));
  }
  return ways;
}

class EmbreeContender : public Contender {
 public:
  /// The rays' memory is shared: it is large, and only one contender traces at a time.
  EmbreeContender(std::string name, EmbreeQuality quality, std::shared_ptr<oracle::EmbreeRays> rays)
      : Contender(std::move(name), embree_ways()), quality_(quality), rays_(std::move(rays)) {}

  double build(const MeshView& mesh) override {
    // The first build is not measured: a renderer builds once and rebuilds ever after.
    if (!peer_) peer_ = take(oracle::EmbreePeer::create(mesh, quality_));
    const auto start = Clock::now();
    check(peer_->rebuild());
    return milliseconds_since(start);
  }

  double trace(RayKind kind, std::size_t way, std::span<const Ray> rays, Traced&) override {
    const int width = oracle::kEmbreeWidths[way];
    if (kind == RayKind::shadow) {
      rays_->set_occluded(rays, width);
    } else {
      rays_->set_closest(rays, width);
    }
    const auto start = Clock::now();
    peer_->trace(*rays_, kind != RayKind::diffuse);
    return milliseconds_since(start);
  }

  void read(RayKind kind, Traced& traced) override {
    if (kind == RayKind::shadow) {
      rays_->read(std::span(traced.flags));
    } else {
      rays_->read(std::span(traced.hits));
    }
  }

 private:
  EmbreeQuality quality_;
  std::shared_ptr<oracle::EmbreeRays> rays_;
  std::optional<oracle::EmbreePeer> peer_;
};

}  // namespace

Contender::Contender(std::string name, std::vector<std::string> ways) {
  record.name = std::move(name);
  record.ways = std::move(ways);
  for (auto& kind : record.trace_ms) kind.resize(record.ways.size());
}

TreeContender::TreeContender(std::string name, BuildSettings settings)
    : Contender(std::move(name), {"single", "packet64"}), settings_(std::move(settings)) {
  record.tree.emplace();
  record.tree->profile = settings_.profile;
}

double TreeContender::build(const MeshView& mesh) {
  const auto start = Clock::now();
  check(builder_.build(mesh, settings_, tree_));
  const auto built = Clock::now();
  check(tracer_.update(tree_, mesh));
  layout_ms_ = milliseconds_since(built);
  return milliseconds_since(start);
}

double TreeContender::trace(RayKind kind, std::size_t way, std::span<const Ray> rays,
                            Traced& traced) {
  const RayOrder order = way == 0 ? RayOrder::incoherent : RayOrder::coherent;
  const auto start = Clock::now();
  if (kind == RayKind::shadow) {
    tracer_.occluded(rays, traced.flags, order);
  } else {
    tracer_.closest(rays, traced.hits, order);
  }
  return milliseconds_since(start);
}

void TreeContender::study(const MeasuredRays& rays) {
  record.tree->depth = tree_.info().depth;
  record.tree->hash = tree_.hash();
  record.tree->quality = measure_quality(tree_, settings_.sah_costs);
  for (std::size_t k = 0; k < kRayKinds.size(); ++k) {
    record.tree->counters[k] = count_rays(tracer_, kRayKinds[k], rays.rays[k]);
  }
}

std::vector<std::string> contender_names() {
  std::vector<std::string> names;
  for (const NamedTree& tree : kTrees) names.push_back(tree.name);
  for (const NamedEmbree& embree : kEmbrees) names.push_back(embree.name);
  names.push_back(kBothEmbrees);
  return names;
}

std::vector<std::string> parse_contenders(const std::string& list) {
  const std::vector<std::string> valid = contender_names();
  std::vector<std::string> names;
  const auto add = [&names](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    const std::string name = list.substr(begin, end - begin);
    begin = end + 1;
    if (std::find(valid.begin(), valid.end(), name) == valid.end()) {
      const std::string near = nearest(name, valid);
      throw Failure{kUsage, fmt::format("--builders cannot have '{}'; give some of {}{}", name,
                                        fmt::join(valid, ", "),
                                        near.empty() ? "" : "; did you mean " + near + "?")};
    }
    if (is_embree(name) && !oracle::embree_available()) {
      throw Failure{kUsage, "--builders: this program was built without Embree"};
    }
    if (name == kBothEmbrees) {
      for (const NamedEmbree& embree : kEmbrees) add(embree.name);
    } else {
      add(name);
    }
  }
  // The camera, the rays and the expected hits come from the first, which has to be a tree.
  std::stable_partition(names.begin(), names.end(), [](const auto& n) { return !is_embree(n); });
  if (is_embree(names[0])) {
    throw Failure{kUsage, "--builders needs a kd-tree builder beside embree"};
  }
  return names;
}

std::vector<std::string> default_contenders(std::optional<Profile> profile) {
  std::vector<std::string> names;
  for (const NamedTree& tree : kTrees) {
    // Of two trees of one profile, the one that the other subcommands build without further
    // options.
    if (tree.axes != AxisSchedule::cyclic) continue;
    const bool usual = tree.profile == Profile::realtime || tree.profile == Profile::paper;
    if (profile ? tree.profile == *profile : usual) names.push_back(tree.name);
  }
  if (oracle::embree_available()) {
    for (const NamedEmbree& embree : kEmbrees) names.push_back(embree.name);
  }
  return names;
}

std::vector<std::unique_ptr<Contender>> make_contenders(const std::vector<std::string>& names,
                                                        const BuildSettings& settings, int depth) {
  std::vector<std::unique_ptr<Contender>> contenders;
  const auto rays = std::make_shared<oracle::EmbreeRays>();
  for (const std::string& name : names) {
    for (const NamedTree& tree : kTrees) {
      if (name != tree.name) continue;
      BuildSettings own = settings;
      own.profile = tree.profile;
      own.axes = tree.axes;
      if (tree.profile == Profile::paper) own.depth = depth;
      contenders.push_back(std::make_unique<TreeContender>(name, std::move(own)));
    }
    for (const NamedEmbree& embree : kEmbrees) {
      if (name != embree.name) continue;
      contenders.push_back(std::make_unique<EmbreeContender>(name, embree.quality, rays));
    }
  }
  return contenders;
}

}  // namespace fasttree::app
