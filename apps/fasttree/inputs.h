// SPDX-License-Identifier: Apache-2.0
// What the subcommands read, and how they build: scenes, trees and the options about them.
#pragma once

#include <chrono>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "command.h"
#include "fasttree/build.h"
#include "fasttree/quality.h"
#include "fasttree/trace.h"
#include "fasttree/tree.h"
#include "options.h"
#include "output.h"
#include "scene/scene.h"

namespace fasttree::app {

/// Most of the memory this process may use: of the machine's, or of its control group's.
std::uint64_t most_of_memory();

/// The processor's name as the system has it; "unknown" where it does not tell.
std::string processor_name();

/// Options about how to build, shared by the subcommands that do.
struct BuildOptions {
  BuildSettings settings;

  void declare(Options& options);
  /// The settings, with progress that says `what`.
  BuildSettings with_progress(Context& context, const std::string& what = "building") const;
};

const Choices<Profile>& profiles();
const Choices<AxisSchedule>& axis_schedules();

/// A mesh and how long it took to read.
struct LoadedScene {
  scene::Mesh mesh;
  MeshView view;
  double load_ms = 0;
};

LoadedScene load_scene(Context& context, const std::string& spec, std::uint64_t memory_limit_bytes);

/// Loads a tree file. Its content is checked too: everything that uses a tree relies on that.
Tree load_checked_tree(const std::string& path);

Tracer make_tracer(const Tree& tree, const MeshView& mesh);

/// JSON that several subcommands have in common.
nlohmann::ordered_json json_of(const Quality& quality);
nlohmann::ordered_json json_of(const Box3& box);
nlohmann::ordered_json json_of(const Vec3& point);
nlohmann::ordered_json json_of(const TreeInfo& info);
nlohmann::ordered_json json_of_program();

std::string text_of(const Box3& box);
void print_quality(Output& output, const Quality& quality);

double median(std::vector<double> values);
double milliseconds_since(std::chrono::steady_clock::time_point start);

}  // namespace fasttree::app
