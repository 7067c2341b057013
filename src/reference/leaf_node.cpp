// SPDX-License-Identifier: Apache-2.0
#include "reference/leaf_node.h"

namespace fasttree::reference {

LeafTable leaf_node(const References& sorted) {
  LeafTable leaves;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i == 0 || sorted.codes[i - 1] != sorted.codes[i]) {
      leaves.code.push_back(sorted.codes[i]);
      leaves.first.push_back(static_cast<std::uint32_t>(i));
    }
  }
  leaves.count.resize(leaves.size());
  for (std::size_t j = 0; j < leaves.size(); ++j) {
    const std::size_t end = j + 1 < leaves.size() ? leaves.first[j + 1] : sorted.size();
    leaves.count[j] = static_cast<std::uint32_t>(end - leaves.first[j]);
  }
  return leaves;
}

}  // namespace fasttree::reference
