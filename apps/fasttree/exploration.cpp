// SPDX-License-Identifier: Apache-2.0
#include "exploration.h"

#include <fmt/format.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <thread>

#include "model/report/area.h"
#include "model/report/energy.h"
#include "model/report/simulate.h"
#include "progress.h"
#include "tree/xxh3.h"

namespace fasttree::app {
namespace {

using model::MachineConfig;
using Clock = std::chrono::steady_clock;

void add_text(Xxh3& hash, const std::string& text) {
  hash.bytes(std::as_bytes(std::span(text.data(), text.size() + 1)));
}

std::string key_of(const MachineConfig& config, const ExploredScene& scene) {
  Xxh3 hash;
  add_text(hash, FASTTREE_VERSION);
  add_text(hash, model::to_toml(config));
  const std::array<std::uint64_t, 2> words{scene.hash, scene.scene.view.triangle_count};
  hash.bytes(std::as_bytes(std::span(words)));
  return hash_string(hash.digest());
}

void set_costs(ExploredRun& run, const MachineConfig& config,
               const model::SimulationResult& result) {
  const model::AreaReport area = model::area(config);
  const model::EnergyReport energy = model::energy(config, result);
  run.cycles = result.cycles;
  run.time_ms = result.time_ms();
  run.cycles_per_triangle =
      static_cast<double>(result.cycles) / std::max<double>(1, static_cast<double>(run.triangles));
  const auto bytes = static_cast<double>(result.memory.read_bytes + result.memory.write_bytes);
  run.bandwidth_gb_s = run.time_ms > 0 ? bytes / (run.time_ms * 1e6) : 0;
  run.luts = area.total.luts;
  run.registers = area.total.registers;
  run.ram_kbits = area.total.ram_kbits;
  run.area_65nm_mm2 = area.mm2_65nm;
  run.area_28nm_mm2 = area.mm2_28nm;
  run.machine_uj = energy.machine_pj * 1e-6;
  run.memory_uj = energy.memory_pj * 1e-6;
  run.energy_uj = run.machine_uj + run.memory_uj;
  run.machine_power_w = energy.machine_power_w;
  run.tree_hash = hash_string(result.tree.hash());
  for (const model::StageRecord& stage : result.stages) {
    run.stages.emplace_back(stage.name, stage.end_cycle - stage.begin_cycle);
  }
}

/// Runs that wait for a core and for memory, and what has become of each.
class Crew {
 public:
  struct Job {
    std::size_t slot = 0;
    const DesignPoint* point = nullptr;
    const ExploredScene* scene = nullptr;
    std::uint64_t bytes = 0;
    std::atomic<double> fraction{0};
  };

  Crew(std::vector<std::unique_ptr<Job>> jobs, std::vector<std::optional<ExploredRun>>& slots,
       ResultsFile& file, std::uint64_t memory_bytes, std::uint32_t timeline_windows)
      : jobs_(std::move(jobs)),
        slots_(slots),
        file_(file),
        timeline_windows_(timeline_windows),
        free_bytes_(memory_bytes) {
    for (const auto& job : jobs_) all_work_ += work_of(*job);
  }

  /// Returns when all are done or cancelled.
  void run(Context& context, std::size_t points) {
    std::vector<std::thread> threads;
    const std::size_t count =
        std::min<std::size_t>(static_cast<std::size_t>(context.threads), jobs_.size());
    for (std::size_t i = 0; i < count; ++i) threads.emplace_back([this] { work(); });
    const ProgressCallback progress = context.progress.callback("exploring:");
    {
      std::unique_lock lock(mutex_);
      while (finished_ < jobs_.size() && !stop_) {
        changed_.wait_for(lock, std::chrono::milliseconds(100));
        double fraction = done_work_;
        for (const auto& job : jobs_) fraction += work_of(*job) * job->fraction;
        fraction /= std::max(all_work_, 1.0);
        const std::string text = fmt::format("{} of {} runs{}", finished_, points, left(fraction));
        lock.unlock();
        const bool go_on = progress(text.c_str(), fraction);
        lock.lock();
        if (!go_on) stop_ = true;
      }
    }
    changed_.notify_all();
    for (std::thread& thread : threads) thread.join();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  static double work_of(const Job& job) {
    return static_cast<double>(job.scene->scene.view.triangle_count) + 100;
  }

  std::string left(double fraction) const {
    const double seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
    if (fraction <= 0.01 || seconds < 1) return "";
    const auto rest = static_cast<long>(seconds / fraction * (1 - fraction)) + 1;
    return rest < 90 ? fmt::format(", {} s left", rest) : fmt::format(", {} min left", rest / 60);
  }

  void work() {
    // The library's own loops stay on this thread.
    oneapi::tbb::task_arena arena(1);
    arena.execute([this] {
      while (Job* job = next()) {
        try {
          finish(*job, simulate(*job));
        } catch (...) {
          const std::lock_guard lock(mutex_);
          if (!failure_) failure_ = std::current_exception();
          stop_ = true;
          changed_.notify_all();
          return;
        }
      }
    });
  }

  /// The next one for which there is memory, in order; null at the end.
  Job* next() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] {
      return stop_ || next_ == jobs_.size() || jobs_[next_]->bytes <= free_bytes_;
    });
    if (stop_ || next_ == jobs_.size()) return nullptr;
    Job& job = *jobs_[next_++];
    free_bytes_ -= job.bytes;
    return &job;
  }

  /// Nothing where it was cancelled.
  std::optional<ExploredRun> simulate(Job& job) const {
    ExploredRun run = *slots_[job.slot];
    model::SimulationOptions options;
    options.timeline_windows = timeline_windows_;
    options.progress = [&](const char*, double fraction) {
      job.fraction = fraction;
      return !stop_ && !cancelled();
    };
    auto result = model::simulate(job.scene->scene.view, job.point->config, options);
    if (result.status().code() == StatusCode::cancelled) return std::nullopt;
    run.status = result.ok() ? "done" : "refused: " + result.status().message();
    if (!result.ok()) return run;
    set_costs(run, job.point->config, result.value());
    if (timeline_windows_ > 0) {
      result.value().tree = Tree();
      run.account = std::make_shared<const model::SimulationResult>(std::move(result).value());
    }
    return run;
  }

  void finish(Job& job, std::optional<ExploredRun> run) {
    const std::lock_guard lock(mutex_);
    free_bytes_ += job.bytes;
    job.fraction = 0;
    if (run) {
      file_.append(*run);
      slots_[job.slot] = std::move(run);
      done_work_ += work_of(job);
      ++finished_;
    } else {
      stop_ = true;
    }
    changed_.notify_all();
  }

  std::vector<std::unique_ptr<Job>> jobs_;
  std::vector<std::optional<ExploredRun>>& slots_;
  ResultsFile& file_;
  std::uint32_t timeline_windows_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t free_bytes_;
  std::size_t next_ = 0, finished_ = 0;
  double all_work_ = 0, done_work_ = 0;
  std::atomic<bool> stop_{false};
  std::exception_ptr failure_;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace

std::vector<ExploredScene> load_scenes(Context& context, const std::vector<std::string>& names) {
  std::vector<ExploredScene> scenes;
  for (const std::string& name : names) {
    ExploredScene scene{name, load_scene(context, name, most_of_memory()), 0};
    check(validate(scene.scene.view));
    Xxh3 hash;
    for (std::uint32_t t = 0; t < scene.scene.view.triangle_count; ++t) {
      const std::array<Vec3, 3> corners = scene.scene.view.triangle(t);
      hash.bytes(std::as_bytes(std::span(corners)));
    }
    scene.hash = hash.digest();
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

std::uint64_t simulation_bytes(const MachineConfig& config, std::uint64_t triangles) {
  const double growth = config.architecture == "fasttree-2" ? config.fasttree2.max_growth
                                                            : config.paper.grid.max_growth;
  // Nine floats a triangle; a reference is in two arrays of pairs, a sorted one, tables of leaves
  // and nodes, and in the tree that comes out. Beside them queues and counters.
  const double bytes = static_cast<double>(triangles) * (36 + growth * 112) + (32 << 20);
  return static_cast<std::uint64_t>(bytes);
}

Exploration explore(Context& context, const std::vector<DesignPoint>& points,
                    const std::vector<ExploredScene>& scenes, ResultsFile& file,
                    std::uint64_t memory_bytes, std::uint32_t timeline_windows) {
  std::vector<std::optional<ExploredRun>> slots;
  std::vector<std::unique_ptr<Crew::Job>> jobs;
  std::map<std::string, std::size_t> first_of;  // slots of the same configuration and scene
  std::vector<std::size_t> same_as;
  Exploration result;
  for (const DesignPoint& point : points) {
    for (const ExploredScene& scene : scenes) {
      const std::size_t slot = slots.size();
      ExploredRun run;
      run.key = key_of(point.config, scene);
      run.triangles = scene.scene.view.triangle_count;
      const auto [first, is_new] = first_of.try_emplace(run.key, slot);
      same_as.push_back(first->second);
      const ExploredRun* known = file.find(run.key);
      if (known != nullptr) run = *known;
      run.point = point.label;
      run.changes = fmt::format("{}", fmt::join(point.changes, " "));
      run.config = point.config.name;
      run.scene = scene.name;
      slots.push_back(std::move(run));
      if (known != nullptr) {
        ++result.resumed;
      } else if (is_new) {
        auto job = std::make_unique<Crew::Job>();
        job->slot = slot;
        job->point = &point;
        job->scene = &scene;
        job->bytes = simulation_bytes(point.config, scene.scene.view.triangle_count);
        if (job->bytes > memory_bytes) {
          throw Failure{kResourceLimit,
                        fmt::format("{} may take {} bytes to simulate, more than the limit of {}; "
                                    "use a smaller scene or raise --memory-limit",
                                    scene.name, job->bytes, memory_bytes)};
        }
        jobs.push_back(std::move(job));
      }
    }
  }
  const std::size_t made = jobs.size();
  Crew(std::move(jobs), slots, file, memory_bytes, timeline_windows).run(context, made);
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const ExploredRun& first = *slots[same_as[i]];
    if (first.status.empty()) {
      result.cancelled = true;
      continue;
    }
    ExploredRun run = first;
    run.point = slots[i]->point;
    run.changes = slots[i]->changes;
    run.config = slots[i]->config;
    run.scene = slots[i]->scene;
    result.runs.push_back(std::move(run));
  }
  file.rewrite(result.runs);
  return result;
}

}  // namespace fasttree::app
