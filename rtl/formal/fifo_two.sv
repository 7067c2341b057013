// SPDX-License-Identifier: Apache-2.0
// ft_fifo_two loses nothing, repeats nothing and keeps the order, however many are taken at a time,
// at depths of 2, 4 and 6.
// engine: pdr
// sources: common/ft_fifo_two.sv
// fault: common/ft_fifo_two.sv: first_odd <= first_odd ^ out_take[0]; => first_odd <= first_odd ^ |out_take;
// fault: common/ft_fifo_two.sv: pop_odd    = out_take[1] || => pop_odd    =
// fault: common/ft_fifo_two.sv: count != CountBits'(DEPTH); => 1'b1;
// fault: common/ft_fifo_two.sv: first_odd ? even[even_head] : odd[odd_head] => odd[odd_head]
module fifo_two_followed #(
    parameter int DEPTH = 4
) (
    input logic       clk,
    input logic       rst,
    input logic       in_valid,
    input logic [1:0] in_data,
    input logic [1:0] wish,  // how many the taker would take
    input logic       mark   // of all elements, this is the one to follow
);
  localparam int Bits = $clog2(DEPTH + 1);
  logic in_ready, push, followed;
  logic [1:0] out_count, out_take, out_first, out_second, data;
  logic [Bits-1:0] ahead, inside;

  ft_fifo_two #(.WIDTH(2), .DEPTH(DEPTH)) dut (
      .clk, .rst, .in_valid, .in_ready, .in_data, .out_count, .out_first, .out_second, .out_take
  );
  assign push     = in_valid && in_ready;
  assign out_take = wish > out_count ? out_count : wish;

  always_ff @(posedge clk) begin
    if (rst) begin
      followed <= 1'b0;
      inside   <= '0;
    end else begin
      inside <= inside + Bits'(push) - Bits'(out_take);
      if (!followed) begin
        followed <= mark && push;
        data     <= in_data;
        ahead    <= inside - Bits'(out_take);
      end else begin
        followed <= ahead >= Bits'(out_take);
        ahead    <= ahead - Bits'(out_take);
      end
      assert (in_ready == (inside != Bits'(DEPTH)));
      assert (out_count == (inside >= 2 ? 2'd2 : inside[1:0]));
      if (followed) assert (ahead < inside);
      if (followed && ahead == '0) assert (out_first == data);
      if (followed && ahead == 1) assert (out_second == data);
    end
  end
endmodule

module proof (
    input logic       clk,
    input logic [2:0] in_valid,
    input logic [5:0] in_data,
    input logic [5:0] wish,
    input logic [2:0] mark
);
  logic rst = 1'b1;
  always_ff @(posedge clk) rst <= 1'b0;

  for (genvar d = 0; d < 3; d++) begin : depth
    fifo_two_followed #(.DEPTH(2 * d + 2)) check (
        .clk, .rst, .in_valid(in_valid[d]), .in_data(in_data[2*d+:2]), .wish(wish[2*d+:2]),
        .mark(mark[d])
    );
  end
endmodule
