// SPDX-License-Identifier: Apache-2.0
// The exact builder. A candidate plane lies where the box of a triangle's part inside the cell
// begins or ends. These events are sorted once per axis; a split deals the sorted lists out to the
// children, and only triangles that straddle the plane get new events, which are merged in.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "baseline/baseline.h"
#include "baseline/grow_tree.h"
#include "baseline/memory_budget.h"
#include "baseline/split_cost.h"
#include "baseline/triangle_clip.h"

namespace fasttree {
namespace baseline {
namespace {

/// What happens at a position. At equal positions the sweep has to see them in this order.
enum EventType : std::uint32_t { kEnd = 0, kPlanar = 1, kStart = 2 };

/// An event in 64 bits, so that sorting integers sorts by position, then type, then triangle:
/// bits 32..63 the position in the order of the reals, 30..31 the type, 0..29 the triangle.
using Event = std::uint64_t;

std::uint32_t ordered_bits(float position) {
  const auto bits = std::bit_cast<std::uint32_t>(position + 0.0f);  // -0 becomes +0
  return bits >> 31 != 0 ? ~bits : bits | 0x80000000u;
}

float position_of(std::uint32_t ordered) {
  return std::bit_cast<float>(ordered >> 31 != 0 ? ordered & 0x7fffffffu : ~ordered);
}

Event make_event(float position, EventType type, std::uint32_t triangle) {
  return Event{ordered_bits(position)} << 32 | Event{type} << 30 | triangle;
}

std::uint32_t ordered_position(Event e) {
  return static_cast<std::uint32_t>(e >> 32);
}
EventType type_of(Event e) {
  return static_cast<EventType>(e >> 30 & 3);
}
std::uint32_t triangle_of(Event e) {
  return static_cast<std::uint32_t>(e & 0x3fffffffu);
}

/// One list for each axis.
using EventLists = std::array<std::vector<Event>, 3>;

enum class Side : std::uint8_t { both, lower, upper };

class ExactSplitter {
 public:
  ExactSplitter(const BaselineInput& input, MemoryBudget& budget)
      : input_(input), budget_(budget) {}

  Status prepare() {
    const std::size_t n = input_.mesh.triangle_count;
    if (Status status = budget_.reserve(side_, n); !status.ok()) return status;
    side_.resize(n);
    for (auto& list : events_) {
      if (Status status = budget_.reserve(list, 2 * n); !status.ok()) return status;
    }
    for (std::uint32_t t = 0; t < n; ++t) {
      Box3 box;
      for (const Vec3& p : input_.mesh.triangle(t)) box.include(p);
      add_events(box, t, events_);
    }
    for (auto& list : events_) std::sort(list.begin(), list.end());
    begins_.push_back({0, 0, 0});
    return {};
  }

  /// Sweeps a plane along each axis and keeps count of the boxes on both sides.
  std::optional<Split> best_split(const OpenCell& cell) const {
    std::optional<Split> best;
    double best_cost = leaf_cost(cell.count, input_.costs);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const SplitCost cost(cell.box, axis, input_.costs);
      const std::uint32_t cell_lo = ordered_bits(cell.box.lo[axis]);
      const std::uint32_t cell_hi = ordered_bits(cell.box.hi[axis]);
      std::uint64_t lower = 0;
      std::uint64_t upper = cell.count;
      const Event* event = top(axis);
      const Event* const end = event + top_size(axis);
      while (event != end) {
        const std::uint32_t here = ordered_position(*event);
        std::array<std::uint64_t, 3> count{};
        do {
          ++count[type_of(*event)];
          ++event;
        } while (event != end && ordered_position(*event) == here);

        upper -= count[kEnd] + count[kPlanar];
        if (cell_lo < here && here < cell_hi) {
          const float position = position_of(here);
          const double to_upper = cost(position, lower, upper + count[kPlanar]);
          if (to_upper < best_cost) {
            best_cost = to_upper;
            best = Split{axis, position, false, lower, upper + count[kPlanar], to_upper};
          }
          const double to_lower =
              count[kPlanar] == 0 ? to_upper : cost(position, lower + count[kPlanar], upper);
          if (to_lower < best_cost) {
            best_cost = to_lower;
            best = Split{axis, position, true, lower + count[kPlanar], upper, to_lower};
          }
        }
        lower += count[kStart] + count[kPlanar];
      }
    }
    return best;
  }

  Status partition(const OpenCell& cell, Split& split) {
    classify(split);
    if (Status status = deal_out(); !status.ok()) return status;
    if (Status status = cut_straddlers(cell, split); !status.ok()) return status;
    if (Status status = merge_children(); !status.ok()) return status;
    split.lower_count = lower_count_;
    split.upper_count = upper_count_;
    return {};
  }

  void take(std::vector<std::uint32_t>& ids) {
    const std::size_t first = ids.size();
    const Event* event = top(0);
    const Event* const end = event + top_size(0);
    for (; event != end; ++event) {
      if (type_of(*event) != kEnd) ids.push_back(triangle_of(*event));
    }
    std::sort(ids.begin() + static_cast<std::ptrdiff_t>(first), ids.end());
    for (std::size_t a = 0; a < 3; ++a) events_[a].resize(begins_.back()[a]);
    begins_.pop_back();
  }

 private:
  const Event* top(std::size_t axis) const { return events_[axis].data() + begins_.back()[axis]; }
  std::size_t top_size(std::size_t axis) const {
    return events_[axis].size() - begins_.back()[axis];
  }

  static void add_events(const Box3& box, std::uint32_t triangle, EventLists& lists) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (box.lo[a] == box.hi[a]) {
        lists[a].push_back(make_event(box.lo[a], kPlanar, triangle));
      } else {
        lists[a].push_back(make_event(box.lo[a], kStart, triangle));
        lists[a].push_back(make_event(box.hi[a], kEnd, triangle));
      }
    }
  }

  /// Which side each of the top's triangles is on, from the split axis' events alone. Its start
  /// comes before its end, so a later verdict corrects the first.
  void classify(const Split& split) {
    const std::uint32_t plane = ordered_bits(split.position);
    lower_count_ = upper_count_ = 0;
    const Event* event = top(split.axis);
    const Event* const end = event + top_size(split.axis);
    for (; event != end; ++event) {
      const std::uint32_t here = ordered_position(*event);
      Side& side = side_[triangle_of(*event)];
      switch (type_of(*event)) {
        case kStart:
          side = here < plane ? Side::both : Side::upper;
          upper_count_ += here >= plane;
          break;
        case kPlanar:
          side =
              here < plane || (here == plane && split.planar_to_lower) ? Side::lower : Side::upper;
          (side == Side::lower ? lower_count_ : upper_count_) += 1;
          break;
        case kEnd:
          if (here <= plane) {
            side = Side::lower;
            ++lower_count_;
          }
          break;
      }
    }
  }

  /// Events of triangles on one side only, still sorted; those of straddlers are dropped.
  Status deal_out() {
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t size = top_size(a);
      for (auto* list : {&lower_[a], &upper_[a]}) {
        // Never shrunk: filled through pointers, and the kept part counted.
        if (list->size() >= size) continue;
        if (Status status = budget_.reserve(*list, size); !status.ok()) return status;
        list->resize(size);
      }
      const Event* event = top(a);
      const Event* const end = event + size;
      Event* lower = lower_[a].data();
      Event* upper = upper_[a].data();
      for (; event != end; ++event) {
        const Side side = side_[triangle_of(*event)];
        // Written to both, kept where it belongs: no branch to mispredict.
        *lower = *event;
        *upper = *event;
        lower += side == Side::lower;
        upper += side == Side::upper;
      }
      lower_kept_[a] = static_cast<std::size_t>(lower - lower_[a].data());
      upper_kept_[a] = static_cast<std::size_t>(upper - upper_[a].data());
    }
    return {};
  }

  Status cut_straddlers(const OpenCell& cell, const Split& split) {
    const Event* event = top(split.axis);
    const Event* const end = event + top_size(split.axis);
    const auto straddles = [&](Event e) {
      return type_of(e) == kStart && side_[triangle_of(e)] == Side::both;
    };
    const auto straddlers = static_cast<std::size_t>(std::count_if(event, end, straddles));
    for (auto* lists : {&lower_new_, &upper_new_}) {
      for (auto& list : *lists) {
        list.clear();
        if (Status status = budget_.reserve(list, 2 * straddlers); !status.ok()) return status;
      }
    }
    for (; event != end; ++event) {
      if (!straddles(*event)) continue;
      const std::uint32_t t = triangle_of(*event);
      const CutBounds parts =
          cut_bounds(input_.mesh.triangle(t), cell.box, split.axis, split.position);
      if (parts.in_lower) add_events(parts.lower, t, lower_new_);
      if (parts.in_upper) add_events(parts.upper, t, upper_new_);
      lower_count_ += parts.in_lower;
      upper_count_ += parts.in_upper;
    }
    for (auto* lists : {&lower_new_, &upper_new_}) {
      for (auto& list : *lists) std::sort(list.begin(), list.end());
    }
    return {};
  }

  /// Replaces the top by the upper child's events with the lower child's over them.
  Status merge_children() {
    std::array<std::size_t, 3> begin = begins_.back();
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t upper_size = upper_kept_[a] + upper_new_[a].size();
      const std::size_t size = begin[a] + upper_size + lower_kept_[a] + lower_new_[a].size();
      if (Status status = budget_.reserve(events_[a], size); !status.ok()) return status;
      events_[a].resize(size);
      Event* out = events_[a].data() + begin[a];
      out = std::merge(upper_[a].data(), upper_[a].data() + upper_kept_[a], upper_new_[a].begin(),
                       upper_new_[a].end(), out);
      std::merge(lower_[a].data(), lower_[a].data() + lower_kept_[a], lower_new_[a].begin(),
                 lower_new_[a].end(), out);
      begin[a] += upper_size;
    }
    begins_.push_back(begin);
    return {};
  }

  const BaselineInput& input_;
  MemoryBudget& budget_;

  EventLists events_;                               ///< of all open cells
  std::vector<std::array<std::size_t, 3>> begins_;  ///< where each open cell's events begin
  std::vector<Side> side_;                          ///< by triangle, of the cell being split

  // Scratch of one split, kept for the next.
  EventLists lower_, upper_;
  std::array<std::size_t, 3> lower_kept_{}, upper_kept_{};
  EventLists lower_new_, upper_new_;
  std::uint64_t lower_count_ = 0, upper_count_ = 0;
};

}  // namespace
}  // namespace baseline

Result<Tree> build_sah_exact(const BaselineInput& input) {
  return baseline::build_with<baseline::ExactSplitter>(input, Profile::sah_exact, "sah_exact");
}

}  // namespace fasttree
