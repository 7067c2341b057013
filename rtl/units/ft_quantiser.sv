// SPDX-License-Identifier: Apache-2.0
// From a coordinate to its cell on an axis: clamp(truncate((value - lo) * scale), 0, 2^15-1), each
// operation rounded to binary32, and of that the upper `bits` bits. One a cycle,
// ft_pkg::QuantiserLatency cycles later, with some levels of logic behind the last register. The
// clamp is left to who uses the place: it is found beside it, and whoever picks bits of the place
// can clamp what was picked instead of waiting for it.
module ft_quantiser (
    input  logic        clk,
    input  logic        rst,
    input  logic        in_valid,
    input  logic [31:0] in_value,  // finite, like in_lo
    input  logic [31:0] in_lo,
    input  logic [31:0] in_scale,  // zero, or normal and positive
    input  logic [3:0]  in_bits,
    output logic        out_valid,
    output logic        out_below,  // the cell is 0, whatever out_place says
    output logic        out_above,  // if not below, it is the last, all ones
    output logic [14:0] out_place   // else this
);
  localparam int Latency = ft_pkg::QuantiserLatency;
  localparam int SubLatency = ft_pkg::FloatSubLatency;

  // What goes with the value to where it is needed: shift registers without reset.
  logic [Latency-1:0] valid;
  logic [31:0] scale[0:SubLatency-1];
  logic [3:0] bits[0:Latency-2];
  always_ff @(posedge clk) begin
    scale[0] <= in_scale;
    bits[0]  <= in_bits;
    for (int i = 1; i < SubLatency; i++) scale[i] <= scale[i-1];
    for (int i = 1; i < Latency - 1; i++) bits[i] <= bits[i-1];
    if (rst) valid <= '0;
    else valid <= {valid[Latency-2:0], in_valid};
  end
  assign out_valid = valid[Latency-1];

  // A difference beyond binary32 needs no infinity: every scale that is not zero takes it out of
  // the grid. Of 15 bits the upper `bits` are the integer part of the product moved by the others.
  logic [32:0] difference;
  logic [22:0] x;  // the product as binary32, without the fraction's low bits
  logic [8:0] unused_fraction;
  ft_float_sub sub (
      .clk       (clk),
      .a         (in_value),
      .b         (in_lo),
      .difference(difference)
  );
  ft_float_mul mul (
      .clk    (clk),
      .a      (difference),
      .b      (scale[SubLatency-1]),
      .down   (4'd15 - bits[SubLatency-1]),
      .product({x, unused_fraction})
  );

  // The integer part, at most 2^bits - 1.
  logic [7:0] limit;  // the exponent of 2^bits
  always_ff @(posedge clk) limit <= 8'd127 + 8'(bits[Latency-2]);
  assign out_below = x[22] || x[21:14] < 8'd127;
  assign out_above = x[21:14] >= limit;
  // 141 - exponent, of which only the low bits matter.
  assign out_place = {1'b1, x[13:0]} >> (4'd13 - x[17:14]);

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst && in_valid) begin
      assert (!in_scale[31] && in_scale[30:23] != 8'd255 && (|in_scale[30:23] || in_scale == '0))
      else $error("ft_quantiser: a scale that is neither zero nor normal and positive");
    end
  end
`endif
endmodule
