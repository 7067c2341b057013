// SPDX-License-Identifier: Apache-2.0
// Bars for a page: the picture is SVG that stretches with the page, labels and values are text
// beside it, so that they can be read at any width. The colours are those of the page's stages.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace fasttree::report {

/// A length of a bar, coloured as entry `colour` of the legend.
struct BarPart {
  std::size_t colour = 0;
  double value = 0;
};

struct Bar {
  std::string label;
  std::vector<BarPart> parts;
  std::string text;  ///< what stands at the bar's end
  bool measured = false;
};

/// Bars that share a scale.
struct BarGroup {
  std::string title;  ///< empty: none
  std::vector<Bar> bars;
};

/// Parts end to end from the left. Entries of the legend without a name are left out of it. The
/// longest bar fills the width: of its group, or of all groups where `one_scale` says so.
std::string stacked_bars(const std::vector<std::string>& legend, const std::string& unit,
                         const std::vector<BarGroup>& groups, bool one_scale);

/// What a change of a key does, in per cent.
struct TornadoBar {
  std::string value;  ///< that the key was changed to
  double percent = 0;
};
struct TornadoRow {
  std::string label;
  std::vector<TornadoBar> bars;  ///< one or more
};

/// Bars from a common middle: less to the left, more to the right. `what` changes.
std::string tornado(const std::string& what, const std::vector<TornadoRow>& rows);

}  // namespace fasttree::report
