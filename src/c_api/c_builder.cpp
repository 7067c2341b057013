// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "c_api/handles.h"

using namespace fasttree;
using namespace fasttree::c_api;

namespace {

// The numbers of both interfaces are the same; these lines keep them so.
static_assert(FT_PROFILE_PAPER == static_cast<int>(Profile::paper));
static_assert(FT_PROFILE_SAH_EXACT == static_cast<int>(Profile::sah_exact));
static_assert(FT_PROFILE_SAH_BINNED == static_cast<int>(Profile::sah_binned));
static_assert(FT_PROFILE_REALTIME == static_cast<int>(Profile::realtime));
static_assert(FT_AXES_CYCLIC == static_cast<int>(AxisSchedule::cyclic));
static_assert(FT_AXES_LONGEST == static_cast<int>(AxisSchedule::longest));
static_assert(FT_IMPLEMENTATION_FAST == static_cast<int>(Implementation::fast));
static_assert(FT_IMPLEMENTATION_REFERENCE == static_cast<int>(Implementation::reference));
static_assert(FT_SIMD_SCALAR == static_cast<int>(Simd::scalar));
static_assert(FT_SIMD_WIDEST == static_cast<int>(Simd::widest));
static_assert(FT_AUTO_DEPTH == kAutoDepth);

template <typename Enum>
Status read_choice(const char* call, const char* what, std::uint32_t value, Enum last, Enum& to) {
  if (value > static_cast<std::uint32_t>(last)) {
    return invalid(std::string(call) + ": settings." + what + " is " + std::to_string(value) +
                   "; at most " + std::to_string(static_cast<std::uint32_t>(last)) +
                   " has a meaning");
  }
  to = static_cast<Enum>(value);
  return {};
}

struct Settings {
  BuildSettings build;
  std::uint32_t threads = 0;
};

Status read_settings(const char* call, const ft_build_settings* from, Settings& to) {
  ft_build_settings s = FT_BUILD_SETTINGS_INIT;
  if (from != nullptr) {
    if (Status status = read_struct(call, "settings", from, s); !status.ok()) return status;
  }
  BuildSettings& b = to.build;
  for (const Status& status : {read_choice(call, "profile", s.profile, kLastProfile, b.profile),
                               read_choice(call, "axes", s.axes, AxisSchedule::longest, b.axes),
                               read_choice(call, "implementation", s.implementation,
                                           Implementation::reference, b.implementation),
                               read_choice(call, "simd", s.simd, Simd::widest, b.simd)}) {
    if (!status.ok()) return status;
  }
  b.depth = s.depth;
  b.extra_depth = s.extra_depth;
  b.max_growth = s.max_growth;
  b.memory_limit_bytes = s.memory_limit_bytes;
  b.sah_costs = {s.sah_traversal_cost, s.sah_intersection_cost};
  if (s.progress != nullptr) {
    b.progress = [call_back = s.progress, user = s.progress_user](const char* stage,
                                                                  double fraction) {
      return call_back(user, stage, fraction) != 0;
    };
  }
  to.threads = s.threads;
  return {};
}

Status build(const char* call, ft_builder& handle, const ft_mesh* mesh,
             const ft_build_settings* settings, Tree& tree) {
  MeshView view;
  if (Status s = read_mesh(call, mesh, view); !s.ok()) return s;
  Settings chosen;
  if (Status s = read_settings(call, settings, chosen); !s.ok()) return s;
  return on_threads(call, chosen.threads,
                    [&] { return handle.builder.build(view, chosen.build, tree); });
}

}  // namespace

ft_status ft_builder_create(ft_builder** builder) {
  return guarded([&]() -> Status {
    if (builder == nullptr) return null_pointer("ft_builder_create", "builder");
    *builder = nullptr;
    *builder = new ft_builder;
    return {};
  });
}

void ft_builder_free(ft_builder* builder) {
  delete builder;
}

ft_status ft_builder_build(ft_builder* builder, const ft_mesh* mesh,
                           const ft_build_settings* settings, ft_tree** tree) {
  return guarded([&]() -> Status {
    constexpr char kCall[] = "ft_builder_build";
    if (tree == nullptr) return null_pointer(kCall, "tree");
    *tree = nullptr;
    if (builder == nullptr) return null_pointer(kCall, "builder");
    auto handle = std::make_unique<ft_tree>(ft_tree{std::make_shared<Tree>()});
    if (Status s = build(kCall, *builder, mesh, settings, *handle->tree); !s.ok()) return s;
    *tree = handle.release();
    return {};
  });
}

ft_status ft_builder_build_into(ft_builder* builder, const ft_mesh* mesh,
                                const ft_build_settings* settings, ft_tree* tree) {
  return guarded([&]() -> Status {
    constexpr char kCall[] = "ft_builder_build_into";
    if (builder == nullptr) return null_pointer(kCall, "builder");
    if (tree == nullptr) return null_pointer(kCall, "tree");
    if (tree->tree.use_count() > 1) {
      return invalid(std::string(kCall) + ": a tracer uses the tree; free the tracer first");
    }
    try {
      const Status status = build(kCall, *builder, mesh, settings, *tree->tree);
      if (!status.ok()) *tree->tree = Tree();
      return status;
    } catch (...) {
      *tree->tree = Tree();
      throw;
    }
  });
}

ft_status ft_builder_get_stats(const ft_builder* builder, ft_build_stats* stats) {
  return guarded([&]() -> Status {
    constexpr char kCall[] = "ft_builder_get_stats";
    if (builder == nullptr) return null_pointer(kCall, "builder");
    const BuildStats& from = builder->builder.stats();
    return write_struct(kCall, "stats",
                        ft_build_stats{0, from.build_ms, from.triangles, from.references,
                                       from.planned_bytes, from.stages.size()},
                        stats);
  });
}

ft_status ft_builder_get_stage(const ft_builder* builder, uint64_t index, const char** name,
                               double* ms) {
  return guarded([&]() -> Status {
    constexpr char kCall[] = "ft_builder_get_stage";
    if (builder == nullptr) return null_pointer(kCall, "builder");
    if (name == nullptr) return null_pointer(kCall, "name");
    if (ms == nullptr) return null_pointer(kCall, "ms");
    const auto& stages = builder->builder.stats().stages;
    if (index >= stages.size()) {
      return invalid(std::string(kCall) + ": stage " + std::to_string(index) + " of " +
                     std::to_string(stages.size()));
    }
    *name = stages[index].stage;
    *ms = stages[index].ms;
    return {};
  });
}

void ft_builder_shrink(ft_builder* builder) {
  if (builder == nullptr) return;
  (void)guarded([&]() -> Status {
    builder->builder.shrink();
    return {};
  });
}
