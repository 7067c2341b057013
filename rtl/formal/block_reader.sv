// SPDX-License-Identifier: Apache-2.0
// ft_block_reader: a read's address stays until memory takes it, goes out only once the writes that it
// must see have ended, and each read is answered once, in order: what came of it, or zeros outside the
// window. For two reads at a time, one write to wait for, and a few addresses and data.
// engine: pdr
// sources: common/ft_fifo.sv system/ft_window.sv system/ft_block_reader.sv
// fault: system/ft_block_reader.sv: waits <= match & ~leave; => waits <= '0;
// fault: system/ft_block_reader.sv: held && outside && in_flight == '0; => held && outside;
// fault: system/ft_block_reader.sv: !held && reserved != CountBits'(READS) && !cancel; => !held && !cancel;
// fault: system/ft_block_reader.sv: if (r_valid) place_head => if (pop) place_head
// fault: system/ft_block_reader.sv: if (sent || make_up) held => if (ar_valid || make_up) held
module proof (
    input logic       clk,
    input logic       rdq_valid,
    input logic [4:0] place,  // 64 byte block, word of eight bytes
    input logic       rdd_ready,
    input logic       match,
    input logic       leave,
    input logic       ar_ready,
    input logic       answer,
    input logic [1:0] beat,   // its two words
    input logic       mark    // of all reads, this is the one to follow
);
  logic rst = 1'b1;
  always_ff @(posedge clk) rst <= 1'b0;

  logic rdq_ready, rdd_valid, done, reading, stray, ar_valid, r_valid, ask, take, sent;
  logic [63:0] rdd_data;
  logic [31:0] stray_addr, ar_addr;
  logic [2:0] asked, under_way;  // not taken yet; not answered by memory yet

  assign r_valid = answer && under_way != '0;
  ft_block_reader #(.BUS_BYTES(16), .READS(2), .ENTRIES(1)) dut (
      .clk, .rst, .cancel(1'b0), .window_first(26'd1), .window_behind(26'd3),
      .rdq_valid, .rdq_ready, .rdq_addr({24'd0, place}),
      .rdd_valid, .rdd_ready, .rdd_data, .done, .reading, .stray, .stray_addr, .match, .leave,
      .ar_valid, .ar_ready, .ar_addr, .r_valid,
      .r_data({63'd0, beat[1], 63'd0, beat[0]})
  );
  assign ask  = rdq_valid && rdq_ready;
  assign take = rdd_valid && rdd_ready;
  assign sent = ar_valid && ar_ready;

  // The read that is followed: reads before it that were not taken, not answered by memory; what it
  // has to wait for; and what came of it.
  logic followed, inside, gone, come, ar_waits;
  logic [4:0] at;
  logic [2:0] ahead, before;
  logic must_see;
  logic data;
  logic [31:0] ar_was;

  always_ff @(posedge clk) begin
    ar_waits <= !rst && ar_valid && !ar_ready;
    ar_was   <= ar_addr;
    if (rst) begin
      asked     <= '0;
      under_way <= '0;
      followed  <= 1'b0;
    end else begin
      asked     <= asked + 3'(ask) - 3'(take);
      under_way <= under_way + 3'(sent) - 3'(r_valid);
      if (!followed) begin
        followed <= mark && ask;
        at       <= place;
        inside   <= place[4:3] == 2'd1 || place[4:3] == 2'd2;
        ahead    <= asked - 3'(take);
        must_see <= match & ~leave;
        gone     <= 1'b0;
        come     <= 1'b0;
      end else begin
        must_see <= must_see & ~leave;
        if (take) begin
          followed <= ahead != '0;
          ahead    <= ahead - 1'b1;
        end
        if (inside && !gone && sent) begin
          gone   <= 1'b1;
          before <= under_way - 3'(r_valid);
          assert (ar_addr == {24'd0, at, 3'd0} && !must_see);
        end
        if (gone && !come && r_valid) begin
          come   <= before == '0;
          before <= before - 1'b1;
          data   <= at[0] ? beat[1] : beat[0];
        end
        if (rdd_valid && ahead == '0) begin
          if (inside) assert (come);
          assert (rdd_data == (inside ? {63'd0, data} : 64'd0));
        end
      end
      assert (asked <= 2);
      assert (done == (asked == '0));
      assert (reading == (under_way != '0));
      if (ar_valid) assert (ar_addr[7:6] == 2'd1 || ar_addr[7:6] == 2'd2);
      if (ar_waits) assert (ar_valid && ar_addr == ar_was);
    end
  end
endmodule
