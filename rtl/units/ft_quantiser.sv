// SPDX-License-Identifier: Apache-2.0
// From a coordinate to its cell on an axis: clamp(truncate((value - lo) * scale), 0, 2^15-1), each
// operation rounded to binary32, and of that the upper `bits` bits. One a cycle,
// ft_pkg::QuantiserLatency cycles later; out_cell has some levels of logic behind the last register.
module ft_quantiser (
    input  logic        clk,
    input  logic        rst,
    input  logic        in_valid,
    input  logic [31:0] in_value,  // finite, like in_lo
    input  logic [31:0] in_lo,
    input  logic [31:0] in_scale,  // zero, or normal and positive
    input  logic [3:0]  in_bits,
    output logic        out_valid,
    output logic [14:0] out_cell
);
  localparam int Latency = ft_pkg::QuantiserLatency;
  localparam int SubLatency = ft_pkg::FloatSubLatency;

  // What goes with the value to where it is needed: shift registers without reset.
  logic [Latency-1:0] valid;
  logic [31:0] scale[0:SubLatency-1];
  logic [3:0] bits[0:Latency-1];
  always_ff @(posedge clk) begin
    scale[0] <= in_scale;
    bits[0]  <= in_bits;
    for (int i = 1; i < SubLatency; i++) scale[i] <= scale[i-1];
    for (int i = 1; i < Latency; i++) bits[i] <= bits[i-1];
    if (rst) valid <= '0;
    else valid <= {valid[Latency-2:0], in_valid};
  end
  assign out_valid = valid[Latency-1];

  // A difference beyond binary32 needs no infinity: every scale that is not zero takes it out of
  // the grid.
  logic [32:0] difference;
  logic [22:0] x;  // as binary32, without the fraction's low bits
  logic [8:0] unused_fraction;
  ft_float_sub #(
      .WIDE(1)
  ) sub (
      .clk       (clk),
      .a         (in_value),
      .b         (in_lo),
      .difference(difference)
  );
  ft_float_mul #(
      .WIDE(1)
  ) mul (
      .clk    (clk),
      .a      (difference),
      .b      (scale[SubLatency-1]),
      .product({x, unused_fraction})
  );

  // The integer part's 15 places below 2^15, moved by what the exponent and the bits say at once.
  logic outside, none;
  logic [4:0] shift;
  logic [14:0] places;
  assign none     = x[22] || x[21:14] < 8'd127;
  assign outside  = x[21:14] >= 8'd142;
  // 141 - exponent to drop the fraction, and 15 - bits; only the low bits of the sum matter.
  assign shift    = 5'd28 - (outside ? 5'd13 : x[18:14]) - 5'(bits[Latency-1]);
  assign places   = outside ? '1 : {1'b1, x[13:0]};
  assign out_cell = none ? '0 : places >> shift;

`ifndef SYNTHESIS
  always_ff @(posedge clk) begin
    if (!rst && in_valid) begin
      assert (!in_scale[31] && in_scale[30:23] != 8'd255 && (|in_scale[30:23] || in_scale == '0))
      else $error("ft_quantiser: a scale that is neither zero nor normal and positive");
    end
  end
`endif
endmodule
