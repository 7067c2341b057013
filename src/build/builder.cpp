// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <memory>
#include <new>
#include <utility>

#include "baseline/baseline.h"
#include "build/morton_build.h"
#include "build/realtime_build.h"
#include "fasttree/build.h"
#include "fasttree/device_image.h"
#include "reference/realtime_build.h"
#include "reference/reference_build.h"
#include "reference/scene_bound.h"
#include "support/stage_clock.h"

namespace fasttree {

namespace {

// Marks what keeps the arrays of trees that were built here, so that it is known again.
struct DeleteArrays {
  void operator()(build::TreeArrays* arrays) const { delete arrays; }
};

}  // namespace

struct Builder::Impl {
  build::Workspace workspace;
  std::shared_ptr<build::TreeArrays> spare;  ///< memory of a build that failed
  BuildStats stats;

  // The arrays of `tree` where no other tree has them too; else those of a build that failed, or
  // fresh ones.
  std::shared_ptr<build::TreeArrays> take_arrays(Tree& tree) {
    std::shared_ptr<const void> owner = tree.release();
    if (owner.use_count() == 1 && std::get_deleter<DeleteArrays>(owner) != nullptr) {
      return std::const_pointer_cast<build::TreeArrays>(
          std::static_pointer_cast<const build::TreeArrays>(owner));
    }
    if (spare) return std::move(spare);
    return {new build::TreeArrays, DeleteArrays()};
  }

  using FastBuild = Status (*)(const MeshView&, const BuildSettings&, build::Workspace&,
                               build::TreeArrays&, BuildStats&);
  Status build_fast(FastBuild fast, const MeshView& mesh, const BuildSettings& settings,
                    Tree& tree) {
    std::shared_ptr<build::TreeArrays> arrays = take_arrays(tree);
    Status status = fast(mesh, settings, workspace, *arrays, stats);
    if (status.ok()) {
      const build::TreeArrays& made = *arrays;
      tree = Tree(made.info, made.nodes, made.ids, std::move(arrays));
    } else {
      spare = std::move(arrays);
    }
    return status;
  }

  Status build_realtime(const MeshView& mesh, const BuildSettings& settings, Tree& tree) {
    if (settings.implementation == Implementation::fast) {
      return build_fast(build::realtime_build, mesh, settings, tree);
    }
    Result<Tree> built = reference::realtime_build(mesh, settings, stats);
    if (built.ok()) tree = std::move(built).value();
    return built.status();
  }

  Status build_reference(const MeshView& mesh, const BuildSettings& settings, Tree& tree) {
    Result<reference::ReferenceBuild> built = reference::build(mesh, settings, stats);
    if (!built.ok()) return built.status();
    Result<Tree> converted = tree_from_device_image(reference::device_image(built.value()));
    if (!converted.ok()) return converted.status();
    tree = std::move(converted).value();
    return {};
  }

  Status build_baseline(const MeshView& mesh, const BuildSettings& settings, Tree& tree) {
    if (Status status = validate(mesh); !status.ok()) return status;
    const bool exact = settings.profile == Profile::sah_exact;
    StageClock clock(settings.progress, stats.stages);
    Status status;
    Box3 bounds;
    clock.stage("scene_bound", 0.0, 0.01, [&] {
      const Result<Box3> result = reference::scene_bound(mesh);
      status = result.status();
      if (result.ok()) bounds = result.value();
    });
    if (!status.ok()) return status;
    clock.stage(exact ? "sah_exact" : "sah_binned", 0.01, 1.0, [&] {
      const BaselineInput input{mesh, bounds, settings.sah_costs, settings.memory_limit_bytes,
                                settings.progress};
      Result<Tree> result = exact ? build_sah_exact(input) : build_sah_binned(input);
      status = result.status();
      if (result.ok()) tree = std::move(result).value();
    });
    if (!status.ok()) return status;
    if (clock.cancelled()) return clock.cancelled_status();
    stats.triangles = mesh.triangle_count;
    stats.references = tree.ids().size();
    return {};
  }

  Status build(const MeshView& mesh, const BuildSettings& settings, Tree& tree) {
    switch (settings.profile) {
      case Profile::paper:
        return settings.implementation == Implementation::reference
                   ? build_reference(mesh, settings, tree)
                   : build_fast(build::morton_build, mesh, settings, tree);
      case Profile::realtime:
        return build_realtime(mesh, settings, tree);
      case Profile::sah_exact:
      case Profile::sah_binned:
        return build_baseline(mesh, settings, tree);
    }
    return {StatusCode::invalid_argument, "build: no profile has the number " +
                                              std::to_string(static_cast<int>(settings.profile))};
  }
};

Builder::Builder() : impl_(std::make_unique<Impl>()) {}
Builder::~Builder() = default;
Builder::Builder(Builder&&) noexcept = default;
Builder& Builder::operator=(Builder&&) noexcept = default;

Result<Tree> Builder::build(const MeshView& mesh, const BuildSettings& settings) {
  Tree tree;
  if (Status status = build(mesh, settings, tree); !status.ok()) return status;
  return tree;
}

Status Builder::build(const MeshView& mesh, const BuildSettings& settings, Tree& tree) {
  impl_->stats = {};
  const auto start = std::chrono::steady_clock::now();
  Status status;
  try {
    status = impl_->build(mesh, settings, tree);
  } catch (const std::bad_alloc&) {
    status = {StatusCode::resource_limit,
              "build: out of memory for " + std::to_string(mesh.triangle_count) +
                  " triangles. Set a memory limit, ask for a smaller depth or split the mesh."};
  }
  if (!status.ok()) tree = Tree();
  const auto stop = std::chrono::steady_clock::now();
  impl_->stats.build_ms = std::chrono::duration<double, std::milli>(stop - start).count();
  return status;
}

const BuildStats& Builder::stats() const {
  return impl_->stats;
}

void Builder::shrink() {
  impl_->workspace = {};
  impl_->spare = nullptr;
}

}  // namespace fasttree
