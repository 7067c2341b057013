// SPDX-License-Identifier: Apache-2.0
// Runs the program as a shell would, and keeps what it said.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace fasttree::cli {

struct RunResult {
  int exit_code = -1;  ///< 128 + the signal where one ended it
  std::string out;
  std::string err;

  nlohmann::json json() const;  ///< of `out`
};

struct RunSettings {
  /// Runs in the child before the program does: limits, closed files.
  std::function<void()> prepare;
  /// Runs in the parent, with the child's id, once the program catches Ctrl-C.
  std::function<void(int pid)> meanwhile;
  std::string stdout_path;  ///< instead of keeping it
};

RunResult run(const std::vector<std::string>& arguments, const RunSettings& settings = {});

/// Runs, and expects exit 0 and JSON on standard output.
nlohmann::json run_json(std::vector<std::string> arguments);

/// The program in the background, with what it prints so far. Killed where it still runs at the
/// end.
class Background {
 public:
  explicit Background(const std::vector<std::string>& arguments);
  ~Background();
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  int pid() const { return pid_; }
  /// Reads standard output until `text` and the end of its line are there; false at the end of it.
  bool read_until(const std::string& text);
  /// The word behind `text` in what was read.
  std::string word_after(const std::string& text) const;
  void signal(int number);
  /// Reads the rest and waits. The exit code, or 128 and the signal.
  int wait();
  const std::string& out() const { return out_; }

 private:
  bool read_more();
  int pid_ = -1;
  int pipe_ = -1;
  std::string out_;
};

/// A folder of the running test's own, empty, removed when it ends.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string path(const std::string& name) const { return (path_ / name).string(); }
  std::size_t file_count() const;

 private:
  std::filesystem::path path_;
};

std::string read_file(const std::string& path);
void write_file(const std::string& path, const std::string& content);

/// A scene file that need not be there, or empty.
std::string real_scene(const std::string& name);

}  // namespace fasttree::cli
