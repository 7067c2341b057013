// SPDX-License-Identifier: Apache-2.0
#include "model/config/memory_fields.h"

namespace fasttree::model {
namespace {

Fields<DramSpec> dram_fields() {
  using D = DramSpec;
  Fields<D> f;
  f.power_of_two("channels", &D::channels, 1, 8, "Independent channels");
  f.power_of_two("channel_bits", &D::channel_bits, 8, 128, "Data bits of a channel");
  f.power_of_two("banks", &D::banks, 1, 16, "Banks of a channel");
  f.power_of_two("rows", &D::rows, 1, 1 << 20, "Rows of a bank");
  f.power_of_two("columns", &D::columns, 8, 1 << 16, "Columns of a row, each of channel_bits");
  f.count("tck_ps", &D::tck_ps, 100, 100000, "A clock; two transfers each");
  f.power_of_two("burst_length", &D::burst_length, 2, 32, "Transfers of an access");
  f.count("cl_clocks", &D::cl, 1, 255, "Read to its first data");
  f.count("cwl_clocks", &D::cwl, 1, 255, "Write to its first data");
  f.count("trcd_clocks", &D::trcd, 1, 255, "Activate to read or write");
  f.count("trp_clocks", &D::trp, 1, 255, "Precharge to activate or refresh");
  f.count("tras_clocks", &D::tras, 1, 255, "Activate to precharge");
  f.count("trc_clocks", &D::trc, 1, 511, "Activate to activate of the same bank");
  f.count("trrd_clocks", &D::trrd, 1, 255, "Activate to activate of another bank");
  f.count("tfaw_clocks", &D::tfaw, 1, 511, "Window that holds at most four activates");
  f.count("twtr_clocks", &D::twtr, 1, 255, "Last data written to the next read");
  f.count("twr_clocks", &D::twr, 1, 255, "Last data written to precharge");
  f.count("trtp_clocks", &D::trtp, 1, 255, "Read to precharge");
  f.count("tccd_clocks", &D::tccd, 1, 255, "Read to read, write to write");
  f.count("trtw_gap_clocks", &D::trtw_gap, 0, 255,
          "Data bus left free between data read and data written");
  f.count("trefi_clocks", &D::trefi, 16, 1 << 20, "Each bank is refreshed once in this time");
  f.count("trfc_ab_clocks", &D::trfc_ab, 1, 4095, "A refresh of all banks");
  f.count("trfc_pb_clocks", &D::trfc_pb, 1, 4095, "A refresh of one bank");
  return f;
}

Fields<ControllerConfig> controller_fields() {
  using C = ControllerConfig;
  Fields<C> f;
  f.choice("interleave", &C::interleave, {"burst", "row"},
           "Channels change with every burst, or every row_interleave_bytes");
  f.power_of_two(
      "row_interleave_bytes", &C::row_interleave_bytes, 32, 1 << 30,
      "Block of one channel under interleave = \"row\": at the start, a row of each bank");
  f.choice("address_order", &C::address_order, {"row_bank_column", "bank_row_column"},
           "From the highest address bits to the lowest, inside a channel");
  f.flag("bank_hash", &C::bank_hash,
         "Bank exclusive-or row, so that arrays a power of two apart do not share banks");
  f.count("read_queue", &C::read_queue, 1, 64, "Reads that wait in a channel");
  f.count("write_queue", &C::write_queue, 1, 64, "Writes that wait in a channel");
  f.count("write_drain_high", &C::write_drain_high, 1, 64,
          "So many writes waiting: the channel turns to writing");
  f.count("write_drain_low", &C::write_drain_low, 0, 63,
          "So few writes waiting: it turns back, if reads wait");
  f.count("write_idle_clocks", &C::write_idle_clocks, 0, 1 << 20,
          "So long without a read: it writes what waits");
  f.count("starvation_clocks", &C::starvation_clocks, 1, 1 << 20,
          "A request that waited so long is no more overtaken");
  f.choice("refresh", &C::refresh, {"none", "all_bank", "per_bank"},
           "All banks at once, or one after the other");
  f.count("refresh_postpone", &C::refresh_postpone, 0, 8,
          "Refresh commands owed before requests have to wait for them");
  return f;
}

}  // namespace

Fields<MemoryConfig> memory_fields() {
  using M = MemoryConfig;
  Fields<M> f;
  f.choice("preset", &M::preset, memory_presets(), "Sets every key below, where it is not given");
  f.choice("kind", &M::kind, {"ideal", "fixed", "dram"},
           "No time at all, a fixed latency, or banks and rows");
  f.power_of_two("access_bytes", &M::access_bytes, 8, 256, "ideal, fixed: bytes of an access");
  f.real("latency_ns", &M::latency_ns, 0, 1e6, "fixed: from request to data");
  f.real("bandwidth_gb_s", &M::bandwidth_gb_s, 0, 1e4, "fixed: 10^9 bytes a second; 0: unlimited");
  f.count("fixed_queue", &M::fixed_queue, 1, 65536, "fixed: requests under way");
  f.include(&M::dram, dram_fields());
  f.include(&M::controller, controller_fields());
  return f;
}

}  // namespace fasttree::model
