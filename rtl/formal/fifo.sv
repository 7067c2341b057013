// SPDX-License-Identifier: Apache-2.0
// ft_fifo loses nothing, repeats nothing and keeps the order, at every depth from 1 to 5.
// engine: pdr
// sources: common/ft_fifo.sv
// fault: common/ft_fifo.sv: head == Last ? '0 => head == Last - 1'b1 ? '0
// fault: common/ft_fifo.sv: count != CountBits'(DEPTH); => 1'b1;
// fault: common/ft_fifo.sv: if (push && !pop) count => if (push) count
// fault: common/ft_fifo.sv: slots[tail] <= in_data => slots[head] <= in_data
module fifo_followed #(
    parameter int DEPTH = 3
) (
    input logic       clk,
    input logic       rst,
    input logic       in_valid,
    input logic [1:0] in_data,
    input logic       out_ready,
    input logic       mark  // of all elements, this is the one to follow
);
  localparam int Bits = $clog2(DEPTH + 1);
  logic in_ready, out_valid, push, pop;
  logic [1:0] out_data, data;
  logic [Bits-1:0] count, ahead, inside;
  logic followed;

  ft_fifo #(.WIDTH(2), .DEPTH(DEPTH)) dut (
      .clk, .rst, .in_valid, .in_ready, .in_data, .out_valid, .out_ready, .out_data, .count
  );
  assign push = in_valid && in_ready;
  assign pop  = out_valid && out_ready;

  always_ff @(posedge clk) begin
    if (rst) begin
      followed <= 1'b0;
      inside   <= '0;
    end else begin
      inside <= inside + Bits'(push) - Bits'(pop);
      if (!followed) begin
        followed <= mark && push;
        data     <= in_data;
        ahead    <= inside - Bits'(pop);
      end else if (pop) begin
        followed <= ahead != '0;
        ahead    <= ahead - 1'b1;
      end
      assert (count == inside);
      assert (in_ready == (inside != Bits'(DEPTH)));
      assert (out_valid == (inside != '0));
      if (followed) assert (ahead < inside);
      if (followed && ahead == '0) assert (out_data == data);
    end
  end
endmodule

module proof (
    input logic       clk,
    input logic [4:0] in_valid,
    input logic [9:0] in_data,
    input logic [4:0] out_ready,
    input logic [4:0] mark
);
  logic rst = 1'b1;
  always_ff @(posedge clk) rst <= 1'b0;

  for (genvar d = 0; d < 5; d++) begin : depth
    fifo_followed #(.DEPTH(d + 1)) check (
        .clk, .rst, .in_valid(in_valid[d]), .in_data(in_data[2*d+:2]), .out_ready(out_ready[d]),
        .mark(mark[d])
    );
  end
endmodule
