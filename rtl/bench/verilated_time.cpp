// SPDX-License-Identifier: Apache-2.0
// Time for $time in verilated code: nothing in the RTL uses it.
double sc_time_stamp() {
  return 0;
}
