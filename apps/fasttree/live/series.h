// SPDX-License-Identifier: Apache-2.0
// Times of many frames, in bounded memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace fasttree::live {

/// The last values of a figure.
class Series {
 public:
  static constexpr std::size_t kKept = 4096;

  void add(double value) {
    if (values_.size() < kKept) {
      values_.push_back(value);
    } else {
      values_[next_] = value;
    }
    next_ = (next_ + 1) % kKept;
  }

  /// Of all that is kept; 0 where nothing is.
  double median() const {
    if (values_.empty()) return 0;
    std::vector<double> sorted = values_;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t half = sorted.size() / 2;
    return sorted.size() % 2 == 1 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2;
  }

  double worst() const {
    return values_.empty() ? 0 : *std::max_element(values_.begin(), values_.end());
  }

  /// Mean of the last few, for a figure on screen that can be read.
  double recent() const {
    constexpr std::size_t kFew = 16;
    const std::size_t count = std::min(kFew, values_.size());
    double sum = 0;
    for (std::size_t i = 1; i <= count; ++i) sum += values_[(next_ + kKept - i) % kKept];
    return count > 0 ? sum / static_cast<double>(count) : 0;
  }

 private:
  std::vector<double> values_;
  std::size_t next_ = 0;
};

}  // namespace fasttree::live
