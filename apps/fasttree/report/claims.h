// SPDX-License-Identifier: Apache-2.0
// Figures that the paper gives in its text, beside ours.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace fasttree::app {

struct Evaluation;

struct Claim {
  std::string what;
  std::string unit;
  double paper = 0;
  std::optional<double> ours;  ///< none: the scene that it is about is not here
  int digits = 1;
  std::string reason;
  /// Ours is ours on a scene of the paper: else there is nothing to divide.
  bool comparable = true;

  std::optional<double> ratio() const {
    return comparable && ours ? std::optional(*ours / paper) : std::nullopt;
  }
};

/// From what an evaluation has found so far: table1 and the scenes.
std::vector<Claim> claims_of(const Evaluation& evaluation);

}  // namespace fasttree::app
