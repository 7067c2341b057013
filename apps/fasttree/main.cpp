// SPDX-License-Identifier: Apache-2.0
// The program fasttree: picks the subcommand, gives it threads, and turns whatever happens into a
// message and an exit code.
#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "command.h"
#include "options.h"
#include "output.h"
#include "progress.h"

namespace fasttree::app {

int exit_code_of(StatusCode code) {
  switch (code) {
    case StatusCode::ok:
      return kDone;
    case StatusCode::invalid_argument:
      return kUsage;
    case StatusCode::bad_input:
    case StatusCode::io_error:
      return kBadInput;
    case StatusCode::resource_limit:
      return kResourceLimit;
    case StatusCode::cancelled:
      return kCancelled;
  }
  return kUsage;
}

void check(const Status& status) {
  if (!status.ok()) throw Failure{exit_code_of(status.code()), status.message()};
}

namespace {

struct Entry {
  std::unique_ptr<Command> command;
  CLI::App* app = nullptr;
};

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// Answers an option the subcommand does not have with the one that was meant. CLI11 would say only
/// that the argument was not expected.
void check_option_names(const CLI::App& app, const std::vector<std::string>& arguments) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (argument == "--") return;
    if (argument.size() < 2 || argument[0] != '-') continue;
    const std::string name = argument.substr(0, argument.find('='));
    const CLI::Option* option = app.get_option_no_throw(name);
    if (option != nullptr) {
      // The value of this option may begin with '-' as well.
      if (name == argument && option->get_items_expected_min() > 0) ++i;
      continue;
    }
    const std::string near = nearest(name, option_names(app));
    throw Failure{
        kUsage,
        fmt::format("'{}' has no option {}{}; see fasttree {} --help", app.get_name(), name,
                    near.empty() ? "" : fmt::format("; did you mean {}?", near), app.get_name())};
  }
}

std::vector<Entry> declare_commands(CLI::App& program, CommonOptions& common) {
  std::vector<Entry> entries;
  for (const auto make :
       {make_info_command, make_build_command, make_verify_command, make_render_command,
        make_compare_command, make_animate_command, make_view_command, make_memory_command,
        make_simulate_command, make_diff_command, make_explore_command, make_reproduce_command,
        make_serve_command}) {
    Entry entry{make(), nullptr};
    entry.app = program.add_subcommand(entry.command->name(), entry.command->summary());
    entry.app->footer(entry.command->details());
    Options options(*entry.app);
    entry.command->declare(options);
    options.text(common.json, "--json", "FILE",
                 "Write the figures as JSON; - writes them, and nothing else, to stdout");
    options.count(common.threads, "--threads", "Threads to use; 0: all", 0, 1024);
    options.flag(common.quiet, "--quiet", "No text on standard output, no progress bar");
    entries.push_back(std::move(entry));
  }
  return entries;
}

int run_command(Command& command, const CommonOptions& common) {
  Output output;
  if (common.quiet || common.json == "-") output.mute();
  Progress progress(!common.quiet);
  // More threads than processors have to be allowed explicitly.
  const int available = oneapi::tbb::info::default_concurrency();
  const int threads = common.threads > 0 ? common.threads : available;
  std::optional<oneapi::tbb::global_control> more;
  if (threads > available) {
    more.emplace(oneapi::tbb::global_control::max_allowed_parallelism, threads);
  }
  oneapi::tbb::task_arena arena(threads);
  Context context{common, output, progress, threads};
  const int code = arena.execute([&] { return command.run(context); });
  progress.clear();
  output.finish();
  return code;
}

int run(const std::vector<std::string>& arguments) {
  CLI::App program("Builds kd-trees for ray tracing, proves them right, traces and draws them.",
                   "fasttree");
  program.set_version_flag("--version", "fasttree " FASTTREE_VERSION);
  program.get_formatter()->column_width(34);
  program.footer(
      "A SCENE is a mesh file (PLY, OBJ, STL, glTF, GLB) or a procedural scene such as\n"
      "scene:knot:100000 (fasttree info --list names them). A TREE is a file that\n"
      "fasttree build --out has written.\n\n"
      "Example:\n  fasttree build scene:knot --out knot.ft && fasttree verify knot.ft "
      "--mesh scene:knot\n\n"
      "Exit codes: 0 done, 1 the check failed, 2 wrong usage, 3 bad input,\n"
      "4 a limit of memory or disk, 130 cancelled");
  CommonOptions common;
  const std::vector<Entry> entries = declare_commands(program, common);

  Output plain;
  if (arguments.empty()) {
    std::fputs(program.help().c_str(), stderr);
    return kUsage;
  }
  const auto named = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) {
    return e.app->get_name() == arguments[0];
  });
  if (named == entries.end() && !arguments[0].empty() && arguments[0][0] != '-') {
    std::vector<std::string> names;
    for (const Entry& e : entries) names.push_back(e.app->get_name());
    const std::string near = nearest(arguments[0], names);
    throw Failure{kUsage, fmt::format("there is no subcommand '{}'; {}give one of {}", arguments[0],
                                      near.empty() ? "" : fmt::format("did you mean {}? Or ", near),
                                      fmt::join(names, ", "))};
  }
  if (named == entries.end()) {
    check_option_names(program, arguments);
  } else {
    check_option_names(*named->app, {arguments.begin() + 1, arguments.end()});
  }
  try {
    program.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::CallForHelp&) {
    plain.write(named == entries.end() ? program.help() : named->app->help("fasttree"));
    plain.finish();
    return kDone;
  } catch (const CLI::CallForAllHelp&) {
    plain.write(program.help("", CLI::AppFormatMode::All));
    plain.finish();
    return kDone;
  } catch (const CLI::CallForVersion& version) {
    plain.write(std::string(version.what()) + "\n");
    plain.finish();
    return kDone;
  } catch (const CLI::ParseError& error) {
    throw Failure{kUsage, fmt::format("{}; see fasttree{} --help", error.what(),
                                      named == entries.end() ? "" : " " + named->app->get_name())};
  }
  if (named == entries.end()) {
    throw Failure{kUsage, "no subcommand was given; see fasttree --help"};
  }
  return run_command(*named->command, common);
}

int report(int code, const std::string& message) {
  std::fputs(fmt::format("fasttree: error: {}\n", message).c_str(), stderr);
  return code;
}

}  // namespace
}  // namespace fasttree::app

int main(int argc, char** argv) {
  using namespace fasttree::app;
  // A closed pipe shall be an error to report, not a silent end.
  std::signal(SIGPIPE, SIG_IGN);
  // Nor a file that grows over its limit.
  std::signal(SIGXFSZ, SIG_IGN);
  catch_interrupts();
  try {
    return run({argv + std::min(argc, 1), argv + argc});
  } catch (const Failure& failure) {
    return report(failure.exit_code, failure.message);
  } catch (const std::bad_alloc&) {
    return report(kResourceLimit,
                  "out of memory; use a smaller scene, fewer levels (--depth) or --memory-limit");
  } catch (const std::exception& error) {
    return report(kBadInput, error.what());
  }
}
