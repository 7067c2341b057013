// SPDX-License-Identifier: Apache-2.0
// What a program's benches have reached in the RTL, in one file; in builds with
// FASTTREE_RTL_COVERAGE, else nothing.
#pragma once

#include <verilated.h>

namespace fasttree::rtl {

/// Adds the counts of a bench that ends to those of the benches before it. At the program's end all
/// are in the file PID.dat of the folder $FASTTREE_RTL_COVERAGE, in the format of
/// verilator_coverage.
#ifdef FASTTREE_RTL_COVERAGE
void add_coverage(VerilatedContext& context);
#else
inline void add_coverage(VerilatedContext&) {}
#endif

}  // namespace fasttree::rtl
