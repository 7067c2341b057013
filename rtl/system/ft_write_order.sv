// SPDX-License-Identifier: Apache-2.0
// The words of 8 bytes that one client writes and memory has not answered for yet. AXI keeps no
// order between a write and a later read, so that a read has to wait for those it must see.
module ft_write_order #(
    parameter int ENTRIES = 8  // a power of two
) (
    input  logic               clk,
    input  logic               rst,
    output logic               ready,     // there is room for one more
    input  logic               push,      // a write was queued
    input  logic [31:3]        push_addr,
    input  logic               sent,      // the oldest one queued went to memory
    input  logic               dropped,   // or will not go there: only while `settled`
    input  logic               answered,  // the oldest one sent has taken effect
    output logic               settled,   // none was sent that was not answered
    input  logic [31:3]        addr,
    output logic [ENTRIES-1:0] match,     // entries that write at `addr`
    output logic [ENTRIES-1:0] leave      // entry that leaves in this cycle
);
  localparam int PointerBits = $clog2(ENTRIES);

  logic [ENTRIES-1:0] valid;
  logic [PointerBits-1:0] head, tail;
  logic [PointerBits:0] flying;

  assign ready   = !valid[tail];
  assign settled = flying == '0;
  assign leave   = answered || dropped ? ENTRIES'(1) << head : '0;

  for (genvar i = 0; i < ENTRIES; i++) begin : g_entry
    logic [31:3] entry;
    assign match[i] = valid[i] && entry == addr;
    always_ff @(posedge clk) begin
      if (push && tail == PointerBits'(i)) entry <= push_addr;
      if (rst || leave[i]) valid[i] <= 1'b0;
      else if (push && tail == PointerBits'(i)) valid[i] <= 1'b1;
    end
  end

  always_ff @(posedge clk) begin
    if (rst) begin
      head   <= '0;
      tail   <= '0;
      flying <= '0;
    end else begin
      if (push) tail <= tail + 1'b1;
      if (answered || dropped) head <= head + 1'b1;
      flying <= flying + (PointerBits + 1)'(sent) - (PointerBits + 1)'(answered);
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (!push || ready) else $error("ft_write_order: pushed while full");
      assert (!answered || flying != '0) else $error("ft_write_order: an answer to nothing");
      assert (!dropped || (settled && !answered)) else $error("ft_write_order: dropped out of order");
    end
  end
`endif
endmodule
