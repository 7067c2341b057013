// SPDX-License-Identifier: Apache-2.0
#include "model/fasttree2/control.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace fasttree::model::ft2 {

namespace {

constexpr std::uint64_t kLookEvery = 1 << 12;    ///< cycles between looks at limits and progress
constexpr std::uint64_t kReportEvery = 1 << 16;  ///< cycles between calls of the progress callback

Registers make_registers(const HostPlan& plan, std::uint32_t triangles,
                         const FastTree2Config& config, const Faults& faults) {
  Registers r;
  r.config = config;
  r.layout = plan.layout;
  r.faults = faults;
  r.triangles = triangles;
  return r;
}

}  // namespace

Machine::Machine(const HostPlan& plan, std::uint32_t triangles, const FastTree2Config& config,
                 const Extras& extras, double clock_mhz, Memory& memory, ByteStore& store,
                 const SimulationOptions& options)
    : options_(options),
      plan_(plan),
      r_(make_registers(plan, triangles, config, extras.faults)),
      memory_(memory),
      dma_(memory, store, static_cast<std::uint64_t>(std::llround(1e6 / clock_mhz))),
      to_bounds_(config.queue_depth),
      to_codes_(config.queue_depth),
      to_first_(config.queue_depth),
      to_second_(config.queue_depth),
      ready_(config.ready_buckets),
      pool_(r_, dma_),
      reader_(r_, dma_, to_bounds_, to_codes_),
      bound_(r_, to_bounds_),
      codes_(r_, to_codes_, to_first_),
      first_("write_combiner", r_, dma_, pool_, to_first_, config.buckets, true),
      second_("write_combiner2", r_, dma_, pool_, to_second_, config.sub_buckets, false),
      walker_(r_, dma_, pool_, first_, second_, to_second_, ready_),
      emitter_(r_, dma_, order_, lanes_),
      timeline_(units_, options.timeline_windows),
      given_(extras.given_bounds.value_or(plan.bounds)) {
  WritePort& ids = dma_.add_write("ids", config.write_buffer_bytes);
  for (std::uint32_t i = 0; i < config.lanes; ++i) {
    lanes_.push_back(
        std::make_unique<BucketLane>("lane" + std::to_string(i), r_, dma_, pool_, order_, ids));
  }
  // The dma comes first: it begins the cycle.
  units_ = {&dma_, &reader_, &bound_, &codes_, &first_, &pool_, &walker_, &second_};
  for (const auto& lane : lanes_) units_.push_back(lane.get());
  units_.push_back(&emitter_);
}

void Machine::begin_stage(const char* name) {
  for (Unit* unit : units_) unit->begin_stage();
  StageRecord& stage = stages_.emplace_back();
  stage.name = name;
  stage.begin_cycle = r_.cycle;
  moved_.clear();
  for (const auto& p : dma_.read_ports()) moved_.push_back(p->moved_bytes());
  for (const auto& p : dma_.write_ports()) moved_.push_back(p->moved_bytes());
}

void Machine::end_stage() {
  StageRecord& stage = stages_.back();
  stage.end_cycle = r_.cycle;
  std::size_t i = 0;
  const auto note = [&](const Port& port, bool write) {
    const std::uint64_t bytes = port.moved_bytes() - moved_[i++];
    if (bytes == 0) return;
    // The lanes' readers have one purpose.
    const std::string purpose = port.purpose().substr(0, port.purpose().find(" of lane"));
    auto at = std::find_if(stage.traffic.begin(), stage.traffic.end(),
                           [&](const Traffic& t) { return t.purpose == purpose; });
    if (at == stage.traffic.end()) at = stage.traffic.insert(at, {purpose, 0, 0});
    (write ? at->write_bytes : at->read_bytes) += bytes;
  };
  for (const auto& p : dma_.read_ports()) note(*p, false);
  for (const auto& p : dma_.write_ports()) note(*p, true);
}

void Machine::set_grid(const Box3& bounds) {
  r_.levels = CellLevels(Grid(bounds, r_.config.axes, plan_.depth));
  r_.bucket_bits = std::min<int>(std::bit_width(r_.config.buckets) - 1, r_.levels.depth());
  r_.records = RecordFormat(r_.triangles, r_.levels.bits_below(r_.bucket_bits));
  r_.chunks = {r_.config.chunk_bytes, r_.config.combine_bytes, r_.records.bytes()};
}

std::string Machine::who_waits() const {
  std::string text;
  for (const Unit* unit : units_) {
    const std::string reason = unit->waits_for();
    if (!reason.empty()) text += "; " + unit->name() + " waits for " + reason;
  }
  return text.empty() ? "; nobody says what it waits for" : text;
}

Status Machine::look_round(double fraction) {
  if (!r_.failure.empty()) return {StatusCode::bad_input, "fasttree-2: " + r_.failure};
  if (options_.max_cycles != 0 && r_.cycle >= options_.max_cycles) {
    return {StatusCode::resource_limit,
            "fasttree-2: not ready after " + std::to_string(r_.cycle) + " cycles"};
  }
  std::uint64_t busy = 0;
  for (const Unit* unit : units_) busy += unit->activity().back().busy_cycles;
  if (busy != last_busy_) {
    last_busy_ = busy;
    last_progress_ = r_.cycle;
  } else if (r_.cycle - last_progress_ > r_.config.stuck_cycles) {
    return {StatusCode::resource_limit, "fasttree-2 is stuck in " + stages_.back().name +
                                            " since cycle " + std::to_string(last_progress_) +
                                            who_waits()};
  }
  if (options_.progress && r_.cycle % kReportEvery == 0 &&
      !options_.progress(stages_.back().name.c_str(), std::clamp(fraction, 0.0, 1.0))) {
    return {StatusCode::cancelled, "the simulation was cancelled"};
  }
  return {};
}

Status Machine::cycle(double fraction) {
  ++r_.cycle;
  for (Unit* unit : units_) unit->tick();
  if (sorting_) {
    dispatch();
    to_second_.clock();
    ready_.clock();
    for (const auto& lane : lanes_) lane->leaves().clock();
  } else {
    to_bounds_.clock();
    to_codes_.clock();
    to_first_.clock();
  }
  timeline_.clock(r_.cycle, dma_.moved_bytes());
  if (r_.cycle % kLookEvery == 0 || !r_.failure.empty()) return look_round(fraction);
  return {};
}

Status Machine::scene_bound() {
  begin_stage("scene_bound");
  reader_.begin(true, false);
  bound_.begin();
  while (!(reader_.done() && bound_.done())) {
    if (Status s = cycle(0.4 * reader_.fraction()); !s.ok()) return s;
  }
  // Extents and scales: one divider for three axes.
  for (std::uint32_t i = 0; i < r_.config.divide_cycles; ++i) {
    if (Status s = cycle(0.4); !s.ok()) return s;
  }
  end_stage();
  return {};
}

Status Machine::morton_code(const Box3& bounds, bool check, bool& right) {
  begin_stage("morton_code");
  ++generations_;
  set_grid(bounds);
  reader_.begin(check, true);
  if (check) bound_.begin();
  codes_.begin();
  first_.begin(1u << r_.bucket_bits);
  pool_.begin(1u << r_.bucket_bits);
  bool abandoned = false;
  bool told = false;
  while (!(reader_.done() && codes_.done() && first_.done() && (!check || bound_.done()) &&
           (told || abandoned))) {
    if (Status s = cycle(0.4 + 0.3 * reader_.fraction()); !s.ok()) return s;
    if (!told && reader_.done() && codes_.done() && to_codes_.empty()) {
      first_.finish();
      told = true;
    }
    // A triangle outside the given bounds, or more records than right bounds can make: what is left
    // of the pass finds the right ones.
    if (check && !abandoned &&
        (pool_.exhausted() || (reader_.sent() % 64 == 0 && bound_.outside(bounds)))) {
      abandoned = true;
      reader_.bounds_only();
      codes_.abandon();
      first_.abandon();
    }
    if (!check && pool_.exhausted()) {
      return {StatusCode::resource_limit, "fasttree-2: all chunks of memory are in use"};
    }
  }
  right = !check || (!abandoned && bound_.bounds() == bounds);
  while (!dma_.done()) {
    if (Status s = cycle(0.7); !s.ok()) return s;
  }
  r_.references = codes_.references();
  end_stage();
  return {};
}

void Machine::dispatch() {
  if (!ready_.valid()) return;
  // An idle lane first, then one that is at the end of its bucket.
  for (const bool only_free : {true, false}) {
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      const std::size_t l = (next_lane_ + i) % lanes_.size();
      if (only_free ? !lanes_[l]->free() : !lanes_[l]->can_accept()) continue;
      if (!lanes_[l]->can_accept()) continue;
      lanes_[l]->accept(ready_.pop(), order_.next_ticket++);
      next_lane_ = (l + 1) % lanes_.size();
      return;
    }
  }
}

Status Machine::sort_and_emit() {
  begin_stage("radix_sort");
  if (r_.references > r_.layout.id_slots) {
    return {StatusCode::resource_limit, "fasttree-2: more references than there is room for"};
  }
  order_ = BucketOrder();
  order_.id_end = r_.references;
  sorting_ = true;
  walker_.begin();
  emitter_.begin();
  const auto lanes_done = [&] {
    return std::all_of(lanes_.begin(), lanes_.end(), [](const auto& l) { return l->done(); });
  };
  bool told = false;
  while (!(told && emitter_.done() && dma_.done())) {
    if (Status s = cycle(0.7 + 0.3 * walker_.fraction()); !s.ok()) return s;
    if (pool_.exhausted()) {
      return {StatusCode::resource_limit, "fasttree-2: all chunks of memory are in use"};
    }
    if (!told && walker_.done() && ready_.empty() && lanes_done()) {
      emitter_.finish();
      told = true;
    }
  }
  sorting_ = false;
  if (!r_.failure.empty()) return {StatusCode::bad_input, "fasttree-2: " + r_.failure};
  if (order_.id_end != 0) {
    return {StatusCode::bad_input, "fasttree-2: " + std::to_string(order_.id_end) +
                                       " references were counted and never placed"};
  }
  end_stage();
  return {};
}

Status Machine::build() {
  Box3 bounds = given_;
  for (std::size_t a = 0; a < 3; ++a) {
    bounds.lo[a] += 0.0f;  // minus zero becomes plus zero
    bounds.hi[a] += 0.0f;
  }
  const bool given = r_.config.bounds_given && r_.triangles > 0;
  if (!given) {
    if (Status s = scene_bound(); !s.ok()) return s;
    bounds = bound_.bounds();
  }
  bool right = true;
  if (Status s = morton_code(bounds, given, right); !s.ok()) return s;
  if (!right) {
    if (Status s = morton_code(bound_.bounds(), false, right); !s.ok()) return s;
  }
  return sort_and_emit();
}

void Machine::report(SimulationResult& result) {
  result.cycles = r_.cycle;
  result.triangles = r_.triangles;
  result.references = r_.references;
  result.leaves = emitter_.leaves();
  result.stages = stages_;
  for (const Unit* unit : units_) {
    UnitRecord& record = result.units.emplace_back();
    record.name = unit->name();
    record.kind = unit->kind();
    record.stall_reasons = unit->stall_reasons();
    // The first entry is that before any stage.
    record.by_stage.assign(unit->activity().begin() + 1, unit->activity().end());
  }
  result.timeline = timeline_.finish(r_.cycle, dma_.moved_bytes());
  result.memory_traits = memory_.traits();
  result.memory = memory_.statistics();
}

Figures Machine::figures() const {
  Figures f;
  f.records = codes_.records();
  f.record_bytes = r_.records.bytes();
  f.partitions = walker_.partitions();
  f.partitioned_records = walker_.partitioned_records();
  f.most_chunks = pool_.most_chunks();
  f.plane_hits = emitter_.planes().hits();
  f.plane_misses = emitter_.planes().misses();
  f.most_stacked = walker_.most_stacked();
  f.generations = generations_;
  return f;
}

}  // namespace fasttree::model::ft2
