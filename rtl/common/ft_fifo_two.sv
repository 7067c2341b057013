// SPDX-License-Identifier: Apache-2.0
// First in, first out, whose taker sees the first two elements and takes none, one or both of them
// in a cycle. Otherwise as ft_fifo: even and odd elements lie in a memory each.
module ft_fifo_two #(
    parameter int WIDTH = 8,
    parameter int DEPTH = 4  // even
) (
    input  logic             clk,
    input  logic             rst,
    input  logic             in_valid,
    output logic             in_ready,
    input  logic [WIDTH-1:0] in_data,
    output logic [1:0]       out_count,  // elements to be seen: two, one or none
    output logic [WIDTH-1:0] out_first,
    output logic [WIDTH-1:0] out_second,
    input  logic [1:0]       out_take    // not more than out_count
);
  localparam int Half = DEPTH / 2;
  localparam int PointerBits = Half > 1 ? $clog2(Half) : 1;
  localparam int CountBits = $clog2(DEPTH + 1);
  localparam logic [PointerBits-1:0] Last = PointerBits'(Half - 1);

  logic [WIDTH-1:0] even[0:Half-1];
  logic [WIDTH-1:0] odd[0:Half-1];
  logic [PointerBits-1:0] even_head, even_tail, odd_head, odd_tail;
  logic first_odd, next_odd;  // of the one to be taken first, and to be put next
  logic [CountBits-1:0] count;
  logic push, pop_even, pop_odd;

  assign in_ready   = count != CountBits'(DEPTH);
  assign out_count  = |count[CountBits-1:1] ? 2'd2 : {1'b0, count[0]};
  assign out_first  = first_odd ? odd[odd_head] : even[even_head];
  assign out_second = first_odd ? even[even_head] : odd[odd_head];
  assign push       = in_valid && in_ready;
  assign pop_even   = out_take[1] || (out_take[0] && !first_odd);
  assign pop_odd    = out_take[1] || (out_take[0] && first_odd);

  always_ff @(posedge clk) begin
    if (push && !next_odd) even[even_tail] <= in_data;
    if (push && next_odd) odd[odd_tail] <= in_data;
    if (rst) begin
      even_head <= '0;
      even_tail <= '0;
      odd_head  <= '0;
      odd_tail  <= '0;
      first_odd <= 1'b0;
      next_odd  <= 1'b0;
      count     <= '0;
    end else begin
      if (push && !next_odd) even_tail <= even_tail == Last ? '0 : even_tail + 1'b1;
      if (push && next_odd) odd_tail <= odd_tail == Last ? '0 : odd_tail + 1'b1;
      if (pop_even) even_head <= even_head == Last ? '0 : even_head + 1'b1;
      if (pop_odd) odd_head <= odd_head == Last ? '0 : odd_head + 1'b1;
      first_odd <= first_odd ^ out_take[0];
      next_odd  <= next_odd ^ push;
      count     <= count + CountBits'(push) - CountBits'(out_take);
    end
  end

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst) begin
      assert (out_take <= out_count) else $error("ft_fifo_two: more taken than there is");
    end
  end
`endif
endmodule
