// SPDX-License-Identifier: Apache-2.0
// Xingyu Liu, Yangdong Deng, Yufei Ni, Zonghui Li: FastTree: A Hardware KD-Tree Construction
// Acceleration Engine for Real-Time Ray Tracing. DATE 2015. Tables II and III, as printed.
#include "paper_tables.h"

#include <cmath>

namespace fasttree::app {
namespace {

constexpr PaperBuild kTable2[] = {{"Bunny", "bunny", 69451, 15.6, 5.1, 196},
                                  {"Sibenik", "sibenik", 79983, 20.1, 6.6, 152},
                                  {"Fairy forest", "fairy_forest", 169711, 33.0, 10.8, 92},
                                  {"Conference", "conference", 282751, 52.7, 17.2, 58},
                                  {"Dragon", "dragon", 871414, 160.2, 52.2, 19},
                                  {"Happy Buddha", "happy_buddha", 1087716, 200.9, 65.5, 15}};

constexpr PaperPlatform kTable3[] = {
    {"Shevtsov et al.", "Intel Core2 Duo x 2", "Bunny (69K)", 27, 3000, 16, "143 x 2", "65 x 2"},
    {"Choi et al.", "Intel Xeon X7550 x 4", "Bunny (69K)", 50, 2000, 45, "684 x 4", "130 x 4"},
    {"Wu et al.", "NVIDIA GeForce GTX280", "Bunny (69K)", 59, 48, 55, "576", "236"},
    {"RayCore", "ASIC", "Transparent Shadows (64K)", kRayCoreMs, 500, 28, "1.6", "1"},
    {"FastTree", "ASIC 65 nm", "Bunny (69K)", 5.1, 500, 65, "5.4", "3.9"},
    {"FastTree", "ASIC scaled to 28 nm", "Bunny (69K)", 5.1, 500, 28, "at most 1.4", "0.8"}};

/// So far may the count of triangles be off, as a share.
constexpr double kSameScene = 0.01;

}  // namespace

std::span<const PaperBuild> paper_table2() {
  return kTable2;
}

std::span<const PaperPlatform> paper_table3() {
  return kTable3;
}

const PaperBuild* paper_build(const std::string& file_stem, std::uint64_t triangles) {
  for (const PaperBuild& row : kTable2) {
    if (file_stem != row.file) continue;
    const double share = static_cast<double>(triangles) / static_cast<double>(row.triangles);
    return std::abs(share - 1) <= kSameScene ? &row : nullptr;
  }
  return nullptr;
}

}  // namespace fasttree::app
