// SPDX-License-Identifier: Apache-2.0
// The file of an exploration: CSV that survives an interruption.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>
#include <span>
#include <utility>

#include "exploration.h"
#include "output.h"
#include "tree/atomic_file.h"

namespace fasttree::app {
namespace {

struct Column {
  const char* name;
  std::function<std::string(const ExploredRun&)> get;
  std::function<bool(ExploredRun&, const std::string&)> set;
};

Column text(const char* name, std::string ExploredRun::*member) {
  return {name, [=](const ExploredRun& run) { return run.*member; },
          [=](ExploredRun& run, const std::string& value) {
            run.*member = value;
            return true;
          }};
}

/// The shortest text that reads as the same number: a run read back equals the run.
template <typename T>
Column number(const char* name, T ExploredRun::*member) {
  return {name, [=](const ExploredRun& run) { return fmt::format("{}", run.*member); },
          [=](ExploredRun& run, const std::string& value) {
            const char* end = value.data() + value.size();
            const auto [stop, error] = std::from_chars(value.data(), end, run.*member);
            return error == std::errc() && stop == end;
          }};
}

const std::vector<Column>& columns() {
  using R = ExploredRun;
  static const std::vector<Column> list = {text("key", &R::key),
                                           text("point", &R::point),
                                           text("changes", &R::changes),
                                           text("config", &R::config),
                                           text("scene", &R::scene),
                                           text("status", &R::status),
                                           number("triangles", &R::triangles),
                                           number("cycles", &R::cycles),
                                           number("time_ms", &R::time_ms),
                                           number("cycles_per_triangle", &R::cycles_per_triangle),
                                           number("bandwidth_gb_s", &R::bandwidth_gb_s),
                                           number("luts", &R::luts),
                                           number("registers", &R::registers),
                                           number("ram_kbits", &R::ram_kbits),
                                           number("area_65nm_mm2", &R::area_65nm_mm2),
                                           number("area_28nm_mm2", &R::area_28nm_mm2),
                                           number("machine_uj", &R::machine_uj),
                                           number("memory_uj", &R::memory_uj),
                                           number("energy_uj", &R::energy_uj),
                                           number("machine_power_w", &R::machine_power_w),
                                           text("tree_hash", &R::tree_hash)};
  return list;
}

std::vector<ExploredRun> read_runs(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return {};
  const std::string content{std::istreambuf_iterator<char>(file), {}};
  const auto rows = parse_csv(content, true);
  if (rows.empty()) return {};
  std::vector<std::string> names;
  for (const Column& column : columns()) names.emplace_back(column.name);
  if (rows[0] != names) {
    throw Failure{kBadInput, path + ": is no file of results of this version; give another --out"};
  }
  std::vector<ExploredRun> runs;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    if (rows[r].size() != names.size()) continue;
    ExploredRun run;
    bool good = true;
    for (std::size_t i = 0; i < names.size(); ++i) good &= columns()[i].set(run, rows[r][i]);
    if (good) runs.push_back(std::move(run));
  }
  return runs;
}

}  // namespace

std::string csv_header() {
  std::vector<std::string> names;
  for (const Column& column : columns()) names.emplace_back(column.name);
  return Table(std::move(names)).csv();
}

std::string csv_line(const ExploredRun& run) {
  std::vector<std::string> cells;
  for (const Column& column : columns()) {
    std::string& cell = cells.emplace_back(column.get(run));
    std::replace_if(
        cell.begin(), cell.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  }
  return Table(std::move(cells)).csv();
}

ResultsFile::ResultsFile(std::string path) : path_(std::move(path)) {
  if (path_.empty()) return;
  known_ = read_runs(path_);
  // Whole lines only, whatever the last one was.
  rewrite({});
}

ResultsFile::~ResultsFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

const ExploredRun* ResultsFile::find(const std::string& key) const {
  for (const ExploredRun& run : known_) {
    if (run.key == key) return &run;
  }
  return nullptr;
}

void ResultsFile::open() {
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (descriptor_ < 0) {
    throw Failure{kBadInput, fmt::format("{}: {}", path_, std::strerror(errno))};
  }
}

void ResultsFile::append(const ExploredRun& run) {
  if (path_.empty()) return;
  const std::string line = csv_line(run);
  // One write a line: a reader, and whoever ends the program, sees whole ones.
  if (::write(descriptor_, line.data(), line.size()) != static_cast<ssize_t>(line.size())) {
    const bool full = errno == ENOSPC || errno == EDQUOT || errno == EFBIG;
    throw Failure{full ? kResourceLimit : kBadInput,
                  fmt::format("{}: {}", path_, std::strerror(errno))};
  }
}

void ResultsFile::rewrite(const std::vector<ExploredRun>& runs) {
  if (path_.empty()) return;
  std::set<std::string> written;
  std::string content = csv_header();
  for (const std::vector<ExploredRun>* list : {&runs, &std::as_const(known_)}) {
    for (const ExploredRun& run : *list) {
      if (written.insert(run.key).second) content += csv_line(run);
    }
  }
  AtomicFile file = take(AtomicFile::create(path_));
  check(file.write(std::as_bytes(std::span(content.data(), content.size()))));
  check(file.commit());
  open();
}

}  // namespace fasttree::app
